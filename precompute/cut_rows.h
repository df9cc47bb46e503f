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

/// A row to be cut, and what tells how alike neighbours are.
struct RowToCut {
  const FormFactorRow* row = nullptr;
  glm::vec3 normal{0.0f};
  std::uint32_t room = 0;
};

struct TileCutOptions {
  std::uint32_t rows = 8;    ///< of a tile; the last may have fewer
  std::uint32_t budget = 0;  ///< nodes of a tile
  std::uint32_t rays = 0;    ///< of a row, about
  bool shrink_noise = false;
};

/// Tiles in the order of their rows; in the calling task arena, the same for any number of threads. With
/// `shrink_noise` what rows that lie side by side (one room, normals within 18 degrees) differ by is shrunk
/// where it is no more than sampling noise would make: the variance of a node's values over these rows is
/// held against F / rays, and what exceeds their mean is multiplied by max(0, 1 - noise / variance) (W.
/// James, C. Stein, Estimation with Quadratic Loss, 1961). Each row keeps its sum. Nodes that are sampled by
/// area are left alone.
std::vector<CutTile> cut_rows(const SenderTree& senders, std::span<const RowToCut> rows,
                              const TileCutOptions& options);

}  // namespace relume
