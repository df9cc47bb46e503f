// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "precompute/probing.h"

namespace relume {

/// Means over the senders of each node of the tree, by weight; `values` per sender.
std::vector<ProbingValues> node_means(const SenderTree& senders, const std::vector<ProbingValues>& values);

/// Values of the first `clusters` senders replaced by the mean of up to four neighbours each, as a model of
/// clusters of twice the size would have them.
std::vector<ProbingValues> coarser(const SenderTree& senders, std::size_t clusters,
                                   const std::vector<ProbingValues>& values);

}  // namespace relume
