// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "core/occluder_bvh.h"
#include "core/opacity.h"
#include "core/result.h"

namespace relume {

/// The tree over these triangles that Embree's builder makes (binned SAH), compressed. The same for any
/// number of threads: the builder sorts what it cannot tell apart, and children here stand in the order of
/// their lowest triangle. Fails with out_of_memory.
Result<OccluderBvh> build_occluder_bvh(std::span<const glm::vec3> positions,
                                       std::span<const std::array<std::uint32_t, 3>> triangles,
                                       const Opacity& opacity = {});

}  // namespace relume
