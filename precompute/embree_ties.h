// SPDX-License-Identifier: MIT
//
// Triangles whose hits must be settled among those as far away, and what of Embree that needs.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"

namespace relume {

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneRelease>;

using Triangle = std::array<std::uint32_t, 3>;

/// What the scene is made of.
struct Mesh {
  std::span<const glm::vec3> positions;
  std::span<const Triangle> triangles;
  float largest = 0.0f;  ///< coordinate

  std::array<glm::vec3, 3> corners(std::size_t triangle) const {
    const Triangle& t = triangles[triangle];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
};

/// Flags of a triangle: it lies on another in one plane; it is thinner than rounding can tell.
inline constexpr std::uint8_t kOverlaps = 1, kThin = 2;

/// Builds the tree of a scene over so many triangles. Fails with out_of_memory, also where something went
/// wrong before; the scene is then left to the system, since Embree ends the process when one is released
/// whose building was cut short.
Result<void> build_tree(RTCDevice device, EmbreeScene& scene, std::size_t triangles);

/// Flags of each triangle; empty where none has any. `known`: empty, or per triangle its flags as far as it
/// is alone with others that are known, or kUnknownTies.
Result<std::vector<std::uint8_t>> find_ties(RTCDevice device, const Mesh& mesh,
                                            std::span<const std::uint8_t> known);

}  // namespace relume
