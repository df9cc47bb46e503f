// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>

#include "core/model_checks.h"

namespace relume {
namespace {

constexpr std::uint32_t kMaxSkyResolution = 4096;
constexpr std::size_t kMaxStringBytes = std::size_t{1} << 20;

bool non_negative(const Rgb& rgb) {
  return finite(rgb) && rgb.x >= 0.0 && rgb.y >= 0.0 && rgb.z >= 0.0;
}

Result<void> check_string(std::string_view what, const std::string& text) {
  if (text.size() <= kMaxStringBytes) return {};
  return broken_model("{}: expected at most {} bytes of text, found {}", what, kMaxStringBytes, text.size());
}

/// Names are bounded and, where `unique`, each is there once.
Result<void> check_names(std::string_view what, std::vector<std::string_view> names, bool unique) {
  for (const std::string_view name : names) {
    if (name.size() > kMaxStringBytes) {
      return broken_model("{}: expected names of at most {} bytes, found {}", what, kMaxStringBytes,
                          name.size());
    }
  }
  std::sort(names.begin(), names.end());
  const auto twin = std::adjacent_find(names.begin(), names.end());
  if (unique && twin != names.end())
    return broken_model("{}: expected unique names, found '{}' twice", what, *twin);
  return {};
}

Result<void> check_all_names(const Model& model) {
  std::vector<std::string_view> materials, nodes, systems;
  for (const MaterialRecord& material : model.materials) materials.push_back(material.name);
  for (const NodeRecord& node : model.nodes) nodes.push_back(node.path);
  for (const System& system : model.systems) systems.push_back(system.name);
  const std::vector<std::string_view> sensors(model.sensor_names.begin(), model.sensor_names.end());
  const std::vector<std::string_view> probes(model.probe_names.begin(), model.probe_names.end());
  const Provenance& from = model.provenance;
  if (auto checked = check_names("materials", materials, /*unique=*/true); !checked) return checked;
  if (auto checked = check_names("nodes", nodes, /*unique=*/true); !checked) return checked;
  if (auto checked = check_names("systems", systems, /*unique=*/true); !checked) return checked;
  if (auto checked = check_names("sensors", sensors, /*unique=*/false); !checked) return checked;
  if (auto checked = check_names("probes", probes, /*unique=*/false); !checked) return checked;
  return check_names("provenance", {from.scene_file, from.tool, from.ray_tracer, from.options},
                     /*unique=*/false);
}

Result<void> check_light(const Light& light, std::size_t index) {
  if (auto checked = check_string("light", light.name); !checked) return checked;
  if (static_cast<std::uint32_t>(light.type) > 2) {
    return broken_model("light {}: expected type 0, 1 or 2, found {}", index,
                        static_cast<std::uint32_t>(light.type));
  }
  if (!non_negative(light.intensity))
    return broken_model("light {}: expected a finite intensity >= 0", index);
  if (!finite(light.position)) return broken_model("light {}: expected a finite position", index);
  if (!unit(light.direction)) return broken_model("light {}: expected a direction of length 1", index);
  if (!std::isfinite(light.range) || light.range < 0.0) {
    return broken_model("light {}: expected a finite range >= 0, found {}", index, light.range);
  }
  const bool cone = light.inner_cone_angle >= 0.0 && light.inner_cone_angle <= light.outer_cone_angle &&
                    light.outer_cone_angle <= kPi / 2.0 + 1e-6;
  if (!cone) {
    return broken_model("light {}: expected cone angles 0 <= inner <= outer <= pi/2, found {} and {}", index,
                        light.inner_cone_angle, light.outer_cone_angle);
  }
  return {};
}

Result<void> check_camera(const Camera& camera) {
  const bool directions =
      finite(camera.forward) && finite(camera.up) && glm::length(glm::cross(camera.forward, camera.up)) > 0.0;
  if (!finite(camera.position) || !directions) {
    return broken_model("camera: expected a finite position and two directions that are not parallel");
  }
  if (!(camera.vertical_field_of_view > 0.0 && camera.vertical_field_of_view < kPi)) {
    return broken_model("camera: expected a field of view between 0 and pi, found {}",
                        camera.vertical_field_of_view);
  }
  return {};
}

Result<void> check_globals(const Model& model) {
  if (!finite(model.origin)) return broken_model("expected a finite origin");
  if (!(model.max_albedo > 0.0 && model.max_albedo <= 0.9999)) {
    return broken_model("expected a largest albedo above 0 and at most 0.9999, found {}", model.max_albedo);
  }
  if (model.sky_resolution > kMaxSkyResolution) {
    return broken_model("expected a sky resolution of at most {}, found {}", kMaxSkyResolution,
                        model.sky_resolution);
  }
  const std::uint32_t cells = 6 * model.sky_resolution * model.sky_resolution;
  for (std::size_t patch = 0; patch < model.sky_cells.size(); ++patch) {
    if (model.sky_cells[patch] < cells) continue;
    return broken_model("sky patch {}: expected a cell below {}, found {}", patch, cells,
                        model.sky_cells[patch]);
  }
  for (std::size_t index = 0; index < model.lights.size(); ++index) {
    if (auto checked = check_light(model.lights[index], index); !checked) return checked;
  }
  if (auto checked = check_tree(model.sky_tree, model.sky_cells.size(), "sky"); !checked) return checked;
  if (model.sky_radiance && !non_negative(*model.sky_radiance))
    return broken_model("expected a finite sky radiance >= 0");
  if (auto checked = check_probe_volume(model); !checked) return checked;
  return model.camera ? check_camera(*model.camera) : Result<void>{};
}

Result<void> check_triangle(const Model& model, std::size_t index) {
  const Occluders& occluders = model.occluders;
  for (const std::uint32_t corner : occluders.triangles[index]) {
    if (corner >= occluders.positions.size()) {
      return broken_model("triangle {}: expected positions below {}, found {}", index,
                          occluders.positions.size(), corner);
    }
  }
  if (occluders.material[index] >= model.materials.size()) {
    return broken_model("triangle {}: expected a material below {}, found {}", index, model.materials.size(),
                        occluders.material[index]);
  }
  if (occluders.node[index] >= model.nodes.size()) {
    return broken_model("triangle {}: expected a node below {}, found {}", index, model.nodes.size(),
                        occluders.node[index]);
  }
  const std::uint32_t system = occluders.system[index];
  if (system != kNone && system >= model.systems.size()) {
    return broken_model("triangle {}: expected a system below {}, found {}", index, model.systems.size(),
                        system);
  }
  return {};
}

Result<void> check_occluders(const Model& model) {
  const Occluders& occluders = model.occluders;
  const std::size_t count = occluders.triangles.size();
  const bool parallel = occluders.material.size() == count && occluders.node.size() == count &&
                        occluders.system.size() == count && occluders.front_uv.size() == 3 * count &&
                        (occluders.back_uv.empty() || occluders.back_uv.size() == 3 * count);
  if (!parallel) {
    return broken_model(
        "occluders: expected {} materials, nodes and systems and {} lightmap corners, found {}, {}, {}, {} "
        "front "
        "and {} back",
        count, 3 * count, occluders.material.size(), occluders.node.size(), occluders.system.size(),
        occluders.front_uv.size(), occluders.back_uv.size());
  }
  for (std::size_t index = 0; index < occluders.positions.size(); ++index) {
    if (!finite(occluders.positions[index]))
      return broken_model("position {}: expected finite numbers", index);
  }
  for (std::size_t index = 0; index < count; ++index) {
    if (auto checked = check_triangle(model, index); !checked) return checked;
  }
  const auto uv_finite = [](const glm::vec2& uv) { return finite(uv); };
  if (!std::all_of(occluders.front_uv.begin(), occluders.front_uv.end(), uv_finite) ||
      !std::all_of(occluders.back_uv.begin(), occluders.back_uv.end(), uv_finite)) {
    return broken_model("occluders: expected finite lightmap coordinates");
  }
  if (auto checked = check_opacity(occluders.opacity, count); !checked) return checked;
  if (auto checked = check_texture(occluders.texture, count); !checked) return checked;
  return check_bvh(occluders);
}

/// Numbers over all systems fit 32 bits.
Result<void> check_totals(const Model& model) {
  std::uint64_t senders = model.sky_cells.size() + model.sky_tree.nodes.size() + model.top_tree.size();
  std::uint64_t gather_rows = 0;
  for (const System& system : model.systems) {
    senders += system.clusters.size() + system.tree.nodes.size();
    gather_rows += system.lumels.size() + system.sensors.size();
  }
  if (senders < kNone && gather_rows < kNone) return {};
  return broken_model("expected fewer than 2^32 - 1 senders and gather rows, found {} and {}", senders,
                      gather_rows);
}

}  // namespace

Result<void> check_model(const Model& model) {
  if (auto checked = check_globals(model); !checked) return checked;
  if (auto checked = check_all_names(model); !checked) return checked;
  if (auto checked = check_occluders(model); !checked) return checked;
  if (auto checked = check_totals(model); !checked) return checked;
  for (std::size_t index = 0; index < model.systems.size(); ++index) {
    if (auto checked = check_system(model, index); !checked) return checked;
  }
  if (auto checked = check_top_tree(model); !checked) return checked;
  return check_halvings(model);
}

}  // namespace relume
