// SPDX-License-Identifier: MIT
//
// Hollows: the insides of solids. A wall, a table top or a cupboard that is modelled as a closed body, of a
// material that says double-sided, has surfaces inside of it that nobody sees and no light reaches; they
// would be most of some models.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"
#include "scene/scene.h"

namespace relume {

struct HollowSearch {
  /// About the geometry's origin, lifted: where somebody looks, besides cameras.
  std::span<const SurfacePoint> places;
  std::uint64_t seed = 0;
};

/// Whether any triangle has a back that could be one.
bool may_have_hollows(const Geometry& geometry);

/// Per triangle: whether all of its back bounds a hollow. That is space from which backs are most of what is
/// seen, also after many reflections, and which less than a thousandth of the light reaches that the sky,
/// lights, what may emit, cameras and `places` would send, were all of it reflected by half. Rays are cast in
/// the calling task arena; the same for any number of threads.
std::vector<bool> find_hollows(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
                               const HollowSearch& search);

}  // namespace relume
