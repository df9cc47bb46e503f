// SPDX-License-Identifier: MIT
#include "precompute/cut_rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace relume {

std::vector<CutTile> cut_rows(const SenderTree& senders, std::span<const FormFactorRow* const> rows,
                              const TileCutOptions& options) {
  std::vector<CutTile> tiles((rows.size() + options.rows - 1) / options.rows);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const std::size_t first = t * options.rows;
    const auto part = rows.subspan(first, std::min<std::size_t>(options.rows, rows.size() - first));
    tiles[t] = cut_tile(senders.tree, senders.weights, part, options.rays, {options.budget, 0.0});
  });
  return tiles;
}

}  // namespace relume
