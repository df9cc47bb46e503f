// SPDX-License-Identifier: MIT
//
// What an error target means for rays, cut and stored values.
#pragma once

#include "precompute/cut.h"
#include "precompute/precompute.h"
#include "precompute/rows.h"

namespace relume {

/// Causes are independent, so that their squares add up; each gets this share of the target.
inline constexpr double kClusterShare = 0.5, kRayShare = 0.5, kCutShare = 0.5;

struct RowPlan {
  bool cut = false;  ///< needs a survey
  bool adaptive =
      false;  ///< rays are doubled where that is worth it; the exchange of the limits is still to be found
  double clearance_share = 0.0;  ///< of clusters, to begin with; 0: all of one size
  RayLimits lumels, sensors;
  CutLimits lumel_cut, sensor_cut;  ///< a sensor shares its nodes with no other row
  ValueCodec codec = ValueCodec::f32;
};

/// What options ask for themselves stands; the rest follows from the error target, if there is one. `probing`
/// of the limits is still empty.
RowPlan plan_rows(const PrecomputeOptions& options);

}  // namespace relume
