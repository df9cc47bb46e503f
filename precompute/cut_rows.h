// SPDX-License-Identifier: MIT
//
// All rows of a model, cut: tiles of neighbouring rows that share the nodes that they keep.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/cut.h"
#include "precompute/number_senders.h"

namespace relume {

struct TileCutOptions {
  std::uint32_t rows = 8;    ///< of a tile; the last may have fewer
  std::uint32_t budget = 0;  ///< nodes of a tile
  std::uint32_t rays = 0;    ///< of a row, about
  /// Per row, if rows differ: a tile gets the largest of its rows', 0 being no limit. Empty: `budget`.
  std::span<const std::uint32_t> budgets = {};
};

/// Tiles in the order of their rows; in the calling task arena, the same for any number of threads.
std::vector<CutTile> cut_rows(const SenderTree& senders, std::span<const FormFactorRow* const> rows,
                              const TileCutOptions& options);

}  // namespace relume
