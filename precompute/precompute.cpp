// SPDX-License-Identifier: MIT
#include "precompute/precompute.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>

#include "precompute/arena_threads.h"
#include "precompute/check_sizes.h"
#include "precompute/clearance.h"
#include "precompute/complete_model.h"
#include "precompute/estimate.h"
#include "precompute/estimate_errors.h"
#include "precompute/find_hollows.h"
#include "precompute/lift_sensor.h"
#include "precompute/pilot.h"
#include "precompute/place_probes.h"
#include "precompute/process_memory.h"
#include "precompute/rows_keeper.h"
#include "precompute/trace_rows.h"

namespace relume {
namespace {

constexpr std::uint32_t kSkyResolution = RayCodes::kSkyResolution;
/// Clusters are made anew while their error is estimated so many times as large as its share of the target,
/// and smaller ones lessen it to this share; a few times at most.
constexpr double kEnough = 1.1, kWorthwhile = 0.8;
constexpr int kMostAttempts = 3;
/// Light between probes that are placed automatically may be off by so much, or by the error target if that
/// is more.
constexpr double kProbeError = 0.12;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string options_json(const PrecomputeOptions& options, const PrecomputeReport& report,
                         const RowPlan& plan) {
  constexpr std::array<const char*, 3> kCodecs{"f32", "unorm16", "sqrt8"};
  const std::string reached =
      options.error > 0.0
          ? fmt::format(R"(,"estimated":{{"clusters":{:.3g},"rays":{:.3g},"cut":{:.3g},"precision":{:.3g}}})",
                        report.error.clusters, report.error.rays, report.error.cut, report.error.precision)
          : "";
  const std::string asked = std::string(options.reciprocal ? R"(,"reciprocal":true)" : "") +
                            (plan.clearance_share > 0.0 ? R"(,"clearance":true)" : "") +
                            (options.keep_hollows ? R"(,"hollows":true)" : "") +
                            (options.bounds ? R"(,"bounds":true)" : "") +
                            (options.directional ? R"(,"directional":true)" : "");
  return fmt::format(
      R"({{"error":{},"texel_size":{},"cluster_size":{},"quality":{},"sensor_quality":{},"budget":{},"system_lumels":{},"codec":"{}","max_albedo":{},"seed":{}{}{}}})",
      options.error, report.texel_size, report.cluster_size, plan.lumels.rays, plan.sensors.rays,
      options.budget, options.system_lumels, kCodecs[std::size_t(plan.codec)], options.max_albedo,
      options.seed, asked, reached);
}

/// What rows are traced against, with clusters of one choice of sizes.
struct Preparation {
  Emitters emitters;
  RowScene rows;
  SenderTree senders;
  std::optional<Probing> probing;  ///< where rows are cut

  Preparation(const Scene& scene, const Surfaces& surfaces, const RayCaster& caster,
              const SenderLookup& lookup, std::uint64_t seed, RayMemory* memory)
      : emitters(possible_emitters(scene, surfaces)),
        rows{surfaces.geometry, caster, lookup, emitters, surfaces.cluster_count(),
             kSkyResolution,    {},     seed,   false,    memory} {
    rows.sky_senders.resize(6 * kSkyResolution * kSkyResolution);
    std::iota(rows.sky_senders.begin(), rows.sky_senders.end(), surfaces.cluster_count());
    if (memory != nullptr)
      follow_senders(lookup, emitters, rows.sky_senders, std::uint32_t(sender_count(rows)), *memory);
  }

  const Probing* known() const { return probing ? &*probing : nullptr; }
  Preparation(const Preparation&) = delete;
};

/// Clusters, and a survey where rows will be cut; with a target, clusters as small as it asks for.
Result<void> prepare(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                     const RowPlan& plan, const ProgressObserver& observer, Surfaces& surfaces,
                     SenderLookup& lookup, RayMemory* memory, std::optional<Preparation>& prepared,
                     RowCounts& counts, PrecomputeReport& report) {
  std::vector<std::vector<float>> known;
  if (plan.clearance_share > 0.0) {
    for (const ClusteredSurface& system : surfaces.systems)
      known.push_back(clearances(surfaces.geometry, caster, surfaces.charts, system.surface));
  }
  double share = plan.clearance_share, before = 0.0;
  ElementRooms rooms;
  for (int attempt = 0;; ++attempt) {
    cluster_surfaces(scene, caster, report, share, known, surfaces);
    lookup.follow_clusters();
    prepared.emplace(scene, surfaces, caster, lookup, options.seed, memory);
    const bool too_many = sender_count(prepared->rows) > kMaxImports;  // some must be joined
    if (!plan.cut && !too_many && !options.auto_probes) {
      prepared->senders = plain_senders(kSkyResolution, surfaces.systems);
      return {};
    }
    auto surveyed = survey(prepared->rows, surfaces.charts, surfaces.systems, lookup, prepared->emitters,
                           rooms, counts, observer);
    if (!surveyed) return tl::unexpected(surveyed.error());
    if (auto ok = check_budgets(scene, surfaces, surveyed->senders.tree, surveyed->rows, plan.node_cuts); !ok)
      return ok;
    prepared->senders = std::move(surveyed->senders);
    prepared->probing = std::move(surveyed->probing);
    const double excess = prepared->probing->cluster_error / std::max(kClusterShare * options.error, 1e-9);
    const bool helped = attempt == 0 || excess < kWorthwhile * before;
    if (share <= 0.0 || excess <= kEnough || !helped || attempt == kMostAttempts) return {};
    before = excess;
    share *= std::max(0.4, 1.0 / excess);
  }
}

/// What the error target leaves open in the plan, from a sample of rows.
void follow_target(const Surfaces& surfaces, const PrecomputeOptions& options, const Preparation& prepared,
                   RowCounts& counts, RowPlan& plan) {
  plan.lumels.probing = plan.sensors.probing = prepared.known();
  if (options.error <= 0.0) return;
  std::size_t elements = 0;
  for (const ClusteredSurface& system : surfaces.systems) elements += system.surface.elements.size();
  plan.lumels.area = plan.sensors.area = surfaces.geometry.area / double(elements);
  const std::vector<PilotRows> pilot = trace_pilot(prepared.rows, surfaces.charts, surfaces.systems,
                                                   *prepared.probing, plan.lumels.area, counts);
  const double share = options.bounds ? kCutShareForBounds : kCutShare;
  const double node_error =
      find_node_error(pilot, prepared.senders.tree, *prepared.probing, share * options.error);
  for (CutLimits& cut : plan.node_cuts) cut.node_error = node_error;
  plan.sensor_cut.node_error = node_error;
  if (!plan.adaptive) return;
  plan.lumels.exchange = find_exchange(pilot, plan.lumels, kRayShare * options.error);
  if (plan.sensors.least < plan.sensors.rays) plan.sensors.exchange = plan.lumels.exchange;
}

/// Probes that turn out to see back faces speak for nothing.
ProbeVolume without_invalid_probes(ProbeVolume volume, std::span<const ProbeRow> rows) {
  for (ProbeCell& cell : volume.cells) {
    for (std::uint32_t& probe : cell.probes) {
      if (probe != kNoProbe && rows[probe].back_face_share > kInvalidProbeShare) probe = kNoProbe;
    }
  }
  return volume;
}

/// All that rows are traced from.
struct Start {
  const Scene& scene;
  const PrecomputeOptions& options;
  const RayCaster& caster;
  const Surfaces& surfaces;
  const Preparation& prepared;
  ScenePart& scene_part;
  RowsKeeper* keeper;                 ///< or nothing
  std::vector<SurfacePoint> sensors;  ///< lifted
  std::vector<ProbePoint> probes;
  ProbeVolume volume;  ///< of them
};

Result<Model> trace_model(const Start& start, const RowPlan& plan, RowCounts& counts,
                          PrecomputeReport& report, const ProgressObserver& observer) {
  const auto& [scene, options, caster, surfaces, prepared, scene_part, keeper, sensors, probes, volume] =
      start;
  const auto rays_start = std::chrono::steady_clock::now();
  auto rows = trace_rows(prepared.rows, surfaces, prepared.senders, sensors, probes, plan, prepared.known(),
                         counts, observer);
  if (!rows) return tl::unexpected(rows.error());
  report.rays = counts.rays;
  report.traced_rays = counts.traced + report.occlusion_rays, report.kept_rays = counts.kept;
  report.occlusion_rays += counts.occlusion_rays;
  report.seconds_rays += seconds_since(rays_start);
  report.projection = rows->projection;
  if (plan.cut) estimate_errors(*rows, surfaces, *prepared.probing, options.error, plan.codec, report);

  if (observer && !observer("rows", 0.0))
    return fail(ErrorCode::cancelled, "stopped before rows were stored");
  const ModelParts parts{scene,
                         surfaces.geometry,
                         surfaces.charts,
                         surfaces.layouts,
                         surfaces.systems,
                         surfaces.own_elements,
                         rows->systems,
                         rows->sensors,
                         rows->sensor_systems,
                         rows->orders,
                         rows->tiles,
                         rows->flux ? &*rows->flux : nullptr,
                         rows->probes,
                         prepared.emitters,
                         prepared.senders,
                         surfaces.cluster_count()};
  const bool keeps = keeper != nullptr && options.keep_rows && prepared.rows.memory != nullptr;
  auto model = complete_model(scene_part, parts, options, plan.codec, caster, keeper, keeps, report);
  if (!model) return model;
  if (!probes.empty()) model->probe_volume = without_invalid_probes(volume, rows->probes.rows);
  if (!scene.cameras.empty()) model->camera = scene.cameras.front();
  model->provenance = {scene.file_name, "relume 0.1.0", caster.description(),
                       options_json(options, report, plan)};
  return model;
}

std::vector<ProbePoint> some_of(const std::vector<ProbePoint>& points, std::size_t most) {
  std::vector<ProbePoint> some;
  const std::size_t every = std::max<std::size_t>(1, points.size() / most);
  for (std::size_t i = 0; i < points.size(); i += every) some.push_back(points[i]);
  return some;
}

/// The same with few rows and few probes.
Result<PrecomputeEstimate> estimate_model(Start start, RowPlan plan, double seconds_before,
                                          const ProgressObserver& observer) {
  SampleFacts facts;
  facts.probes = start.probes.size();
  facts.volume_bytes = sizeof(std::uint32_t) * probe_volume_words(start.volume).size();
  start.probes = some_of(start.probes, kSampledProbes), start.volume = {};
  facts.every = sample_every(start.surfaces.cluster_count());
  facts.cut = plan.cut;
  facts.seconds_before = seconds_before;
  return_free_memory();  // of the survey: rows would use it again
  facts.resident_bytes = resident_bytes(), facts.peak_bytes = peak_resident_bytes();
  plan.lumels.every = plan.sensors.every = facts.every;
  plan.reciprocal = false;  // rows without their counterparts
  PrecomputeReport unused;
  const auto model = trace_model(start, plan, facts.counts, unused, observer);
  if (!model) return tl::unexpected(model.error());
  facts.seconds_rows = unused.seconds_rays, facts.seconds_after = unused.seconds_rows;
  return extrapolate(*model, facts);
}

Result<void> check_memory(const PrecomputeOptions& options, const PrecomputeEstimate& estimate) {
  if (options.max_memory == 0 || estimate.memory_bytes <= options.max_memory) return {};
  constexpr double kMega = 1e-6;
  return fail(
      ErrorCode::out_of_memory,
      fmt::format(
          "memory: expected at most {:.0f} MB (--max-memory), found a need of about {:.0f} MB; "
          "{} larger --cluster-size or --texel-size, or fewer rays (--quality), need less",
          kMega * double(options.max_memory), kMega * double(estimate.memory_bytes),
          options.budget > 0 || options.error > 0.0 ? "a" : "rows that are cut (--error or --budget), a"));
}

/// What rays are cast at, and where they are or were kept, who knows of it.
Result<RayCaster> cast(const Scene& scene, const PrecomputeOptions& options, const Geometry& geometry,
                       PrecomputeReport& report, std::unique_ptr<RowsKeeper>& keeper) {
  if (!options.keep_rows && options.old_rows == nullptr) return make_caster(geometry);
  auto started = RowsKeeper::start(scene, options, geometry, report);
  if (!started) return tl::unexpected(started.error());
  keeper = std::move(*started);
  return make_caster(geometry, keeper->known_ties(geometry));
}

/// The caster, and the charts of what receives light.
Result<RayCaster> cast_and_chart(const Scene& scene, const PrecomputeOptions& options, Geometry& geometry,
                                 PrecomputeReport& report, std::unique_ptr<RowsKeeper>& keeper,
                                 std::vector<Chart>& charts) {
  choose_sizes(options, geometry, report);
  std::optional<Result<RayCaster>> caster;
  const auto chart = [&] { charts = make_charts(scene, geometry, report.texel_size, report.warnings); };
  const bool hollows = !options.keep_hollows && may_have_hollows(geometry);
  // What all else waits for comes last: the calling thread begins with it.
  tbb::parallel_invoke(
      [&] {
        if (!hollows) chart();
      },
      [&] { caster.emplace(cast(scene, options, geometry, report, keeper)); });
  if (!*caster || !hollows) return std::move(*caster);
  leave_out_hollows(scene, options, **caster, geometry, report);
  chart();
  return std::move(*caster);
}

/// The model; where only an `estimate` is asked for, an empty one.
Result<Model> build(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport& report,
                    const ProgressObserver& observer, PrecomputeEstimate* estimate) {
  const auto start = std::chrono::steady_clock::now();
  if (scene.triangles.empty())
    return fail(ErrorCode::bad_input, fmt::format("{}: no static triangles to precompute", scene.file_name));
  Geometry geometry = make_geometry(scene);
  if (auto ok = check_sizes(options, geometry); !ok) return tl::unexpected(ok.error());
  if (observer && !observer("surfaces", 0.0))
    return fail(ErrorCode::cancelled, "stopped before the surfaces were cut");
  std::unique_ptr<RowsKeeper> keeper;
  std::vector<Chart> charts;
  const auto caster = cast_and_chart(scene, options, geometry, report, keeper, charts);
  if (!caster) return tl::unexpected(caster.error());
  const auto earlier = keeper ? keeper->earlier() : std::nullopt;
  ScenePart scene_part(scene, geometry, *caster,
                       keeper ? keeper->earlier_looks(geometry, *caster) : std::nullopt);
  auto surfaces = cut_surfaces(scene, options, *caster, geometry, std::move(charts), report,
                               earlier ? &*earlier : nullptr);
  if (!surfaces) return tl::unexpected(surfaces.error());
  RowPlan plan = plan_rows(options, scene);
  RowCounts counts;
  SenderLookup lookup(surfaces->geometry, surfaces->charts, surfaces->layouts, surfaces->systems, *caster);
  if (keeper) {
    if (auto followed = keeper->follow(*surfaces, lookup, *caster, report); !followed)
      return tl::unexpected(followed.error());
  }
  std::optional<Preparation> prepared;
  if (auto done = prepare(scene, options, *caster, plan, observer, *surfaces, lookup,
                          keeper ? &keeper->memory() : nullptr, prepared, counts, report);
      !done)
    return tl::unexpected(done.error());
  report.seconds_surfaces = seconds_since(start);
  follow_target(*surfaces, options, *prepared, counts, plan);
  prepared->rows.directional = options.directional;  // from here on: nothing before asks for directions
  report.seconds_rays = seconds_since(start) - report.seconds_surfaces;
  Start rows{scene, options, *caster, *surfaces, *prepared, scene_part, keeper.get(), {}, options.probes, {}};
  if (options.auto_probes || options.probe_spacing > 0.0) {
    auto placed = options.auto_probes ? place_probes(prepared->rows, *prepared->probing,
                                                     std::max(options.error, kProbeError), counts, observer)
                                      : place_probe_grid(surfaces->geometry, *caster, options.probe_spacing);
    if (!placed) return tl::unexpected(placed.error());
    rows.probes = std::move(placed->points), rows.volume = std::move(placed->volume);
  }
  for (const SensorPoint& sensor : options.sensors)
    rows.sensors.push_back(lift_sensor(surfaces->geometry, *caster, sensor.position, sensor.normal));
  if (estimate != nullptr || options.max_memory > 0) {
    prepared->rows.memory = nullptr;  // a sample is not kept
    auto expected = estimate_model(rows, plan, seconds_since(start), observer);
    prepared->rows.memory = keeper ? &keeper->memory() : nullptr;
    if (!expected) return tl::unexpected(expected.error());
    if (keeper) expected->memory_bytes += keeper->memory_of(expected->rays);
    if (auto ok = check_memory(options, *expected); !ok) return tl::unexpected(ok.error());
    if (estimate != nullptr) {
      *estimate = *expected;
      estimate->rays += counts.rays + counts.occlusion_rays + report.occlusion_rays;
      return Model{};
    }
  }
  auto model = trace_model(rows, plan, counts, report, observer);
  if (model && options.keep_rows) report.rows = keeper->finish(report);
  report.seconds_total = seconds_since(start);
  report.peak_memory = peak_resident_bytes();
  return model;
}

/// What a precompute needs that ran out of memory, for a sentence: from a few rows, where memory is enough
/// for these; no less than what it has had.
std::string needed_memory(const Scene& scene, PrecomputeOptions options, const ProgressObserver& observer) {
  constexpr double kMega = 1e-6;
  const std::uint64_t had = peak_address_bytes();
  options.max_memory = 0;
  try {
    PrecomputeEstimate estimate;
    PrecomputeReport unused;
    const bool estimated = build(scene, options, unused, observer, &estimate).has_value();
    const std::uint64_t needed = estimated ? estimate.memory_bytes + reserved_bytes() : 0;
    if (needed > had) return fmt::format("about {:.0f} MB", kMega * double(needed));
  } catch (const std::bad_alloc&) {
  }
  return fmt::format("more than {:.0f} MB", kMega * double(had));
}

/// build() in an arena of as many threads as asked for.
Result<Model> build_in_arena(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport& report,
                             const ProgressObserver& observer, PrecomputeEstimate* estimate) {
  if (auto ok = check_options(options); !ok) return tl::unexpected(ok.error());
  tbb::task_arena arena(arena_threads(options.threads));
  try {
    return arena.execute([&] { return build(scene, options, report, observer, estimate); });
  } catch (const std::bad_alloc&) {
    const std::string needed = arena.execute([&] { return needed_memory(scene, options, observer); });
    return fail(ErrorCode::out_of_memory,
                fmt::format("{}: memory ran out: expected {}, found less; a larger --cluster-size or "
                            "--texel-size, or fewer rays (--quality), need less",
                            scene.file_name, needed));
  }
}

}  // namespace

Result<Model> precompute(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport& report,
                         const ProgressObserver& observer) {
  return build_in_arena(scene, options, report, observer, nullptr);
}

Result<PrecomputeEstimate> estimate_precompute(const Scene& scene, const PrecomputeOptions& options,
                                               PrecomputeReport& report, const ProgressObserver& observer) {
  PrecomputeEstimate estimate;
  if (auto done = build_in_arena(scene, options, report, observer, &estimate); !done)
    return tl::unexpected(done.error());
  return estimate;
}

}  // namespace relume
