// SPDX-License-Identifier: MIT
//
// Any bytes as the JSON of lights and as that of materials.
#include <cmath>
#include <glm/geometric.hpp>

#include "core/reference_solver.h"
#include "fuzz/input_file.h"
#include "support/tiny_model.h"
#include "tool/lights_json.h"
#include "tool/materials_json.h"

namespace {

using namespace relume;

bool finite(const glm::dvec3& value) {
  return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
}

void check_lights(const std::filesystem::path& file) {
  const auto lights = read_lights(file);
  if (!lights) return test::require_one_line(lights.error(), "input.json");
  for (const Light& light : *lights) {
    test::require(finite(light.intensity) && finite(light.position), "lights are finite");
    test::require(std::abs(glm::length(light.direction) - 1.0) < 1e-6, "directions have length 1");
  }
}

void check_materials(const std::filesystem::path& file) {
  static const Model model = test::tiny_model();
  const auto overrides = read_material_overrides(file, model);
  if (!overrides) return test::require_one_line(overrides.error(), "input.json");
  Lighting lighting = stored_lighting(model);
  apply_material_overrides(model, *overrides, 0.95, lighting);
  for (std::size_t i = 0; i < lighting.albedo.size(); ++i) {
    const Rgb& albedo = lighting.albedo[i];
    test::require(finite(lighting.exitance[i]), "emission is finite");
    for (int c = 0; c < 3; ++c) test::require(albedo[c] >= 0.0 && albedo[c] <= 0.95, "albedos are clamped");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto file = test::input_file("input.json", bytes, size);
  check_lights(file);
  check_materials(file);
  return 0;
}
