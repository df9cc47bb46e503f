// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/light_patches.h"
#include "core/model_checks.h"

namespace relume {
namespace {

// Sums of areas and cut corners are rounded to 32 bits.
constexpr double kAreaTolerance = 1e-3;
// Rounded to 32 bits, from many leaves.
constexpr double kShareTolerance = 1e-4;
constexpr float kBarycentricTolerance = 1e-3f;

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

/// What the checks of one system need; `index` names it in messages.
struct SystemPlace {
  const Model& model;
  const System& system;
  std::size_t index;
};

Result<void> check_cluster(const SystemPlace& at, std::size_t index, std::uint32_t first_element) {
  const Cluster& cluster = at.system.clusters[index];
  if (!finite(cluster.centroid))
    return broken_model("system {}, cluster {}: expected a finite centroid", at.index, index);
  if (!positive(cluster.area)) {
    return broken_model("system {}, cluster {}: expected an area above 0, found {}", at.index, index,
                        cluster.area);
  }
  if (!unit(cluster.normal))
    return broken_model("system {}, cluster {}: expected a normal of length 1", at.index, index);
  const double albedo_limit = at.model.max_albedo * (1.0 + 1e-6);
  if (!within(cluster.albedo, albedo_limit)) {
    return broken_model("system {}, cluster {}: expected an albedo from 0 to {}", at.index, index,
                        at.model.max_albedo);
  }
  if (!within(cluster.exitance, 1e30)) {
    return broken_model("system {}, cluster {}: expected a finite exitance >= 0", at.index, index);
  }
  if (cluster.material >= at.model.materials.size() || cluster.node >= at.model.nodes.size() ||
      !valid_side(cluster.side)) {
    return broken_model(
        "system {}, cluster {}: expected a material below {}, a node below {} and side 0 or 1, found {}, {}, "
        "{}",
        at.index, index, at.model.materials.size(), at.model.nodes.size(), cluster.material, cluster.node,
        static_cast<std::uint32_t>(cluster.side));
  }
  const std::uint64_t end = std::uint64_t{cluster.first_element} + cluster.element_count;
  if (cluster.first_element != first_element || cluster.element_count == 0 ||
      end > at.system.elements.size()) {
    return broken_model(
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
      return broken_model("system {}, element {}: expected cluster {}, found {}", at.index,
                          cluster.first_element + k, index, element.cluster);
    }
    area += element.area;
  }
  if (!(std::abs(area - cluster.area) <= kAreaTolerance * cluster.area)) {
    return broken_model("system {}, cluster {}: expected the area of its elements, {}, found {}", at.index,
                        index, area, cluster.area);
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
    return broken_model("system {}: expected {} elements, as its clusters have, found {}", at.index,
                        next_element, at.system.elements.size());
  }
  return {};
}

Result<void> check_piece(const SystemPlace& at, std::uint32_t index, const Cluster& cluster) {
  const SurfacePiece& piece = at.system.pieces[index];
  const Occluders& occluders = at.model.occluders;
  if (piece.triangle >= occluders.triangles.size()) {
    return broken_model("system {}, piece {}: expected a triangle below {}, found {}", at.index, index,
                        occluders.triangles.size(), piece.triangle);
  }
  const std::uint32_t triangle = piece.triangle;
  if (occluders.system[triangle] != at.index || occluders.material[triangle] != cluster.material ||
      occluders.node[triangle] != cluster.node) {
    return broken_model(
        "system {}, piece {}: expected a triangle of its cluster's system, material and node, found triangle "
        "{}",
        at.index, index, triangle);
  }
  for (const glm::vec2& corner : piece.corners) {
    const bool inside = finite(corner) && corner.x >= -kBarycentricTolerance &&
                        corner.y >= -kBarycentricTolerance &&
                        corner.x + corner.y <= 1.0f + kBarycentricTolerance;
    if (!inside) {
      return broken_model("system {}, piece {}: expected corners inside the triangle, found ({}, {})",
                          at.index, index, corner.x, corner.y);
    }
  }
  return {};
}

Result<void> check_elements(const SystemPlace& at) {
  std::uint64_t next_piece = 0;
  for (std::size_t index = 0; index < at.system.elements.size(); ++index) {
    const SurfaceElement& element = at.system.elements[index];
    if (!finite(element.position) || !unit(element.normal) || !positive(element.area)) {
      return broken_model(
          "system {}, element {}: expected a finite position, a normal of length 1 and an area above 0",
          at.index, index);
    }
    const std::uint64_t end = std::uint64_t{element.first_piece} + element.piece_count;
    if (element.first_piece != next_piece || element.piece_count == 0 || end > at.system.pieces.size()) {
      return broken_model(
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
  return broken_model("system {}: expected {} pieces, as its elements have, found {}", at.index, next_piece,
                      at.system.pieces.size());
}

Result<void> check_lumels(const SystemPlace& at) {
  std::vector<std::uint32_t> texels;
  for (std::size_t index = 0; index < at.system.lumels.size(); ++index) {
    const Lumel& lumel = at.system.lumels[index];
    if (lumel.x >= at.system.lightmap_width || lumel.y >= at.system.lightmap_height) {
      return broken_model("system {}, lumel {}: expected a texel of a lightmap of {} x {}, found ({}, {})",
                          at.index, index, at.system.lightmap_width, at.system.lightmap_height, lumel.x,
                          lumel.y);
    }
    if (lumel.element >= at.system.elements.size() || (lumel.flags & ~(kLumelInvalid | kLumelSplit)) != 0) {
      return broken_model(
          "system {}, lumel {}: expected an element below {} and known flags, found {} and {}", at.index,
          index, at.system.elements.size(), lumel.element, lumel.flags);
    }
    texels.push_back(std::uint32_t{lumel.y} << 16 | lumel.x);
  }
  std::sort(texels.begin(), texels.end());
  const auto twin = std::adjacent_find(texels.begin(), texels.end());
  if (twin == texels.end()) return {};
  return broken_model("system {}: expected one lumel per texel, found two at ({}, {})", at.index,
                      *twin & 0xffffu, *twin >> 16);
}

/// What direct light is sampled with.
Result<void> check_light_samples(const SystemPlace& at) {
  const System& system = at.system;
  if (system.lifted_sensors.size() != system.sensors.size() ||
      !std::all_of(system.lifted_sensors.begin(), system.lifted_sensors.end(),
                   [](const glm::vec3& p) { return finite(p); })) {
    return broken_model("system {}: expected {} finite points where sensors measure, found {}", at.index,
                        system.sensors.size(), system.lifted_sensors.size());
  }
  if (system.own_patches.empty()) return {};
  const std::size_t patches = patch_count(at.model, system);
  const std::size_t unused = 32 * system.own_patches.size() - patches;
  if (system.own_patches.size() != (patches + 31) / 32 ||
      (unused > 0 && system.own_patches.back() >> (32 - unused) != 0)) {
    return broken_model(
        "system {}: expected a bit for each of {} light patches and zeros after them, found {} words",
        at.index, patches, system.own_patches.size());
  }
  return {};
}

/// Numbers that only tell how rows came to be.
Result<void> check_estimates(const SystemPlace& at) {
  const System& system = at.system;
  const auto estimate = [](float value) { return std::isfinite(value) && value >= 0.0f; };
  if (!system.rays.empty() && system.rays.size() != system.clusters.size()) {
    return broken_model("system {}: expected rays of all {} clusters or of none, found {}", at.index,
                        system.clusters.size(), system.rays.size());
  }
  if (!system.cut_errors.empty() && system.cut_errors.size() != system.lumels.size()) {
    return broken_model("system {}: expected errors of all {} lumels or of none, found {}", at.index,
                        system.lumels.size(), system.cut_errors.size());
  }
  const bool valid = std::all_of(system.rays.begin(), system.rays.end(),
                                 [&](const ClusterRays& r) {
                                   return estimate(r.noise) && estimate(r.variance.surfaces) &&
                                          estimate(r.variance.emitters);
                                 }) &&
                     std::all_of(system.cut_errors.begin(), system.cut_errors.end(), estimate);
  if (valid) return {};
  return broken_model("system {}: expected finite estimates of noise and error, not below 0", at.index);
}

Result<void> check_sensors_and_charts(const SystemPlace& at) {
  for (std::size_t index = 0; index < at.system.sensors.size(); ++index) {
    const Sensor& sensor = at.system.sensors[index];
    if (!finite(sensor.position) || !unit(sensor.normal) || sensor.name >= at.model.sensor_names.size()) {
      return broken_model(
          "system {}, sensor {}: expected a finite position, a normal of length 1 and a name below {}",
          at.index, index, at.model.sensor_names.size());
    }
  }
  for (std::size_t index = 0; index < at.system.charts.size(); ++index) {
    const LightmapChart& chart = at.system.charts[index];
    if (chart.node >= at.model.nodes.size() || !valid_side(chart.side) || !finite(chart.scale) ||
        !finite(chart.offset)) {
      return broken_model("system {}, chart {}: expected a node below {}, side 0 or 1 and finite numbers",
                          at.index, index, at.model.nodes.size());
    }
  }
  return {};
}

Result<void> check_imports(const SystemPlace& at) {
  std::vector<std::tuple<std::uint32_t, std::uint32_t>> senders;
  for (std::size_t index = 0; index < at.system.imports.size(); ++index) {
    const SenderRef& sender = at.system.imports[index];
    const std::string owner = fmt::format("system {}, import {}", at.index, index);
    if (auto checked = check_sender(at.model, sender, owner); !checked) return checked;
    senders.emplace_back(sender.system, sender.index);
  }
  std::sort(senders.begin(), senders.end());
  if (std::adjacent_find(senders.begin(), senders.end()) == senders.end()) return {};
  return broken_model("system {}: expected each import once, found one twice", at.index);
}

Result<void> check_matrix(const SystemPlace& at, const BlockMatrix& matrix, const char* name,
                          std::size_t rows) {
  if (matrix.rows != rows || matrix.columns != at.system.imports.size()) {
    return broken_model("system {}, {} matrix: expected {} rows and {} columns, found {} and {}", at.index,
                        name, rows, at.system.imports.size(), matrix.rows, matrix.columns);
  }
  return check_block_matrix(matrix, fmt::format("model: system {}, {} matrix", at.index, name));
}

Result<void> check_not_loaded(const SystemPlace& at) {
  const System& system = at.system;
  const bool empty = system.clusters.empty() && system.elements.empty() && system.pieces.empty() &&
                     system.lumels.empty() && system.sensors.empty() && system.probes.empty() &&
                     system.probe_senders.empty() && system.charts.empty() && system.tree.nodes.empty() &&
                     system.imports.empty() && system.bounce.rows == 0 && system.gather.rows == 0;
  if (empty) return {};
  return broken_model("system {}: expected nothing in a system that is not loaded", at.index);
}

}  // namespace

Result<void> check_tree(const ClusterTreeNodes& tree, std::size_t leaves, const std::string& owner) {
  std::uint64_t next_share = 0;
  for (std::size_t index = 0; index < tree.nodes.size(); ++index) {
    const TreeNode& node = tree.nodes[index];
    if (node.count < 2 || std::uint64_t{node.first} + node.count > leaves) {
      return broken_model("{}, tree node {}: expected at least 2 of {} leaves, found {} from {} on", owner,
                          index, leaves, node.count, node.first);
    }
    if (node.first_share != next_share || next_share + node.count > tree.shares.size()) {
      return broken_model("{}, tree node {}: expected {} shares from {} on, found them from {} on of {}",
                          owner, index, node.count, next_share, node.first_share, tree.shares.size());
    }
    const auto shares = std::span(tree.shares).subspan(node.first_share, node.count);
    if (!are_shares(shares)) {
      return broken_model("{}, tree node {}: expected shares from 0 to 1 that add up to 1, found {}", owner,
                          index, std::accumulate(shares.begin(), shares.end(), 0.0));
    }
    next_share += node.count;
  }
  if (next_share == tree.shares.size()) return {};
  return broken_model("{}: expected {} shares, as the nodes of its tree have leaves, found {}", owner,
                      next_share, tree.shares.size());
}

bool are_shares(std::span<const float> values) {
  double sum = 0.0;
  for (const float value : values) {
    if (!(value >= 0.0f && value <= 1.0f)) return false;
    sum += value;
  }
  return std::abs(sum - 1.0) <= kShareTolerance;
}

Result<void> check_sender(const Model& model, const SenderRef& sender, const std::string& owner) {
  const bool sky = sender.system == kSkySystem, spanning = sender.system == kSpanningNodes;
  if (!sky && !spanning && sender.system >= model.systems.size()) {
    return broken_model("{}: expected a system below {} or the sky, found {}", owner, model.systems.size(),
                        sender.system);
  }
  if (!sky && !spanning && !model.systems[sender.system].loaded) return {};
  const std::size_t limit = sky        ? model.sky_cells.size() + model.sky_tree.nodes.size()
                            : spanning ? model.top_tree.size()
                                       : model.systems[sender.system].clusters.size() +
                                             model.systems[sender.system].tree.nodes.size();
  if (sender.index < limit) return {};
  return broken_model("{}: expected a {} below {}, found {}", owner,
                      sky        ? "sky patch or node"
                      : spanning ? "node above the systems"
                                 : "cluster or node",
                      limit, sender.index);
}

Result<void> check_system(const Model& model, std::size_t index) {
  const SystemPlace at{model, model.systems[index], index};
  if (!at.system.loaded) return check_not_loaded(at);
  if (auto checked = check_clusters(at); !checked) return checked;
  if (auto checked = check_elements(at); !checked) return checked;
  if (auto checked = check_lumels(at); !checked) return checked;
  if (auto checked = check_estimates(at); !checked) return checked;
  if (auto checked = check_sensors_and_charts(at); !checked) return checked;
  if (auto checked = check_light_samples(at); !checked) return checked;
  if (auto checked =
          check_tree(at.system.tree, at.system.clusters.size(), fmt::format("system {}", at.index));
      !checked) {
    return checked;
  }
  if (auto checked = check_imports(at); !checked) return checked;
  if (auto checked = check_probes(model, index); !checked) return checked;
  if (auto checked = check_matrix(at, at.system.bounce, "bounce", at.system.clusters.size()); !checked)
    return checked;
  for (const MatrixBlock& block : at.system.bounce.blocks) {
    if (!block.directions.empty())
      return broken_model("system {}, bounce matrix: expected no directions, found {}", at.index,
                          block.directions.size());
  }
  return check_matrix(at, at.system.gather, "gather", at.system.lumels.size() + at.system.sensors.size());
}

}  // namespace relume
