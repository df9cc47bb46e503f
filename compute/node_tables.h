// SPDX-License-Identifier: MIT
//
// The nodes of a tree as kernels sum them: in two steps, so that a large node is the mean of small ones,
// which are there already, and not of all its leaves.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/model.h"
#include "kernels/shared/glsl_types.h"

namespace relume {

struct NodeTables {
  /// Per node: first part, number of parts, number of the node among the senders of its system, 0. First the
  /// small ones, of up to kernels::kSmallNode leaves, fewest first, which are summed leaf by leaf; then the
  /// large ones, whose parts are small nodes and the leaves between them.
  std::vector<kernels::uvec4> records;
  /// Of all nodes: a sender of the system (its leaves, then its nodes), and the bits of its share, a float.
  std::vector<std::array<kernels::uint, 2>> parts;
  std::uint32_t small = 0;  ///< records of small nodes
};

/// Of a tree over `leaves` leaves. A large node takes the leaves of a small one that lies in it one by one
/// where their shares in both are not in proportion.
NodeTables node_tables(const ClusterTreeNodes& tree, std::uint32_t leaves);

}  // namespace relume
