// SPDX-License-Identifier: MIT
//
// All rows of a model, cut: tiles of neighbouring rows that share the nodes that they keep.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/cut.h"

namespace relume {

struct TileCutOptions {
  std::uint32_t rows = 8;             ///< of a tile; the last may have fewer
  std::span<const CutLimits> limits;  ///< of all rows, or per row: a tile gets the most generous of its rows'
};

/// Tiles in the order of their rows; in the calling task arena, the same for any number of threads.
std::vector<CutTile> cut_rows(const CutSenders& senders, std::span<const CutRow> rows,
                              const TileCutOptions& options);

/// One for each thread, made when it is needed; for whoever cuts again and again.
using TileCutters = tbb::enumerable_thread_specific<TileCutter>;
std::vector<CutTile> cut_rows(TileCutters& cutters, std::span<const CutRow> rows,
                              const TileCutOptions& options);

}  // namespace relume
