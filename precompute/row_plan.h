// SPDX-License-Identifier: MIT
//
// What an error target means for rays, cut and stored values.
#pragma once

#include "precompute/cut.h"
#include "precompute/precompute.h"
#include "precompute/rows.h"

namespace relume {

/// Causes are independent, so that their squares add up; each gets this share of the target. Together they
/// leave a third of it to lights that probing does not foresee.
inline constexpr double kClusterShare = 0.5, kRayShare = 0.3, kCutShare = 0.3;
/// That of the cut where bounds are to be narrow.
inline constexpr double kCutShareForBounds = 0.25;

struct RowPlan {
  bool cut = false;  ///< needs a survey
  bool adaptive =
      false;  ///< rays are doubled where that is worth it; the exchange of the limits is still to be found
  bool bounds = false;           ///< cut rows tell how they share out what they see of nodes
  bool reciprocal = false;       ///< rows of clusters are projected before they are cut
  double clearance_share = 0.0;  ///< of clusters, to begin with; 0: all of one size
  RayLimits lumels, sensors;
  std::uint32_t probe_rays = 8192;
  std::vector<std::uint32_t> node_quality;  ///< per node of the scene: rays of its rows; 0: as `lumels`
  std::vector<CutLimits> node_cuts;         ///< per node of the scene: of its rows
  CutLimits sensor_cut;
  ValueCodec codec = ValueCodec::f32;
};

/// What stored values cost, at an albedo of 0.8: no more than tests/verification/precision_test.cpp finds.
constexpr double precision_error(ValueCodec codec) {
  return codec == ValueCodec::sqrt8 ? 0.006 : codec == ValueCodec::unorm16 ? 1e-4 : 0.0;
}

/// What nodes ask for stands, then what options ask for themselves; the rest follows from the error target,
/// if there is one. `probing` of the limits is still empty.
RowPlan plan_rows(const PrecomputeOptions& options, const Scene& scene);

}  // namespace relume
