// SPDX-License-Identifier: MIT
#include "precompute/cut_rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace relume {
namespace {

/// A row without budget asks for more than any with one.
CutLimits tile_limits(std::span<const CutLimits> limits) {
  return *std::max_element(limits.begin(), limits.end(), [](const CutLimits& a, const CutLimits& b) {
    if (a.budget == 0 && b.budget == 0) return a.node_error > b.node_error;
    return a.budget != 0 && (b.budget == 0 || a.budget < b.budget);
  });
}

}  // namespace

std::vector<CutTile> cut_rows(const CutSenders& senders, std::span<const CutRow> rows,
                              const TileCutOptions& options) {
  TileCutters cutters([&] { return TileCutter(senders); });
  return cut_rows(cutters, rows, options);
}

std::vector<CutTile> cut_rows(TileCutters& cutters, std::span<const CutRow> rows,
                              const TileCutOptions& options) {
  std::vector<CutTile> tiles((rows.size() + options.rows - 1) / options.rows);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const std::size_t first = t * options.rows,
                      count = std::min<std::size_t>(options.rows, rows.size() - first);
    const auto limits = options.limits.size() == 1 ? options.limits : options.limits.subspan(first, count);
    tiles[t] = cutters.local().cut(rows.subspan(first, count), tile_limits(limits));
  });
  return tiles;
}

}  // namespace relume
