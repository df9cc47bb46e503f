// SPDX-License-Identifier: MIT
//
// Lights that no precompute knows, and sensors, in places of a scene drawn by chance from a fixed seed.
#pragma once

#include <string>
#include <vector>

#include "core/model.h"
#include "core/solve.h"
#include "precompute/precompute.h"
#include "scene/scene.h"

namespace relume {

/// Of `ambient`: radiance of the sky (cd/m2), or where none is seen the exitance of all surfaces (lm/m2).
inline constexpr Rgb kAmbientLight{1000.0};

struct TestLight {
  std::string name;
  std::vector<Light> lights;
  double clearance = 0.0;  ///< m, from the light to the nearest surface; 0 without lights
  bool lamp = false;       ///< the lamp that was added shines
  bool ambient = false;    ///< the sky shines, or all glows where none is seen
};

/// A scene with a small lamp of its own hung in free space, five lights, and sensors on its surfaces.
struct TestScene {
  Scene scene;
  std::vector<TestLight> lights;  ///< ambient, the lamp, two points, a spot
  std::vector<SensorPoint> sensors;
  std::uint32_t lamp_material = 0;  ///< index into Scene::materials
  Rgb lamp_exitance{0.0};           ///< lm/m2, while it shines
};

/// No sensor stands inside of a solid (find_hollows.h).
Result<TestScene> test_scene(Scene scene, std::size_t sensors);

/// A place for lamps in free space, inside a room where there is one.
struct LampPlace {
  glm::dvec3 position{0.0};  ///< world space
  double radius = 0.0;       ///< m, to the nearest surface
};

Result<LampPlace> lamp_place(const Scene& scene);

/// Albedo of the model; light of `light` alone.
Result<Lighting> test_lighting(const Model& model, const TestLight& light);

}  // namespace relume
