// SPDX-License-Identifier: MIT
#include "precompute/surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/assemble_model.h"
#include "precompute/find_hollows.h"
#include "precompute/geometry_keys.h"
#include "precompute/lift_sensor.h"
#include "precompute/rows_file.h"
#include "precompute/views.h"

namespace relume {
namespace {

constexpr double kDefaultLumels = 40000.0;
constexpr double kDefaultClusters = 4000.0;
/// Where clearances decide, clusters may be so many times as large.
constexpr double kLargestOfDefault = 4.0;

/// A row keeps no more.
std::uint32_t expected_row_entries(const PrecomputeOptions& options) {
  constexpr std::uint32_t kOfTargets = 256;
  if (options.budget > 0) return options.budget;
  return options.error > 0.0 ? kOfTargets : std::max(512u, options.quality);
}

/// Sizes that were not asked for follow the scene's area; two significant digits, so that the number means
/// something to a reader.
double two_digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

KnownCells known_cells(const SceneChange& change, const ElementNamer& namer, std::uint32_t width) {
  return {[&change, &namer, width](const Element& cell, std::span<const Piece> pieces) {
            return change.had_element(namer.key(width, cell, pieces, 0, 1));
          },
          [&change](const glm::vec3& position, float reach) { return change.disturbed(position, reach); }};
}

}  // namespace

void choose_sizes(const PrecomputeOptions& options, const Geometry& geometry, PrecomputeReport& report) {
  const double area = std::max(geometry.area, 1e-12);
  report.cluster_size = two_digits(std::sqrt(area / kDefaultClusters));
  report.texel_size = two_digits(std::sqrt(area / kDefaultLumels));
  if (options.old_rows != nullptr) {
    report.cluster_size = options.old_rows->settings.cluster_size;
    report.texel_size = options.old_rows->settings.texel_size;
  }
  if (options.cluster_size > 0.0) report.cluster_size = options.cluster_size;
  if (options.texel_size > 0.0) report.texel_size = options.texel_size;
  if (options.texel_size <= 0.0) report.texel_size = std::min(report.texel_size, report.cluster_size);
  if (report.cluster_size < report.texel_size) report.cluster_size = report.texel_size;
}

void leave_out_hollows(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                       Geometry& geometry, PrecomputeReport& report) {
  std::vector<SurfacePoint> places;
  for (const SensorPoint& sensor : options.sensors)
    places.push_back(lift_sensor(geometry, caster, sensor.position, sensor.normal));
  geometry.hollow = find_hollows(scene, geometry, caster, {places, options.seed});
  for (std::size_t t = 0; t < geometry.hollow.size(); ++t)
    report.hollow_area += geometry.hollow[t] ? double(geometry.areas[t]) : 0.0;
  geometry.area -= report.hollow_area;
  choose_sizes(options, geometry, report);
}

Result<Surfaces> cut_surfaces(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                              const Geometry& geometry, std::vector<Chart> charts, PrecomputeReport& report,
                              const EarlierSurfaces* earlier) {
  Surfaces surfaces{geometry, {}, {}, {}, {}, {}};
  surfaces.charts = std::move(charts);
  const SystemLimits limits{options.system_lumels, report.cluster_size, expected_row_entries(options)};
  auto layouts = lay_out_systems(scene, surfaces.geometry, surfaces.charts, caster, limits, report.warnings);
  if (!layouts) return tl::unexpected(layouts.error());
  if (layouts->empty())
    return fail(ErrorCode::bad_input,
                fmt::format("{}: every node says receiver \"none\"; nothing is left to receive light",
                            scene.file_name));
  surfaces.layouts = std::move(*layouts);
  std::optional<ElementNamer> namer;
  if (earlier != nullptr && earlier->change.comparable())
    namer.emplace(surfaces.geometry, earlier->triangle_keys, surfaces.charts, surfaces.layouts);
  Views views(surfaces.geometry, caster, earlier != nullptr ? &earlier->change : nullptr, options.keep_rows);
  for (const AtlasLayout& layout : surfaces.layouts) {
    ClusteredSurface system;
    KnownCells known;
    if (namer) known = known_cells(earlier->change, *namer, layout.width);
    system.surface =
        make_elements(surfaces.geometry, surfaces.charts, layout, views, namer ? &known : nullptr);
    report.occlusion_rays += system.surface.occlusion_rays;
    surfaces.own_elements.push_back(own_elements(scene, surfaces.charts, system.surface));
    surfaces.systems.push_back(std::move(system));
  }
  surfaces.views = views.take_answers();
  return surfaces;
}

Result<Surfaces> cut_surfaces(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                              const Geometry& geometry, PrecomputeReport& report) {
  choose_sizes(options, geometry, report);
  auto charts = make_charts(scene, geometry, report.texel_size, report.warnings);
  return cut_surfaces(scene, options, caster, geometry, std::move(charts), report);
}

void cluster_surfaces(const Scene& scene, const RayCaster& caster, const PrecomputeReport& report,
                      double clearance_share, const std::vector<std::vector<float>>& clearances,
                      Surfaces& surfaces) {
  const auto texels = texel_sizes(scene, report.texel_size);
  std::uint32_t first = 0;
  for (std::size_t s = 0; s < surfaces.systems.size(); ++s) {
    ClusteredSurface& system = surfaces.systems[s];
    ClusterSizes sizes{report.cluster_size, 0.0, {}};
    if (clearance_share > 0.0)
      sizes = {kLargestOfDefault * report.cluster_size, clearance_share, clearances[s]};
    system.cluster = make_clusters(surfaces.geometry, surfaces.charts, surfaces.layouts[s], system.surface,
                                   caster, texels, sizes);
    system.cluster_count = 0;
    for (const auto c : system.cluster) system.cluster_count = std::max(system.cluster_count, c + 1);
    system.first_cluster = first;
    system.senders.resize(system.cluster_count);
    std::iota(system.senders.begin(), system.senders.end(), first);
    first += system.cluster_count;
  }
}

Emitters possible_emitters(const Scene& scene, const Surfaces& surfaces) {
  std::vector<bool> materials, nodes;
  for (const SceneMaterial& m : scene.materials) {
    materials.push_back(shines(m));
  }
  for (const SceneNode& n : scene.nodes) nodes.push_back(n.extras.emitter.value_or(false));
  return find_emitters(surfaces.geometry, surfaces.charts, surfaces.systems, materials, nodes);
}

}  // namespace relume
