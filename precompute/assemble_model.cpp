// SPDX-License-Identifier: MIT
#include "precompute/assemble_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <set>

#include "scene/surface_color.h"

namespace relume {
namespace {

/// Sky cells that any row uses, ascending.
std::vector<std::uint32_t> used_sky_cells(const ModelParts& parts) {
  std::vector<bool> used(6 * parts.sky_resolution * parts.sky_resolution, false);
  const auto mark = [&](const FormFactorRow& row) {
    for (const auto sender : row.senders) {
      if (sender >= parts.cluster_count) used[sender - parts.cluster_count] = true;
    }
  };
  for (const SystemRows& system : parts.rows) {
    for (const auto& row : system.clusters) mark(row);
    for (const auto& row : system.elements) mark(row);
  }
  for (const auto& row : parts.sensor_rows) mark(row);
  std::vector<std::uint32_t> cells;
  for (std::uint32_t c = 0; c < used.size(); ++c) {
    if (used[c]) cells.push_back(c);
  }
  return cells;
}

/// Elements in the order that the model stores: by cluster, then by cell.
std::vector<std::uint32_t> stored_order(const ClusteredSurface& surface) {
  std::vector<std::uint32_t> order(surface.cluster.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return surface.cluster[a] < surface.cluster[b]; });
  return order;
}

void store_elements(const ClusteredSurface& surface, const std::vector<std::uint32_t>& order,
                    System& system) {
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
  system.clusters.resize(surface.cluster_count);
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

void store_charts(const ModelParts& parts, const SystemLayout& layout, System& system) {
  std::set<std::pair<std::uint32_t, Side>> listed;
  for (std::size_t i = 0; i < layout.charts.size(); ++i) {
    const Chart& chart = parts.charts[layout.charts[i]];
    if (chart.uv_set == 1) {
      system.charts.push_back(
          {chart.node, chart.side, 1, chart.uv_scale, chart.uv_offset + glm::vec2(layout.positions[i])});
    } else if (listed.insert({chart.node, chart.side}).second) {
      system.charts.push_back(
          {chart.node, chart.side, kNone, glm::vec2(layout.width, layout.height), glm::vec2(0.0f)});
    }
  }
}

/// The senders that some rows use, as an import table, and the local column of each.
class ImportTable {
 public:
  ImportTable(const ModelParts& parts, const std::vector<std::uint32_t>& sky_cells)
      : parts_(parts),
        sky_cells_(sky_cells),
        column_(parts.cluster_count + 6 * parts.sky_resolution * parts.sky_resolution, kNone) {}
  void use(const FormFactorRow& row) {
    for (const auto sender : row.senders) column_[sender] = 0;
  }
  std::vector<SenderRef> finish() {
    std::vector<SenderRef> imports;
    for (std::uint32_t sender = 0; sender < column_.size(); ++sender) {
      if (column_[sender] == kNone) continue;
      column_[sender] = std::uint32_t(imports.size());
      imports.push_back(reference(sender));
    }
    return imports;
  }
  void append(const FormFactorRow& row, BlockMatrixBuilder& matrix) const {
    std::vector<std::uint16_t> columns;
    std::vector<double> values(row.values.begin(), row.values.end());
    for (const auto sender : row.senders) columns.push_back(std::uint16_t(column_[sender]));
    matrix.append_row(columns, values);
  }

 private:
  SenderRef reference(std::uint32_t sender) const {
    if (sender >= parts_.cluster_count) {
      const auto found =
          std::lower_bound(sky_cells_.begin(), sky_cells_.end(), sender - parts_.cluster_count);
      return {kSkySystem, std::uint32_t(found - sky_cells_.begin())};
    }
    std::uint32_t s = 0;
    while (sender >= parts_.surfaces[s].first_cluster + parts_.surfaces[s].cluster_count) ++s;
    return {s, sender - parts_.surfaces[s].first_cluster};
  }
  const ModelParts& parts_;
  const std::vector<std::uint32_t>& sky_cells_;
  std::vector<std::uint32_t> column_;
};

/// Sensors go to the first system: only there are their rows needed.
Result<void> store_matrices(const ModelParts& parts, std::size_t s,
                            const std::vector<std::uint32_t>& sky_cells,
                            const std::vector<std::uint32_t>& order, ValueCodec codec, System& system) {
  const SystemRows& rows = parts.rows[s];
  ImportTable imports(parts, sky_cells);
  for (const auto& row : rows.clusters) imports.use(row);
  for (const auto& row : rows.elements) imports.use(row);
  if (s == 0) {
    for (const auto& row : parts.sensor_rows) imports.use(row);
  }
  system.imports = imports.finish();
  if (system.imports.size() > kMaxImports) {
    return fail(ErrorCode::usage, fmt::format("system {} sees {} clusters and sky patches, more than the {} "
                                              "that its columns can name; choose a larger cluster size",
                                              system.name, system.imports.size(), kMaxImports));
  }
  BlockMatrixBuilder bounce(std::uint32_t(system.imports.size()), codec),
      gather(std::uint32_t(system.imports.size()), codec);
  for (const auto& row : rows.clusters) imports.append(row, bounce);
  for (const auto e : order) {
    if (parts.own_elements[s][e]) imports.append(rows.elements[e], gather);
  }
  if (s == 0) {
    for (const auto& row : parts.sensor_rows) imports.append(row, gather);
  }
  system.bounce = std::move(bounce).finish();
  system.gather = std::move(gather).finish();
  return {};
}

Occluders make_occluders(const ModelParts& parts) {
  const Geometry& geometry = parts.geometry;
  Occluders occluders{geometry.positions, geometry.triangles, geometry.material, geometry.node, {}, {}, {}};
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
  return occluders;
}

void store_colors(const Scene& scene, double max_albedo, Model& model, PrecomputeReport& report) {
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
    report.warnings.push_back(
        fmt::format("{} materials reflect more than {}; their albedo was lowered to it (--max-albedo)",
                    colors.clamped_materials, max_albedo));
  }
}

}  // namespace

std::vector<bool> own_elements(const Scene& scene, const std::vector<Chart>& charts,
                               const SystemSurface& surface) {
  std::vector<bool> own(surface.elements.size(), false);
  for (std::size_t cell = 0; cell + 1 < surface.first_element.size(); ++cell) {
    std::uint32_t largest = kNone;
    for (auto e = surface.first_element[cell]; e < surface.first_element[cell + 1]; ++e) {
      if (largest == kNone || surface.elements[e].area > surface.elements[largest].area) largest = e;
    }
    if (largest == kNone) continue;
    const SceneNode& node = scene.nodes[charts[surface.elements[largest].chart].node];
    own[largest] = node.extras.receiver.value_or("lightmap") == "lightmap";
  }
  return own;
}

Result<Model> assemble_model(const ModelParts& parts, const PrecomputeOptions& options,
                             PrecomputeReport& report) {
  Model model;
  model.origin = parts.geometry.origin;
  model.max_albedo = options.max_albedo;
  model.sky_resolution = parts.sky_resolution;
  model.sky_cells = used_sky_cells(parts);
  for (std::size_t s = 0; s < parts.surfaces.size(); ++s) {
    System system;
    system.name = parts.layouts[s].name;
    system.lightmap_width = parts.layouts[s].width;
    system.lightmap_height = parts.layouts[s].height;
    const auto order = stored_order(parts.surfaces[s]);
    store_elements(parts.surfaces[s], order, system);
    store_clusters(parts, parts.surfaces[s], order, system);
    store_lumels(parts, s, order, system, report);
    store_charts(parts, parts.layouts[s], system);
    if (auto stored = store_matrices(parts, s, model.sky_cells, order, options.codec, system); !stored)
      return tl::unexpected(stored.error());
    model.systems.push_back(std::move(system));
  }
  std::vector<bool> emits(parts.scene.materials.size(), false);
  for (const Emitter& e : parts.emitters.list) emits[e.material] = true;
  for (std::size_t m = 0; m < parts.scene.materials.size(); ++m) {
    model.materials.push_back(
        {parts.scene.materials[m].name, parts.scene.materials[m].double_sided, emits[m]});
  }
  GeometryHash hash = geometry_hash(parts.scene);
  model.nodes = std::move(hash.nodes);
  model.geometry_hash = hash.total;
  model.occluders = make_occluders(parts);
  store_colors(parts.scene, options.max_albedo, model, report);
  return model;
}

}  // namespace relume
