// SPDX-License-Identifier: MIT
//
// What the benchmarks of whole frames share.
#pragma once

#include <span>
#include <vector>

#include "compute/standalone/frame_session.h"
#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume::bench {

inline constexpr std::uint32_t kMostBounces = 2, kBouncesToTheEnd = 150;  ///< of a frame

/// The row kernel that a program takes without measuring.
FrameSessionOptions frame_options(const StandaloneDevice& device, const Model& model);

/// Shows `lights` and the sky of `lighting` for a frame of many bounces, and compares what the session has
/// then with the reference on the processor: albedo and exitance of `lighting`, direct light by Embree. Fails
/// (check_failed) when indirect or direct irradiance, or the texels of a lightmap, are off by more than 0.1
/// %.
Result<void> check_frame(FrameSession& session, const Model& model, std::span<const Light> lights,
                         const Lighting& lighting);

}  // namespace relume::bench
