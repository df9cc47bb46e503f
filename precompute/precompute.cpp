// SPDX-License-Identifier: MIT
#include "precompute/precompute.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/sky.h"
#include "precompute/arena_threads.h"
#include "precompute/assemble_model.h"
#include "precompute/clusters.h"
#include "precompute/lift_sensor.h"
#include "precompute/rig.h"
#include "precompute/rows.h"

namespace relume {
namespace {

constexpr double kDefaultLumels = 40000.0;
constexpr double kDefaultClusters = 4000.0;
constexpr std::uint32_t kSkyResolution = 8;
constexpr std::uint32_t kMinSensorQuality = 4096;
constexpr std::uint32_t kMaxQuality = 1u << 20;
constexpr std::uint32_t kFewestSystemLumels = 64, kMostSystemLumels = 1u << 24;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Result<void> check_options(const PrecomputeOptions& options) {
  const auto bad = [](const std::string& text) { return fail(ErrorCode::usage, text); };
  if (!(options.texel_size >= 0.0) || !std::isfinite(options.texel_size)) {
    return bad(fmt::format("texel size {}: expected a length in metres above 0 (or 0 for automatic)",
                           options.texel_size));
  }
  if (!(options.cluster_size >= 0.0) || !std::isfinite(options.cluster_size)) {
    return bad(fmt::format("cluster size {}: expected a length in metres above 0 (or 0 for automatic)",
                           options.cluster_size));
  }
  if (options.quality < 8 || options.quality > kMaxQuality) {
    return bad(fmt::format("quality {}: expected 8 to {} rays per lumel", options.quality, kMaxQuality));
  }
  if (options.system_lumels < kFewestSystemLumels || options.system_lumels > kMostSystemLumels) {
    return bad(fmt::format("system lumels {}: expected {} to {} lumels in a system", options.system_lumels,
                           kFewestSystemLumels, kMostSystemLumels));
  }
  if (!(options.max_albedo > 0.0 && options.max_albedo <= 0.9999)) {
    return bad(fmt::format("max albedo {}: expected above 0 and at most 0.9999", options.max_albedo));
  }
  return {};
}

/// Sizes that were not asked for follow the scene's area; two significant digits, so that the number means
/// something to a reader.
double two_digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

void choose_sizes(const PrecomputeOptions& options, const Geometry& geometry, PrecomputeReport& report) {
  const double area = std::max(geometry.area, 1e-12);
  report.cluster_size =
      options.cluster_size > 0.0 ? options.cluster_size : two_digits(std::sqrt(area / kDefaultClusters));
  report.texel_size =
      options.texel_size > 0.0 ? options.texel_size : two_digits(std::sqrt(area / kDefaultLumels));
  if (options.texel_size <= 0.0) report.texel_size = std::min(report.texel_size, report.cluster_size);
  if (report.cluster_size < report.texel_size) report.cluster_size = report.texel_size;
}

std::vector<ClusteredSurface> make_surfaces(const Scene& scene, const Geometry& geometry,
                                            const std::vector<Chart>& charts,
                                            const std::vector<SystemLayout>& layouts, const RayCaster& caster,
                                            PrecomputeReport& report) {
  std::vector<ClusteredSurface> surfaces;
  const auto sizes = texel_sizes(scene, report.texel_size);
  std::uint32_t first = 0;
  for (const SystemLayout& layout : layouts) {
    ClusteredSurface surface;
    surface.surface = make_elements(geometry, charts, layout, caster);
    surface.cluster =
        make_clusters(geometry, charts, layout, surface.surface, caster, sizes, report.cluster_size);
    for (const auto c : surface.cluster) surface.cluster_count = std::max(surface.cluster_count, c + 1);
    surface.first_cluster = first;
    first += surface.cluster_count;
    report.occlusion_rays += surface.surface.occlusion_rays;
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

Emitters possible_emitters(const Scene& scene, const Geometry& geometry, const std::vector<Chart>& charts,
                           const std::vector<ClusteredSurface>& surfaces) {
  std::vector<bool> materials, nodes;
  for (const SceneMaterial& m : scene.materials) {
    materials.push_back(!m.unlit && (m.emission.r > 0.0 || m.emission.g > 0.0 || m.emission.b > 0.0));
  }
  for (const SceneNode& n : scene.nodes) nodes.push_back(n.extras.emitter.value_or(false));
  return find_emitters(geometry, charts, surfaces, materials, nodes);
}

std::string options_json(const PrecomputeOptions& options, const PrecomputeReport& report,
                         const RowOptions& rows) {
  constexpr std::array<const char*, 3> kCodecs{"f32", "unorm16", "sqrt8"};
  return fmt::format(
      R"({{"texel_size":{},"cluster_size":{},"quality":{},"sensor_quality":{},"budget":{},"system_lumels":{},"codec":"{}","max_albedo":{},"seed":{}}})",
      report.texel_size, report.cluster_size, rows.quality, rows.sensor_quality, options.budget,
      options.system_lumels, kCodecs[std::size_t(options.codec)], options.max_albedo, options.seed);
}

void add_sensors(const PrecomputeOptions& options, const std::vector<std::uint32_t>& systems, Model& model) {
  for (std::uint32_t i = 0; i < options.sensors.size(); ++i) {
    const SensorPoint& sensor = options.sensors[i];
    model.systems[systems[i]].sensors.push_back(
        {sensor.position, glm::vec3(glm::normalize(sensor.normal)), i});
    model.sensor_names.push_back(sensor.name);
  }
}

Result<Model> build(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport& report,
                    const ProgressObserver& observer) {
  const auto start = std::chrono::steady_clock::now();
  if (scene.triangles.empty())
    return fail(ErrorCode::bad_input, fmt::format("{}: no static triangles to precompute", scene.file_name));
  const Geometry geometry = make_geometry(scene);
  choose_sizes(options, geometry, report);
  auto caster = RayCaster::create(geometry.positions, geometry.triangles);
  if (!caster) return tl::unexpected(caster.error());
  if (observer && !observer("surfaces", 0.0))
    return fail(ErrorCode::cancelled, "stopped before the surfaces were cut");
  const auto charts = make_charts(scene, geometry, report.texel_size, report.warnings);
  const SystemLimits limits{options.system_lumels, report.cluster_size,
                            options.budget > 0 ? options.budget : options.quality};
  const auto layouts = lay_out_systems(scene, geometry, charts, *caster, limits, report.warnings);
  if (!layouts) return tl::unexpected(layouts.error());
  if (layouts->empty())
    return fail(ErrorCode::bad_input,
                fmt::format("{}: every node says receiver \"none\"; nothing is left to receive light",
                            scene.file_name));
  auto surfaces = make_surfaces(scene, geometry, charts, *layouts, *caster, report);
  const Emitters emitters = possible_emitters(scene, geometry, charts, surfaces);
  const SenderLookup lookup(geometry, charts, *layouts, surfaces, *caster);
  report.seconds_surfaces = seconds_since(start);

  const auto rays_start = std::chrono::steady_clock::now();
  const std::uint32_t cluster_count = surfaces.back().first_cluster + surfaces.back().cluster_count;
  const RowScene row_scene{geometry, *caster, lookup, emitters, cluster_count, kSkyResolution, options.seed};
  RowOptions row_options{options.quality, options.sensor_quality};
  if (row_options.sensor_quality == 0)
    row_options.sensor_quality = std::min(kMaxQuality, std::max(kMinSensorQuality, 16 * options.quality));
  RowCounts counts;
  std::vector<SystemRows> rows;
  std::vector<std::vector<bool>> own;
  for (const ClusteredSurface& surface : surfaces) {
    own.push_back(own_elements(scene, charts, surface.surface));
    auto traced = trace_system(row_scene, charts, surface, own.back(), row_options, counts, observer);
    if (!traced) return tl::unexpected(traced.error());
    rows.push_back(std::move(*traced));
  }
  std::vector<SurfacePoint> sensor_points;
  for (const SensorPoint& sensor : options.sensors)
    sensor_points.push_back(lift_sensor(geometry, *caster, sensor.position, sensor.normal));
  auto sensor_rows = trace_sensors(row_scene, sensor_points, row_options, counts, observer);
  if (!sensor_rows) return tl::unexpected(sensor_rows.error());
  report.rays = counts.rays;
  report.occlusion_rays += counts.occlusion_rays;
  report.seconds_rays = seconds_since(rays_start);

  const auto rows_start = std::chrono::steady_clock::now();
  if (observer && !observer("rows", 0.0))
    return fail(ErrorCode::cancelled, "stopped before rows were stored");
  const SenderTree senders = number_senders(emitters, kSkyResolution, surfaces, rows, *sensor_rows);
  const auto sensor_systems = systems_of_sensors(senders, surfaces.size(), *sensor_rows);
  const ModelParts parts{scene,        geometry,       charts,   *layouts, surfaces,      own,           rows,
                         *sensor_rows, sensor_systems, emitters, senders,  cluster_count, kSkyResolution};
  auto model = assemble_model(parts, options, report);
  report.seconds_rows = seconds_since(rows_start);
  if (!model) return model;
  add_sensors(options, sensor_systems, *model);
  light_model(scene, geometry, *caster, *model, report.warnings);
  if (!scene.cameras.empty()) model->camera = scene.cameras.front();
  model->provenance = {scene.file_name, "relume 0.1.0", caster->description(),
                       options_json(options, report, row_options)};
  report.seconds_total = seconds_since(start);
  return model;
}

}  // namespace

Result<Model> precompute(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport& report,
                         const ProgressObserver& observer) {
  if (auto ok = check_options(options); !ok) return tl::unexpected(ok.error());
  tbb::task_arena arena(arena_threads(options.threads));
  try {
    return arena.execute([&] { return build(scene, options, report, observer); });
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory,
                fmt::format("{}: out of memory during the precompute; choose a larger texel or cluster size",
                            scene.file_name));
  }
}

}  // namespace relume
