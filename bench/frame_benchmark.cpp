// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <system_error>

#include "benchmarks.h"
#include "core/model_file.h"
#include "core/sky.h"
#include "frames.h"
#include "measure/converged_answer.h"
#include "measure/statistics.h"
#include "measure/test_lights.h"

namespace relume::bench {
namespace {

constexpr double kManyClusters = 100e3;
constexpr std::uint32_t kManyClustersQuality = 8;  ///< their rows do not matter

/// A series of values for each stage of a frame.
class StageTimes {
 public:
  explicit StageTimes(std::string name) : name_(std::move(name)) {}

  void add(const FrameTimes& times) {
    const double values[] = {times.host,    times.device(), times.inputs,   times.direct_light,
                             times.bounces, times.gather,   times.lightmaps};
    for (std::size_t i = 0; i < std::size(values); ++i) values_[i].push_back(kMilli * values[i]);
  }

  void report(std::vector<Measurement>& out) const {
    constexpr const char* kStages[] = {"host clock", "device", "inputs",   "direct light",
                                       "bounces",    "gather", "lightmaps"};
    for (std::size_t i = 0; i < std::size(kStages); ++i)
      out.push_back({fmt::format("{}, {}", name_, kStages[i]), "ms", values_[i]});
  }

 private:
  std::string name_;
  std::vector<double> values_[7];
};

struct FrameBench {
  const BenchmarkOptions& options;
  StandaloneDevice& device;
  const Model& model;
  LampPlace place;
  std::vector<Light> lights;  ///< of the scene, and a lamp that moves
  Lighting lighting;
  std::vector<Measurement> out{};

  void add(const std::string& name, const char* unit, std::vector<double> values) {
    out.push_back({name, unit, std::move(values)});
  }
};

Light lamp_at(const LampPlace& place, double angle) {
  Light lamp;
  lamp.intensity = Rgb(1000.0 * place.radius * place.radius);
  lamp.position = place.position + 0.5 * place.radius * glm::dvec3(std::cos(angle), 0.0, std::sin(angle));
  return lamp;
}

std::vector<kernels::MaterialState> scaled(std::size_t count, double factor) {
  return std::vector<kernels::MaterialState>(count, scaled_material(Rgb(factor), Rgb(1.0)));
}

/// A lamp moves and all materials change, in every frame; one bounce and two in turns.
Result<void> measure_stages(FrameBench& bench, FrameSession& session) {
  std::vector<StageTimes> times;
  for (std::uint32_t k = 1; k <= kMostBounces; ++k) times.emplace_back(fmt::format("k = {}", k));
  for (std::uint32_t r = 0; r < bench.options.repetitions; ++r) {
    for (std::uint32_t k = 1; k <= kMostBounces; ++k) {
      bench.lights.back() = lamp_at(bench.place, 0.1 + 0.1 * double(kMostBounces * r + k));
      const auto states = scaled(bench.model.materials.size(), r % 2 == 0 ? 0.9 : 1.0);
      const auto shown = session.frame({.lights = bench.lights, .materials = states, .bounces = k});
      if (!shown) return tl::unexpected(shown.error());
      times[k - 1].add(*shown);
    }
  }
  for (const StageTimes& of_k : times) of_k.report(bench.out);
  return {};
}

std::vector<Light> circle_of_lamps(const LampPlace& place) {
  std::vector<Light> lamps;
  for (std::size_t i = 0; i < 8; ++i) lamps.push_back(lamp_at(place, 0.78 * double(i)));
  return lamps;
}

/// What direct light takes when nothing, one, or all of 8 lamps have moved since the last frame.
Result<void> measure_moved_lights(FrameBench& bench, FrameSession& session, const std::string& rays_of) {
  std::vector<Light> lamps = circle_of_lamps(bench.place);
  if (auto all = session.frame({.lights = lamps}); !all) return tl::unexpected(all.error());
  for (const std::size_t moved : {std::size_t{0}, std::size_t{1}, lamps.size()}) {
    std::vector<double> milliseconds, per_lamp, rays;
    for (std::uint32_t r = 0; r < bench.options.repetitions; ++r) {
      for (std::size_t i = 0; i < moved; ++i) lamps[i].position.y += 0.01 * bench.place.radius;
      const auto shown = session.frame({.lights = lamps});
      if (!shown) return tl::unexpected(shown.error());
      milliseconds.push_back(kMilli * shown->direct_light);
      rays.push_back(double(shown->shadow_rays));
      if (moved > 0) per_lamp.push_back(milliseconds.back() / double(moved));
    }
    const std::string name = fmt::format("{} of {} lamps moved, {}", moved, lamps.size(), rays_of);
    bench.add(name + ", direct light", "ms", milliseconds);
    if (moved > 0) bench.add(name + ", each", "ms", per_lamp);
    bench.add(name + ", shadow rays", "rays", rays);
  }
  return {};
}

/// The same with few shadow rays, and what that changes of the indirect irradiance that lamps bring.
Result<void> measure_few_rays(FrameBench& bench, FrameSession& session) {
  constexpr double kFew = 2.0;
  constexpr std::uint32_t kConverged = 40;
  FrameSessionOptions options = frame_options(bench.device, bench.model);
  options.patches_per_element = kFew;
  auto few = FrameSession::create(bench.device, bench.model, options);
  if (!few) return tl::unexpected(few.error());
  if (auto done = measure_moved_lights(bench, *few, fmt::format("{} rays a lumel", kFew)); !done) return done;
  const std::vector<Light> lamps = circle_of_lamps(bench.place);
  const auto stored = scaled(bench.model.materials.size(), 1.0);
  std::vector<double> differences;
  for (const Light& lamp : lamps) {
    std::vector<std::vector<Rgb>> irradiance;
    for (FrameSession* of : {&session, &*few}) {
      const auto shown = of->frame({.lights = {&lamp, 1},
                                    .materials = stored,
                                    .sky = bench.lighting.sky_radiosity,
                                    .bounces = kConverged});
      if (!shown) return tl::unexpected(shown.error());
      auto read = of->read_irradiance();
      if (!read) return tl::unexpected(read.error());
      irradiance.push_back(std::move(*read));
    }
    differences.push_back(relative_difference(irradiance[1], irradiance[0]));
  }
  bench.add(fmt::format("{} rays a lumel change indirect irradiance by", kFew), "", differences);
  return {};
}

/// From the file to the first lightmaps: all that a program does that has a device.
Result<void> measure_first_frame(FrameBench& bench) {
  const auto file =
      std::filesystem::temp_directory_path() / ("relume-bench-" + std::to_string(getpid()) + ".relume");
  if (auto written = write_model(bench.model, file); !written) return written;
  std::vector<double> read_times, load_times, frame_times, sums;
  Result<void> failure;
  for (std::uint32_t r = 0; r < bench.options.repetitions && failure; ++r) {
    Result<Model> read;
    read_times.push_back(kMilli * seconds_of([&] { read = read_model(file); }));
    if (!read) {
      failure = tl::unexpected(read.error());
      break;
    }
    std::optional<Result<FrameSession>> session;
    load_times.push_back(kMilli * seconds_of([&] {
                           session =
                               FrameSession::create(bench.device, *read, frame_options(bench.device, *read));
                         }));
    const auto shown = *session ? (*session)->frame({.lights = bench.lights})
                                : Result<FrameTimes>(tl::unexpected(session->error()));
    if (!shown) failure = tl::unexpected(shown.error());
    frame_times.push_back(shown ? kMilli * shown->host : 0.0);
    sums.push_back(read_times.back() + load_times.back() + frame_times.back());
  }
  std::error_code ignored;
  const auto bytes = std::filesystem::file_size(file, ignored);
  std::filesystem::remove(file, ignored);
  bench.add("file", "bytes", {double(bytes)});
  bench.add("to the first frame, file read", "ms", read_times);
  bench.add("to the first frame, pipelines and upload", "ms", load_times);
  bench.add("to the first frame, frame of one bounce", "ms", frame_times);
  bench.add("to the first frame", "ms", sums);
  return failure;
}

/// Clusters without lumels, many.
Result<Model> many_clusters(Scene scene) {
  for (SceneNode& node : scene.nodes) {
    if (!node.extras.receiver) node.extras.receiver = "clusters";
  }
  PrecomputeOptions chosen;
  chosen.texel_size = std::sqrt(area_of(scene) / kManyClusters);
  chosen.cluster_size = chosen.texel_size;
  chosen.quality = kManyClustersQuality;
  PrecomputeReport report;
  return precompute(scene, chosen, report);
}

Result<void> check_albedo(FrameSession& session, const Lighting& stored, double factor) {
  const auto found = session.read_albedo();
  if (!found) return tl::unexpected(found.error());
  for (std::size_t i = 0; i < found->size(); ++i) {
    const Rgb expected = glm::min(factor * stored.albedo[i], Rgb(MaterialPassOptions{}.max_albedo));
    if (!(glm::length((*found)[i] - expected) <= 1e-5))
      return fail(ErrorCode::check_failed, fmt::format("the albedo of cluster {} is wrong", i));
  }
  return {};
}

/// The stage of inputs of frames in which the albedo of every cluster changes, by material or one by one.
Result<void> measure_albedos(FrameBench& bench, const Scene& scene) {
  const auto model = many_clusters(scene);
  if (!model) return tl::unexpected(model.error());
  const Lighting stored = stored_lighting(*model);
  bench.add("all albedos, clusters", "", {double(stored.albedo.size())});
  for (const StatePer per : {StatePer::material, StatePer::cluster}) {
    FrameSessionOptions options = frame_options(bench.device, *model);
    options.materials.states = per;
    auto session = FrameSession::create(bench.device, *model, options);
    if (!session) return tl::unexpected(session.error());
    const std::size_t count = per == StatePer::material ? model->materials.size() : stored.albedo.size();
    std::vector<double> device, host;
    for (std::uint32_t r = 0; r <= bench.options.repetitions; ++r) {
      const double factor = r % 2 == 0 ? 0.5 : 0.75;
      const auto states = scaled(count, factor);
      const auto shown = session->frame({.materials = states, .bounces = 0});
      if (!shown) return tl::unexpected(shown.error());
      if (auto right = check_albedo(*session, stored, factor); !right) return right;
      if (r == 0) continue;  // pipelines compile
      device.push_back(kMilli * shown->inputs);
      host.push_back(kMilli * shown->host);
    }
    const std::string name =
        fmt::format("all albedos, {}", per == StatePer::material ? "by material" : "by cluster");
    bench.add(name + ", device", "ms", device);
    bench.add(name + ", host clock of a frame of 0 bounces", "ms", host);
  }
  return {};
}

Result<void> measure(FrameBench& bench, const Scene& scene) {
  auto session = FrameSession::create(bench.device, bench.model, frame_options(bench.device, bench.model));
  if (!session) return tl::unexpected(session.error());
  std::size_t clusters = 0, lumels = 0;
  for (const System& system : bench.model.systems)
    clusters += system.clusters.size(), lumels += system.lumels.size();
  bench.add("clusters", "", {double(clusters)});
  bench.add("lumels", "", {double(lumels)});
  bench.add("entries of a bounce and a gather", "", {double(session->entries())});
  if (auto right = check_frame(*session, bench.model, bench.lights, bench.lighting); !right) return right;
  if (auto done = measure_stages(bench, *session); !done) return done;
  const std::string all_rays = fmt::format("{} rays a lumel", kPatchesPerElement);
  if (auto done = measure_moved_lights(bench, *session, all_rays); !done) return done;
  if (auto done = measure_few_rays(bench, *session); !done) return done;
  if (auto done = measure_first_frame(bench); !done) return done;
  return measure_albedos(bench, scene);
}

}  // namespace

Measurements frame(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const auto place = lamp_place(*scene);
  if (!place) return tl::unexpected(place.error());
  const auto model = model_with_error(options, *scene);
  if (!model) return tl::unexpected(model.error());
  auto device = StandaloneDevice::create({});
  if (!device) return tl::unexpected(device.error());
  FrameBench bench{options, *device, *model, *place, model->lights, stored_lighting(*model)};
  bench.lights.push_back(lamp_at(*place, 0.0));
  bench.lighting.sky_radiosity =
      sky_radiosity(model->sky_radiance.value_or(Rgb(0.0)), model->sky_cells, model->sky_resolution);
  if (auto done = measure(bench, *scene); !done) return tl::unexpected(done.error());
  return std::move(bench.out);
}

}  // namespace relume::bench
