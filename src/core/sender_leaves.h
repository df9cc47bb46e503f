// SPDX-License-Identifier: MIT
//
// Which clusters and sky patches a sender stands for. These leaves are numbered through: the clusters of all
// loaded systems, system by system, then the sky patches.
#pragma once

#include <cstdint>
#include <vector>

#include "core/model.h"

namespace relume {

struct LeafRange {
  std::uint32_t first = 0;
  std::uint32_t count = 1;
  friend bool operator==(const LeafRange&, const LeafRange&) = default;
};

struct SenderLeaves {
  std::vector<LeafRange>
      ranges;  ///< one; of a node above the systems, one per loaded system; none when nothing of it is loaded
  double missing_area =
      0.0;  ///< m2 of a node above the systems that is not loaded; a cluster or node of a system does without
};

class LeafNumbers {
 public:
  explicit LeafNumbers(const Model& model);
  std::uint32_t count() const { return static_cast<std::uint32_t>(weights_.size()); }
  /// What each leaf counts for in the mean of a node: m2, or sr.
  const std::vector<double>& weights() const { return weights_; }
  SenderLeaves leaves_of(const SenderRef& sender) const;
  /// Sum of the weights, and the missing area.
  double weight_of(const SenderLeaves& leaves) const;
  /// 0 to 1: how much of the sender is not loaded.
  double missing_share(const SenderLeaves& leaves) const;

 private:
  LeafRange range_in_system(const SenderRef& sender) const;

  const Model& model_;
  std::vector<std::uint32_t> first_cluster_;  ///< per system, then of the sky
  std::vector<double> weights_;
};

}  // namespace relume
