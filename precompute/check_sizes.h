// SPDX-License-Identifier: MIT
//
// Options that make no sense for a scene, told before the long work.
#pragma once

#include <vector>

#include "precompute/cut.h"
#include "precompute/precompute.h"
#include "precompute/surfaces.h"

namespace relume {

/// Refuses (usage) numbers out of their range.
Result<void> check_options(const PrecomputeOptions& options);

/// Refuses (usage) clusters or texels larger than the scene.
Result<void> check_sizes(const PrecomputeOptions& options, const Geometry& geometry);

/// Refuses (usage) a budget that cannot keep one node of every cluster tree that a tile sees. `rows`: per
/// sender that is a cluster, of a survey; their tiles are those that cut_clusters makes, and see what the
/// tiles of their lumels see. Rows of many rays may see a tree more than those of a survey.
Result<void> check_budgets(const Scene& scene, const Surfaces& surfaces, const ClusterTree& tree,
                           const std::vector<FormFactorRow>& rows, const std::vector<CutLimits>& node_cuts);

}  // namespace relume
