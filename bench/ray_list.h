// SPDX-License-Identifier: MIT
//
// The rays of a precompute as a list, made by the precompute's own code.
#pragma once

#include <cstdint>
#include <vector>

#include "core/result.h"
#include "precompute/geometry.h"
#include "precompute/precompute.h"
#include "scene/scene.h"

namespace relume::bench {

struct RayList {
  std::vector<float> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z;
  std::uint32_t per_receiver = 0;  ///< rays of one receiver follow each other
  std::size_t size() const { return origin_x.size(); }
};

/// Rays of one receiver: as the sequence gives them, or as the precompute groups them, so that those of a
/// packet go nearly the same way.
enum class RayOrder { sequence, grouped };

/// All closest-hit rays that precompute() traces for the lumels and clusters of `scene`, in the order of the
/// clusters. `options` has sizes, and no sensors.
Result<RayList> rays_of_precompute(const Scene& scene, const Geometry& geometry,
                                   const PrecomputeOptions& options, RayOrder order);

}  // namespace relume::bench
