// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>
#include <tuple>

#include "core/model.h"

namespace relume {
namespace {

// Unit vectors are rounded to 32 bits, and so are sums of areas.
constexpr double kUnitTolerance = 1e-3;
constexpr double kAreaTolerance = 1e-3;
constexpr float kBarycentricTolerance = 1e-3f;
constexpr std::uint32_t kMaxSkyResolution = 4096;
constexpr std::size_t kMaxStringBytes = std::size_t{1} << 20;

template <class... Values>
tl::unexpected<Error> broken(fmt::format_string<Values...> sentence, Values&&... values) {
  return fail(ErrorCode::check_failed, "model: " + fmt::format(sentence, std::forward<Values>(values)...));
}

template <int N, class T>
bool finite(const glm::vec<N, T>& v) {
  for (int k = 0; k < N; ++k) {
    if (!std::isfinite(v[k])) return false;
  }
  return true;
}

template <class T>
bool unit(const glm::vec<3, T>& v) {
  return finite(v) && std::abs(glm::length(glm::dvec3(v)) - 1.0) < kUnitTolerance;
}

bool positive(double value) {
  return std::isfinite(value) && value > 0.0;
}

bool valid_side(Side side) {
  return side == Side::front || side == Side::back;
}

bool within(const std::array<float, 3>& rgb, double upper) {
  return std::all_of(rgb.begin(), rgb.end(),
                     [upper](float c) { return std::isfinite(c) && c >= 0.0f && c <= upper; });
}

bool non_negative(const Rgb& rgb) {
  return finite(rgb) && rgb.x >= 0.0 && rgb.y >= 0.0 && rgb.z >= 0.0;
}

Result<void> check_string(std::string_view what, const std::string& text) {
  if (text.size() <= kMaxStringBytes) return {};
  return broken("{}: expected at most {} bytes of text, found {}", what, kMaxStringBytes, text.size());
}

/// Names are bounded and, where `unique`, each is there once.
Result<void> check_names(std::string_view what, std::vector<std::string_view> names, bool unique) {
  for (const std::string_view name : names) {
    if (name.size() > kMaxStringBytes) {
      return broken("{}: expected names of at most {} bytes, found {}", what, kMaxStringBytes, name.size());
    }
  }
  std::sort(names.begin(), names.end());
  const auto twin = std::adjacent_find(names.begin(), names.end());
  if (unique && twin != names.end())
    return broken("{}: expected unique names, found '{}' twice", what, *twin);
  return {};
}

Result<void> check_all_names(const Model& model) {
  std::vector<std::string_view> materials, nodes, systems;
  for (const MaterialRecord& material : model.materials) materials.push_back(material.name);
  for (const NodeRecord& node : model.nodes) nodes.push_back(node.path);
  for (const System& system : model.systems) systems.push_back(system.name);
  const std::vector<std::string_view> sensors(model.sensor_names.begin(), model.sensor_names.end());
  const Provenance& from = model.provenance;
  if (auto checked = check_names("materials", materials, /*unique=*/true); !checked) return checked;
  if (auto checked = check_names("nodes", nodes, /*unique=*/true); !checked) return checked;
  if (auto checked = check_names("systems", systems, /*unique=*/true); !checked) return checked;
  if (auto checked = check_names("sensors", sensors, /*unique=*/false); !checked) return checked;
  return check_names("provenance", {from.scene_file, from.tool, from.ray_tracer, from.options},
                     /*unique=*/false);
}

Result<void> check_light(const Light& light, std::size_t index) {
  if (auto checked = check_string("light", light.name); !checked) return checked;
  if (static_cast<std::uint32_t>(light.type) > 2) {
    return broken("light {}: expected type 0, 1 or 2, found {}", index,
                  static_cast<std::uint32_t>(light.type));
  }
  if (!non_negative(light.intensity)) return broken("light {}: expected a finite intensity >= 0", index);
  if (!finite(light.position)) return broken("light {}: expected a finite position", index);
  if (!unit(light.direction)) return broken("light {}: expected a direction of length 1", index);
  if (!std::isfinite(light.range) || light.range < 0.0) {
    return broken("light {}: expected a finite range >= 0, found {}", index, light.range);
  }
  const bool cone = light.inner_cone_angle >= 0.0 && light.inner_cone_angle <= light.outer_cone_angle &&
                    light.outer_cone_angle <= kPi / 2.0 + 1e-6;
  if (!cone) {
    return broken("light {}: expected cone angles 0 <= inner <= outer <= pi/2, found {} and {}", index,
                  light.inner_cone_angle, light.outer_cone_angle);
  }
  return {};
}

Result<void> check_camera(const Camera& camera) {
  const bool directions =
      finite(camera.forward) && finite(camera.up) && glm::length(glm::cross(camera.forward, camera.up)) > 0.0;
  if (!finite(camera.position) || !directions) {
    return broken("camera: expected a finite position and two directions that are not parallel");
  }
  if (!(camera.vertical_field_of_view > 0.0 && camera.vertical_field_of_view < kPi)) {
    return broken("camera: expected a field of view between 0 and pi, found {}",
                  camera.vertical_field_of_view);
  }
  return {};
}

Result<void> check_globals(const Model& model) {
  if (!finite(model.origin)) return broken("expected a finite origin");
  if (!(model.max_albedo > 0.0 && model.max_albedo <= 0.9999)) {
    return broken("expected a largest albedo above 0 and at most 0.9999, found {}", model.max_albedo);
  }
  if (model.sky_resolution > kMaxSkyResolution) {
    return broken("expected a sky resolution of at most {}, found {}", kMaxSkyResolution,
                  model.sky_resolution);
  }
  const std::uint32_t cells = 6 * model.sky_resolution * model.sky_resolution;
  for (std::size_t patch = 0; patch < model.sky_cells.size(); ++patch) {
    if (model.sky_cells[patch] < cells) continue;
    return broken("sky patch {}: expected a cell below {}, found {}", patch, cells, model.sky_cells[patch]);
  }
  for (std::size_t index = 0; index < model.lights.size(); ++index) {
    if (auto checked = check_light(model.lights[index], index); !checked) return checked;
  }
  if (model.sky_radiance && !non_negative(*model.sky_radiance))
    return broken("expected a finite sky radiance >= 0");
  return model.camera ? check_camera(*model.camera) : Result<void>{};
}

Result<void> check_triangle(const Model& model, std::size_t index) {
  const Occluders& occluders = model.occluders;
  for (const std::uint32_t corner : occluders.triangles[index]) {
    if (corner >= occluders.positions.size()) {
      return broken("triangle {}: expected positions below {}, found {}", index, occluders.positions.size(),
                    corner);
    }
  }
  if (occluders.material[index] >= model.materials.size()) {
    return broken("triangle {}: expected a material below {}, found {}", index, model.materials.size(),
                  occluders.material[index]);
  }
  if (occluders.node[index] >= model.nodes.size()) {
    return broken("triangle {}: expected a node below {}, found {}", index, model.nodes.size(),
                  occluders.node[index]);
  }
  const std::uint32_t system = occluders.system[index];
  if (system != kNone && system >= model.systems.size()) {
    return broken("triangle {}: expected a system below {}, found {}", index, model.systems.size(), system);
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
    return broken(
        "occluders: expected {} materials, nodes and systems and {} lightmap corners, found {}, {}, {}, {} "
        "front "
        "and {} back",
        count, 3 * count, occluders.material.size(), occluders.node.size(), occluders.system.size(),
        occluders.front_uv.size(), occluders.back_uv.size());
  }
  for (std::size_t index = 0; index < occluders.positions.size(); ++index) {
    if (!finite(occluders.positions[index])) return broken("position {}: expected finite numbers", index);
  }
  for (std::size_t index = 0; index < count; ++index) {
    if (auto checked = check_triangle(model, index); !checked) return checked;
  }
  const auto uv_finite = [](const glm::vec2& uv) { return finite(uv); };
  if (!std::all_of(occluders.front_uv.begin(), occluders.front_uv.end(), uv_finite) ||
      !std::all_of(occluders.back_uv.begin(), occluders.back_uv.end(), uv_finite)) {
    return broken("occluders: expected finite lightmap coordinates");
  }
  return {};
}

/// What the checks of one system need; `index` names it in messages.
struct SystemPlace {
  const Model& model;
  const System& system;
  std::size_t index;
};

Result<void> check_cluster(const SystemPlace& at, std::size_t index, std::uint32_t first_element) {
  const Cluster& cluster = at.system.clusters[index];
  if (!finite(cluster.centroid))
    return broken("system {}, cluster {}: expected a finite centroid", at.index, index);
  if (!positive(cluster.area)) {
    return broken("system {}, cluster {}: expected an area above 0, found {}", at.index, index, cluster.area);
  }
  if (!unit(cluster.normal))
    return broken("system {}, cluster {}: expected a normal of length 1", at.index, index);
  const double albedo_limit = at.model.max_albedo * (1.0 + 1e-6);
  if (!within(cluster.albedo, albedo_limit)) {
    return broken("system {}, cluster {}: expected an albedo from 0 to {}", at.index, index,
                  at.model.max_albedo);
  }
  if (!within(cluster.exitance, 1e30)) {
    return broken("system {}, cluster {}: expected a finite exitance >= 0", at.index, index);
  }
  if (cluster.material >= at.model.materials.size() || cluster.node >= at.model.nodes.size() ||
      !valid_side(cluster.side)) {
    return broken(
        "system {}, cluster {}: expected a material below {}, a node below {} and side 0 or 1, found {}, {}, "
        "{}",
        at.index, index, at.model.materials.size(), at.model.nodes.size(), cluster.material, cluster.node,
        static_cast<std::uint32_t>(cluster.side));
  }
  const std::uint64_t end = std::uint64_t{cluster.first_element} + cluster.element_count;
  if (cluster.first_element != first_element || cluster.element_count == 0 ||
      end > at.system.elements.size()) {
    return broken(
        "system {}, cluster {}: expected at least one element from {} on, found {} from {} on of {}",
        at.index, index, first_element, cluster.element_count, cluster.first_element,
        at.system.elements.size());
  }
  return {};
}

Result<void> check_cluster_elements(const SystemPlace& at, std::size_t index) {
  const Cluster& cluster = at.system.clusters[index];
  double area = 0.0;
  for (std::uint32_t k = 0; k < cluster.element_count; ++k) {
    const SurfaceElement& element = at.system.elements[cluster.first_element + k];
    if (element.cluster != index) {
      return broken("system {}, element {}: expected cluster {}, found {}", at.index,
                    cluster.first_element + k, index, element.cluster);
    }
    area += element.area;
  }
  if (!(std::abs(area - cluster.area) <= kAreaTolerance * cluster.area)) {
    return broken("system {}, cluster {}: expected the area of its elements, {}, found {}", at.index, index,
                  area, cluster.area);
  }
  return {};
}

Result<void> check_clusters(const SystemPlace& at) {
  std::uint32_t next_element = 0;
  for (std::size_t index = 0; index < at.system.clusters.size(); ++index) {
    if (auto checked = check_cluster(at, index, next_element); !checked) return checked;
    if (auto checked = check_cluster_elements(at, index); !checked) return checked;
    next_element += at.system.clusters[index].element_count;
  }
  if (next_element != at.system.elements.size()) {
    return broken("system {}: expected {} elements, as its clusters have, found {}", at.index, next_element,
                  at.system.elements.size());
  }
  return {};
}

Result<void> check_piece(const SystemPlace& at, std::uint32_t index, const Cluster& cluster) {
  const SurfacePiece& piece = at.system.pieces[index];
  const Occluders& occluders = at.model.occluders;
  if (piece.triangle >= occluders.triangles.size()) {
    return broken("system {}, piece {}: expected a triangle below {}, found {}", at.index, index,
                  occluders.triangles.size(), piece.triangle);
  }
  const std::uint32_t triangle = piece.triangle;
  if (occluders.system[triangle] != at.index || occluders.material[triangle] != cluster.material ||
      occluders.node[triangle] != cluster.node) {
    return broken(
        "system {}, piece {}: expected a triangle of its cluster's system, material and node, found triangle "
        "{}",
        at.index, index, triangle);
  }
  for (const glm::vec2& corner : piece.corners) {
    const bool inside = finite(corner) && corner.x >= -kBarycentricTolerance &&
                        corner.y >= -kBarycentricTolerance &&
                        corner.x + corner.y <= 1.0f + kBarycentricTolerance;
    if (!inside) {
      return broken("system {}, piece {}: expected corners inside the triangle, found ({}, {})", at.index,
                    index, corner.x, corner.y);
    }
  }
  return {};
}

Result<void> check_elements(const SystemPlace& at) {
  std::uint64_t next_piece = 0;
  for (std::size_t index = 0; index < at.system.elements.size(); ++index) {
    const SurfaceElement& element = at.system.elements[index];
    if (!finite(element.position) || !unit(element.normal) || !positive(element.area)) {
      return broken(
          "system {}, element {}: expected a finite position, a normal of length 1 and an area above 0",
          at.index, index);
    }
    const std::uint64_t end = std::uint64_t{element.first_piece} + element.piece_count;
    if (element.first_piece != next_piece || element.piece_count == 0 || end > at.system.pieces.size()) {
      return broken(
          "system {}, element {}: expected at least one piece from {} on, found {} from {} on of {}",
          at.index, index, next_piece, element.piece_count, element.first_piece, at.system.pieces.size());
    }
    for (std::uint32_t k = 0; k < element.piece_count; ++k) {
      if (auto checked = check_piece(at, element.first_piece + k, at.system.clusters[element.cluster]);
          !checked) {
        return checked;
      }
    }
    next_piece = end;
  }
  if (next_piece == at.system.pieces.size()) return {};
  return broken("system {}: expected {} pieces, as its elements have, found {}", at.index, next_piece,
                at.system.pieces.size());
}

Result<void> check_lumels(const SystemPlace& at) {
  std::vector<std::uint32_t> texels;
  for (std::size_t index = 0; index < at.system.lumels.size(); ++index) {
    const Lumel& lumel = at.system.lumels[index];
    if (lumel.x >= at.system.lightmap_width || lumel.y >= at.system.lightmap_height) {
      return broken("system {}, lumel {}: expected a texel of a lightmap of {} x {}, found ({}, {})",
                    at.index, index, at.system.lightmap_width, at.system.lightmap_height, lumel.x, lumel.y);
    }
    if (lumel.element >= at.system.elements.size() || (lumel.flags & ~(kLumelInvalid | kLumelSplit)) != 0) {
      return broken("system {}, lumel {}: expected an element below {} and known flags, found {} and {}",
                    at.index, index, at.system.elements.size(), lumel.element, lumel.flags);
    }
    texels.push_back(std::uint32_t{lumel.y} << 16 | lumel.x);
  }
  std::sort(texels.begin(), texels.end());
  const auto twin = std::adjacent_find(texels.begin(), texels.end());
  if (twin == texels.end()) return {};
  return broken("system {}: expected one lumel per texel, found two at ({}, {})", at.index, *twin & 0xffffu,
                *twin >> 16);
}

Result<void> check_sensors_and_charts(const SystemPlace& at) {
  for (std::size_t index = 0; index < at.system.sensors.size(); ++index) {
    const Sensor& sensor = at.system.sensors[index];
    if (!finite(sensor.position) || !unit(sensor.normal) || sensor.name >= at.model.sensor_names.size()) {
      return broken(
          "system {}, sensor {}: expected a finite position, a normal of length 1 and a name below {}",
          at.index, index, at.model.sensor_names.size());
    }
  }
  for (std::size_t index = 0; index < at.system.charts.size(); ++index) {
    const LightmapChart& chart = at.system.charts[index];
    if (chart.node >= at.model.nodes.size() || !valid_side(chart.side) || !finite(chart.scale) ||
        !finite(chart.offset)) {
      return broken("system {}, chart {}: expected a node below {}, side 0 or 1 and finite numbers", at.index,
                    index, at.model.nodes.size());
    }
  }
  return {};
}

Result<void> check_imports(const SystemPlace& at) {
  std::vector<std::tuple<std::uint32_t, std::uint32_t>> senders;
  for (std::size_t index = 0; index < at.system.imports.size(); ++index) {
    const SenderRef& sender = at.system.imports[index];
    const bool sky = sender.system == kSkySystem;
    if (!sky && sender.system >= at.model.systems.size()) {
      return broken("system {}, import {}: expected a system below {} or the sky, found {}", at.index, index,
                    at.model.systems.size(), sender.system);
    }
    const std::size_t limit =
        sky ? at.model.sky_cells.size() : at.model.systems[sender.system].clusters.size();
    if (sender.index >= limit) {
      return broken("system {}, import {}: expected a {} below {}, found {}", at.index, index,
                    sky ? "sky patch" : "cluster", limit, sender.index);
    }
    senders.emplace_back(sender.system, sender.index);
  }
  std::sort(senders.begin(), senders.end());
  if (std::adjacent_find(senders.begin(), senders.end()) == senders.end()) return {};
  return broken("system {}: expected each import once, found one twice", at.index);
}

Result<void> check_matrix(const SystemPlace& at, const BlockMatrix& matrix, const char* name,
                          std::size_t rows) {
  if (matrix.rows != rows || matrix.columns != at.system.imports.size()) {
    return broken("system {}, {} matrix: expected {} rows and {} columns, found {} and {}", at.index, name,
                  rows, at.system.imports.size(), matrix.rows, matrix.columns);
  }
  return check_block_matrix(matrix, fmt::format("model: system {}, {} matrix", at.index, name));
}

Result<void> check_system(const SystemPlace& at) {
  if (auto checked = check_clusters(at); !checked) return checked;
  if (auto checked = check_elements(at); !checked) return checked;
  if (auto checked = check_lumels(at); !checked) return checked;
  if (auto checked = check_sensors_and_charts(at); !checked) return checked;
  if (auto checked = check_imports(at); !checked) return checked;
  const System& system = at.system;
  if (auto checked = check_matrix(at, system.bounce, "bounce", system.clusters.size()); !checked)
    return checked;
  return check_matrix(at, system.gather, "gather", system.lumels.size() + system.sensors.size());
}

/// Numbers over all systems fit 32 bits.
Result<void> check_totals(const Model& model) {
  std::uint64_t clusters = model.sky_cells.size();
  std::uint64_t gather_rows = 0;
  for (const System& system : model.systems) {
    clusters += system.clusters.size();
    gather_rows += system.lumels.size() + system.sensors.size();
  }
  if (clusters < kNone && gather_rows < kNone) return {};
  return broken("expected fewer than 2^32 - 1 senders and gather rows, found {} and {}", clusters,
                gather_rows);
}

}  // namespace

Result<void> check_model(const Model& model) {
  if (auto checked = check_globals(model); !checked) return checked;
  if (auto checked = check_all_names(model); !checked) return checked;
  if (auto checked = check_occluders(model); !checked) return checked;
  if (auto checked = check_totals(model); !checked) return checked;
  for (std::size_t index = 0; index < model.systems.size(); ++index) {
    if (auto checked = check_system({model, model.systems[index], index}); !checked) return checked;
  }
  return {};
}

}  // namespace relume
