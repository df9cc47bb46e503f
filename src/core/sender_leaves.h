// SPDX-License-Identifier: MIT
//
// Which clusters and sky patches a sender stands for. These leaves are numbered through: the clusters of all
// loaded systems, system by system, then the sky patches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/model.h"

namespace relume {

/// Leaves side by side, and what they count for in the mean that is the radiosity of the sender.
struct LeafRange {
  std::uint32_t first = 0;
  std::uint32_t count = 1;
  double share = 1.0;             ///< of all of them in the sender
  std::span<const float> shares;  ///< of each in the range; empty for a single leaf

  /// Of leaf first + i in the sender.
  double share_of(std::uint32_t i) const { return shares.empty() ? share : share * double(shares[i]); }
};

/// Refers to the model.
struct SenderLeaves {
  /// One; of a node above the systems, one per loaded system; none when nothing of it is loaded.
  std::vector<LeafRange> ranges;
  double missing_share = 0.0;  ///< 0 to 1: how much of the sender is not loaded
};

class LeafNumbers {
 public:
  /// Borrows the model.
  explicit LeafNumbers(const Model& model);
  std::uint32_t count() const;
  SenderLeaves leaves_of(const SenderRef& sender) const;

 private:
  LeafRange range_in_system(const SenderRef& sender) const;

  const Model& model_;
  std::vector<std::uint32_t> first_cluster_;  ///< per system, then of the sky
};

}  // namespace relume
