// SPDX-License-Identifier: MIT
#include "scene/import/lights.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace relume {
namespace {

/// A column of the transform made unit, or nothing when the node is scaled to nothing along it.
std::optional<glm::dvec3> axis(const glm::dmat4& world, int column) {
  const glm::dvec3 direction(world[column]);
  const double length = glm::length(direction);
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  return direction / length;
}

bool is_finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

LightType light_type(const std::string& type) {
  if (type == "spot") return LightType::spot;
  return type == "directional" ? LightType::directional : LightType::point;
}

Light base_light(const tinygltf::Light& source) {
  Light light;
  light.type = light_type(source.type);
  const Rgb color =
      source.color.size() == 3 ? Rgb(source.color[0], source.color[1], source.color[2]) : Rgb(1.0);
  light.intensity = color * source.intensity;
  light.range = light.type == LightType::directional ? 0.0 : source.range;
  light.outer_cone_angle = source.spot.outerConeAngle;
  light.inner_cone_angle = std::min(source.spot.innerConeAngle, light.outer_cone_angle);
  return light;
}

}  // namespace

void convert_lights(const GltfFile& gltf, const std::vector<WalkedNode>& walk, Scene& scene) {
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const auto& extensions = gltf.model.nodes[walk[i].node].extensions;
    const auto punctual = extensions.find("KHR_lights_punctual");
    if (punctual == extensions.end()) continue;
    const auto index = static_cast<std::size_t>(punctual->second.Get("light").GetNumberAsInt());
    Light light = base_light(gltf.model.lights[index]);
    light.name = node_path(gltf, walk, i);
    light.position = glm::dvec3(walk[i].world[3]);
    const auto backward = axis(walk[i].world, 2);
    if (!is_finite(light.position) || !is_finite(light.intensity) ||
        (!backward && light.type != LightType::point)) {
      scene.warnings.push_back(fmt::format(
          "{}: the light of node \"{}\" has no finite place, direction or intensity and was left out",
          gltf.name, light.name));
      continue;
    }
    if (backward) light.direction = -*backward;
    scene.lights.push_back(std::move(light));
  }
}

void convert_cameras(const GltfFile& gltf, const std::vector<WalkedNode>& walk, Scene& scene) {
  for (const WalkedNode& walked : walk) {
    const int index = gltf.model.nodes[walked.node].camera;
    if (index < 0) continue;
    const auto& source = gltf.model.cameras[static_cast<std::size_t>(index)];
    const auto up = axis(walked.world, 1);
    const auto backward = axis(walked.world, 2);
    const glm::dvec3 position(walked.world[3]);
    if (source.type != "perspective" || !up || !backward || !is_finite(position)) {
      scene.warnings.push_back(fmt::format(
          "{}: the camera of node {} is not a finite perspective and was left out", gltf.name, walked.node));
      continue;
    }
    scene.cameras.push_back({position, -*backward, *up, source.perspective.yfov});
  }
}

}  // namespace relume
