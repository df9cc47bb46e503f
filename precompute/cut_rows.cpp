// SPDX-License-Identifier: MIT
#include "precompute/cut_rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace relume {
namespace {

std::uint32_t tile_budget(const TileCutOptions& options, std::size_t first, std::size_t count) {
  if (options.budgets.empty()) return options.budget;
  const auto own = options.budgets.subspan(first, count);
  return std::count(own.begin(), own.end(), 0u) > 0 ? 0 : *std::max_element(own.begin(), own.end());
}

}  // namespace

std::vector<CutTile> cut_rows(const SenderTree& senders, std::span<const FormFactorRow* const> rows,
                              const TileCutOptions& options) {
  std::vector<CutTile> tiles((rows.size() + options.rows - 1) / options.rows);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const std::size_t first = t * options.rows;
    const auto part = rows.subspan(first, std::min<std::size_t>(options.rows, rows.size() - first));
    tiles[t] = cut_tile(senders.tree, senders.weights, part, options.rays,
                        {tile_budget(options, first, part.size()), 0.0});
  });
  return tiles;
}

}  // namespace relume
