// SPDX-License-Identifier: MIT
#include "tool/lights_json.h"

#include <glm/geometric.hpp>

#include "tool/json_fields.h"

namespace relume {
namespace {

constexpr NumberRange kAnywhere{-1e12, 1e12};

void read_place(JsonFields& fields, Light& light) {
  if (light.type != LightType::directional) fields.require("position");
  if (light.type != LightType::point) fields.require("direction");
  light.position = fields.triple("position", light.position, kAnywhere);
  const glm::dvec3 direction = fields.triple("direction", light.direction, kAnywhere);
  const double length = glm::length(direction);
  if (length > 0.0) {
    light.direction = direction / length;
  } else {
    fields.reject("direction", "a vector longer than 0", "[0,0,0]");
  }
}

void read_cone(JsonFields& fields, Light& light) {
  const NumberRange quarter_turn{0.0, kPi / 2.0};
  light.inner_cone_angle = fields.number("innerConeAngle", light.inner_cone_angle, quarter_turn);
  light.outer_cone_angle = fields.number("outerConeAngle", light.outer_cone_angle, quarter_turn);
  if (light.inner_cone_angle >= light.outer_cone_angle) {
    fields.reject("innerConeAngle", "an angle below outerConeAngle", std::to_string(light.inner_cone_angle));
  }
}

Result<Light> read_light(const Json& json, const std::string& file, const std::string& path) {
  JsonFields fields(json, file, path);
  Light light;
  const std::string type = fields.one_of("type", {"point", "spot", "directional"});
  light.type = type == "point" ? LightType::point : type == "spot" ? LightType::spot : LightType::directional;
  light.name = fields.text("name", "");
  light.intensity = fields.triple("color", Rgb(1.0), {}) * fields.number("intensity", 1.0, {});
  light.range = fields.number("range", 0.0, {});
  read_place(fields, light);
  read_cone(fields, light);
  if (const Result<void> done = fields.finish(); !done) return tl::unexpected(done.error());
  return light;
}

}  // namespace

Result<std::vector<Light>> read_lights(const std::filesystem::path& file) {
  const Result<Json> json = read_json_file(file);
  if (!json) return tl::unexpected(json.error());
  JsonFields fields(*json, file.string(), "");
  fields.require("lights");
  const Json& array = fields.array("lights");
  if (const Result<void> done = fields.finish(); !done) return tl::unexpected(done.error());
  std::vector<Light> lights;
  for (std::size_t i = 0; i < array.size(); ++i) {
    Result<Light> light = read_light(array[i], file.string(), json_path("/lights", i));
    if (!light) return tl::unexpected(light.error());
    lights.push_back(std::move(*light));
  }
  return lights;
}

}  // namespace relume
