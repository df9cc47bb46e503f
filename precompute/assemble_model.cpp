// SPDX-License-Identifier: MIT
#include "precompute/assemble_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <set>

#include "precompute/store_matrices.h"
#include "scene/surface_color.h"
#include "scene/texture_triangles.h"

namespace relume {
namespace {

void store_elements(const ClusteredSurface& surface, const std::vector<std::uint32_t>& order,
                    System& system) {
  system.elements.reserve(order.size());
  system.pieces.reserve(surface.surface.pieces.size());
  for (const auto e : order) {
    const Element& element = surface.surface.elements[e];
    system.elements.push_back({element.position, element.area, element.normal, surface.cluster[e],
                               std::uint32_t(system.pieces.size()), element.piece_count});
    for (std::uint32_t p = 0; p < element.piece_count; ++p) {
      system.pieces.push_back(surface.surface.pieces[element.first_piece + p].shape);
    }
  }
}

void store_clusters(const ModelParts& parts, const ClusteredSurface& surface,
                    const std::vector<std::uint32_t>& order, System& system) {
  std::vector<glm::dvec3> centroids(surface.cluster_count, glm::dvec3(0.0)), normals = centroids;
  std::vector<double> areas(surface.cluster_count, 0.0);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const Element& element = surface.surface.elements[order[i]];
    const std::uint32_t c = surface.cluster[order[i]];
    Cluster& cluster = system.clusters[c];
    if (cluster.element_count++ == 0) {
      cluster.first_element = i;
      cluster.material = element.material;
      cluster.node = parts.charts[element.chart].node;
      cluster.side = parts.charts[element.chart].side;
    }
    areas[c] += element.area;
    centroids[c] += double(element.area) * glm::dvec3(element.position);
    normals[c] += double(element.area) * glm::dvec3(element.normal);
  }
  for (std::size_t c = 0; c < areas.size(); ++c) {
    system.clusters[c].area = float(areas[c]);
    system.clusters[c].centroid = glm::vec3(centroids[c] / areas[c]);
    const bool cancels = glm::length(normals[c]) < 1e-6 * areas[c];
    system.clusters[c].normal = cancels ? system.elements[system.clusters[c].first_element].normal
                                        : glm::vec3(glm::normalize(normals[c]));
  }
}

void store_lumels(const ModelParts& parts, std::size_t s, const std::vector<std::uint32_t>& order,
                  System& system, PrecomputeReport& report) {
  const SystemSurface& surface = parts.surfaces[s].surface;
  system.lumels.reserve(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const std::uint32_t e = order[i];
    if (!parts.own_elements[s][e]) continue;
    const Element& element = surface.elements[e];
    std::uint32_t flags = 0;
    if (parts.rows[s].element_back_face_share[e] > kInvalidShare)
      flags |= kLumelInvalid, ++report.invalid_lumels;
    if (element.split) flags |= kLumelSplit, ++report.split_lumels;
    system.lumels.push_back(
        {std::uint16_t(element.cell % surface.width), std::uint16_t(element.cell / surface.width), i, flags});
  }
}

/// What is known of how exact the rows are.
void store_estimates(const ModelParts& parts, std::size_t s, System& system) {
  const ClusteredSurface& surface = parts.surfaces[s];
  system.rays.resize(surface.cluster_count);
  for (std::size_t e = 0; e < surface.cluster.size(); ++e) {
    const RowRays& rays = parts.rows[s].element_rays[e];
    system.rays[surface.cluster[e]] = {rays.count, rays.noise, rays.variance};
  }
  if (parts.tiles.empty()) return;
  for (const CutTile& tile : parts.tiles[s].lumels)
    system.cut_errors.insert(system.cut_errors.end(), tile.error.begin(), tile.error.end());
}

bool has_lightmap(const SceneNode& node) {
  return node.extras.receiver.value_or("lightmap") == "lightmap";
}

void store_charts(const ModelParts& parts, const AtlasLayout& layout, System& system) {
  std::set<std::pair<std::uint32_t, Side>> listed;
  for (std::size_t i = 0; i < layout.charts.size(); ++i) {
    const Chart& chart = parts.charts[layout.charts[i]];
    if (!has_lightmap(parts.scene.nodes[chart.node])) continue;
    if (chart.uv_set == 1) {
      system.charts.push_back(
          {chart.node, chart.side, 1, chart.uv_scale, chart.uv_offset + glm::vec2(layout.positions[i])});
    } else if (listed.insert({chart.node, chart.side}).second) {
      system.charts.push_back(
          {chart.node, chart.side, kNone, glm::vec2(layout.width, layout.height), glm::vec2(0.0f)});
    }
  }
}

/// Backs of hollows look like their fronts, whoever may see them.
void show_hollows(const Geometry& geometry, Occluders& occluders) {
  if (occluders.back_uv.empty()) return;
  for (std::size_t t = 0; t < geometry.hollow.size(); ++t) {
    const auto first = std::ptrdiff_t(3 * t);
    if (geometry.hollow[t])
      std::copy_n(occluders.front_uv.begin() + first, 3, occluders.back_uv.begin() + first);
  }
}

void store_occluders(const ModelParts& parts, Occluders& occluders) {
  const Geometry& geometry = parts.geometry;
  occluders.positions = geometry.positions, occluders.triangles = geometry.triangles;
  occluders.material = geometry.material, occluders.node = geometry.node;
  occluders.opacity = geometry.opacity.stored();
  occluders.system.assign(geometry.triangles.size(), kNone);
  occluders.front_uv.assign(3 * geometry.triangles.size(), glm::vec2(0.0f));
  for (std::uint32_t s = 0; s < parts.layouts.size(); ++s) {
    for (std::size_t i = 0; i < parts.layouts[s].charts.size(); ++i) {
      const Chart& chart = parts.charts[parts.layouts[s].charts[i]];
      auto& uv = chart.side == Side::front ? occluders.front_uv : occluders.back_uv;
      uv.resize(3 * geometry.triangles.size(), glm::vec2(0.0f));
      for (std::size_t m = 0; m < chart.triangles.size(); ++m) {
        occluders.system[chart.triangles[m]] = s;
        for (std::size_t k = 0; k < 3; ++k)
          uv[3 * chart.triangles[m] + k] = chart.corners[m][k] + glm::vec2(parts.layouts[s].positions[i]);
      }
    }
  }
  show_hollows(geometry, occluders);
}

/// Patches of the sky that no column means have no place in the model.
void drop_unseen_sky(Model& model) {
  std::vector<bool> seen(model.sky_cells.size(), false);
  const auto leaves = std::uint32_t(seen.size());
  for (const System& system : model.systems) {
    for (const SenderRef& sender : system.imports) {
      if (sender.system == kSkySystem && sender.index < leaves) seen[sender.index] = true;
    }
  }
  for (const TreeNode& node : model.sky_tree.nodes) std::fill_n(seen.begin() + node.first, node.count, true);
  std::vector<std::uint32_t> place(leaves + 1, 0), cells;
  for (std::uint32_t i = 0; i < leaves; ++i) {
    place[i] = std::uint32_t(cells.size());
    if (seen[i]) cells.push_back(model.sky_cells[i]);
  }
  for (System& system : model.systems) {
    for (SenderRef& sender : system.imports) {
      if (sender.system != kSkySystem) continue;
      sender.index =
          sender.index < leaves ? place[sender.index] : std::uint32_t(cells.size()) + sender.index - leaves;
    }
  }
  for (TreeNode& node : model.sky_tree.nodes) node.first = place[node.first];
  model.sky_cells = std::move(cells);
}

}  // namespace

std::vector<std::uint32_t> stored_order(const ClusteredSurface& surface) {
  std::vector<std::uint32_t> order(surface.cluster.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return surface.cluster[a] < surface.cluster[b]; });
  return order;
}

std::vector<bool> own_elements(const Scene& scene, const std::vector<Chart>& charts,
                               const SystemSurface& surface) {
  std::vector<bool> own(surface.elements.size(), false);
  for (std::size_t cell = 0; cell + 1 < surface.first_element.size(); ++cell) {
    std::uint32_t largest = kNone;
    for (auto e = surface.first_element[cell]; e < surface.first_element[cell + 1]; ++e) {
      if (largest == kNone || surface.elements[e].area > surface.elements[largest].area) largest = e;
    }
    if (largest == kNone) continue;
    own[largest] = has_lightmap(scene.nodes[charts[surface.elements[largest].chart].node]);
  }
  return own;
}

void start_model(const ModelParts& parts, double max_albedo, Model& model) {
  model.origin = parts.geometry.origin;
  model.max_albedo = max_albedo;
  model.sky_resolution = parts.senders.sky_resolution;
  model.sky_cells = parts.senders.sky_cells;
  for (std::size_t s = 0; s < parts.surfaces.size(); ++s) {
    System& system = model.systems.emplace_back();
    system.name = parts.layouts[s].name;
    system.lightmap_width = parts.layouts[s].width;
    system.lightmap_height = parts.layouts[s].height;
    system.clusters.resize(parts.surfaces[s].cluster_count);
  }
}

void store_surfaces(const ModelParts& parts, Model& model, PrecomputeReport& report) {
  for (std::size_t s = 0; s < parts.surfaces.size(); ++s) {
    System& system = model.systems[s];
    const auto& order = parts.element_orders[s];
    store_elements(parts.surfaces[s], order, system);
    store_clusters(parts, parts.surfaces[s], order, system);
    store_lumels(parts, s, order, system, report);
    store_charts(parts, parts.layouts[s], system);
    store_estimates(parts, s, system);
  }
  std::vector<bool> emits(parts.scene.materials.size(), false);
  for (const Emitter& e : parts.emitters.list) emits[e.material] = true;
  for (std::size_t m = 0; m < parts.scene.materials.size(); ++m) {
    model.materials.push_back(
        {parts.scene.materials[m].name, parts.scene.materials[m].double_sided, emits[m]});
  }
  store_occluders(parts, model.occluders);
  model.occluders.texture = texture_triangles(parts.scene, emits);
}

void store_colors(const Scene& scene, double max_albedo, Model& model, std::vector<std::string>& warnings) {
  const ClusterColors colors = cluster_colors(model, scene, max_albedo);
  std::size_t next = 0;
  for (System& system : model.systems) {
    for (Cluster& cluster : system.clusters) {
      for (int c = 0; c < 3; ++c) {
        cluster.albedo[std::size_t(c)] = float(colors.albedo[next][c]);
        cluster.exitance[std::size_t(c)] = float(colors.exitance[next][c]);
      }
      ++next;
    }
  }
  if (colors.clamped_materials > 0) {
    warnings.push_back(
        fmt::format("{} materials reflect more than {}; their albedo was lowered to it (--max-albedo)",
                    colors.clamped_materials, max_albedo));
  }
}

/// Where many lumels are invalid, the scene is not what its author thinks.
void warn_of_invalid_lumels(const Model& model, std::vector<std::string>& warnings) {
  constexpr double kMany = 0.1;
  std::vector<std::uint64_t> of_node(model.nodes.size(), 0);
  std::uint64_t lumels = 0, invalid = 0;
  for (const System& system : model.systems) {
    for (const Lumel& lumel : system.lumels) {
      ++lumels;
      if ((lumel.flags & kLumelInvalid) == 0) continue;
      ++invalid;
      ++of_node[system.clusters[system.elements[lumel.element].cluster].node];
    }
  }
  if (double(invalid) <= kMany * double(lumels)) return;
  const auto most = std::max_element(of_node.begin(), of_node.end()) - of_node.begin();
  warnings.push_back(
      fmt::format("{} of {} lumels see mostly the backs of surfaces, and take the light of their neighbours; "
                  "most of them lie "
                  "on {}: inside other geometry, or below a ceiling whose only side faces away (relume "
                  "export --debug validity)",
                  invalid, lumels, model.nodes[std::size_t(most)].path));
}

Result<void> store_rows(const ModelParts& parts, ValueCodec codec, Model& model, PrecomputeReport& report) {
  if (auto stored = store_matrices(parts, codec, model, report); !stored) return stored;
  drop_unseen_sky(model);
  return {};
}

}  // namespace relume
