// SPDX-License-Identifier: MIT
//
// Any bytes as a glTF: one line, or a scene whose numbers can be used.
#include <cmath>

#include "fuzz/input_file.h"
#include "scene/load_scene.h"
#include "scene/surface_color.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace relume;
  const auto scene = load_scene(test::input_file("input.gltf", bytes, size));
  if (!scene) {
    test::require_one_line(scene.error(), "input.gltf");
    return 0;
  }
  for (const auto& position : scene->vertices.positions) {
    test::require(std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z),
                  "positions are finite");
  }
  for (std::uint32_t t = 0; t < scene->triangles.size(); ++t) {
    for (const std::uint32_t corner : scene->triangles[t])
      test::require(corner < scene->vertices.positions.size(), "corners are vertices");
    const Rgb albedo = mean_color(*scene, t, {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)}).albedo;
    for (int c = 0; c < 3; ++c)
      test::require(albedo[c] >= 0.0 && albedo[c] <= 1.0, "albedos are from 0 to 1");
  }
  for (const Light& light : scene->lights)
    test::require(std::isfinite(light.intensity.x), "lights are finite");
  return 0;
}
