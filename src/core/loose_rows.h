// SPDX-License-Identifier: MIT
//
// Stored rows with all that cutting and encoding them left open: which rows of leaves they may come from.
#pragma once

#include <cstdint>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

inline constexpr std::uint64_t kUntold = ~std::uint64_t{0};

struct LooseRows {
  CsrMatrix rows;  ///< rows x senders, numbered as those of a SenderMatrix; columns in the order that a file
                   ///< stores them in
  std::vector<double> slack, running;  ///< per entry: ValueSlack
  CsrMatrix nodes;                     ///< nodes x leaves, as in a SenderMatrix
  std::uint32_t told_nodes = 0;        ///< the first nodes, which halvings are told of; none of the others
  std::vector<std::uint8_t> halvings;  ///< core/halvings.h
  std::vector<std::uint64_t> first_halving;  ///< per row; kUntold: its nodes may share out as they please
};

struct LooseMatrices {
  LooseRows bounce, gather;
};

/// The model must be valid (check_model) and all of its systems loaded.
LooseMatrices loose_matrices(const Model& model);

/// Per row, the most of sum_j F_j x_j that any row of leaves makes that these may come from; `leaves`: x of
/// clusters and sky patches, of any sign. The least is minus the most of -x.
///
/// What a node gets counts as all on the leaf of largest x, or as its halvings allow. What codes may hide is
/// at most the smallest of these sums over the row, u being what entries count for and m their mean by stored
/// values: for any level c, sum slack |u - c|; and, by summation by parts,
/// sum running |u - next u|, where m follows the last.
std::vector<Rgb> most_arriving(const LooseRows& matrix, const std::vector<Rgb>& leaves);

}  // namespace relume
