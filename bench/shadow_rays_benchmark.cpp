// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "benchmarks.h"
#include "compute/standalone/light_session.h"
#include "core/light_patches.h"
#include "core/ray_offset.h"
#include "precompute/ray_caster.h"

namespace relume::bench {
namespace {

constexpr std::uint32_t kQuality = 8;  ///< rows do not matter here
constexpr std::size_t kMostRays = 1u << 20;

/// Lamps half a metre (or a twentieth of the scene) off surfaces, the same at each call.
std::vector<Light> lamps(const Model& model, std::size_t count, double range) {
  std::mt19937 random(5);
  double size = 0.0;
  for (const glm::vec3& p : model.occluders.positions) size = std::max(size, double(glm::length(p)));
  std::vector<Light> lights;
  while (lights.size() < count) {
    const System& system = model.systems[random() % model.systems.size()];
    const Cluster& cluster = system.clusters[random() % system.clusters.size()];
    Light light;
    light.intensity = Rgb(100.0);
    light.position =
        model.origin + glm::dvec3(cluster.centroid) + std::min(0.5, 0.05 * size) * glm::dvec3(cluster.normal);
    light.range = range;
    lights.push_back(light);
  }
  return lights;
}

/// From sample points to lamps in turn, points that face away left out.
std::vector<LightSegment> rays_to(const Model& model, const std::vector<Light>& lights) {
  const float offset = ray_offset(model.occluders.positions);
  std::vector<LightSegment> rays;
  std::size_t light = 0;
  for (const System& system : model.systems) {
    for (const SurfaceElement& element : system.elements) {
      const glm::dvec3 to = lights[light++ / 64 % lights.size()].position - model.origin;
      for (const LightPatch& patch : element_patches(model, system, element)) {
        const glm::vec3 from = glm::vec3(patch_point(patch)) + glm::vec3(patch.normal) * offset;
        const glm::dvec3 way = to - glm::dvec3(from);
        if (glm::dot(way, patch.normal) > 0.0 && rays.size() < kMostRays)
          rays.push_back({from, from + glm::vec3(way * (1.0 - 4.0 * double(offset) / glm::length(way)))});
      }
    }
  }
  return rays;
}

std::vector<float> one_by_one(const RayCaster& caster, const std::vector<LightSegment>& rays) {
  std::vector<float> shares(rays.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      shares[i] = caster.transmittance(rays[i].from, rays[i].to);
  });
  return shares;
}

/// Rays that meet something, by coin where triangles are not opaque.
std::size_t in_packets(const RayCaster& caster, const std::vector<LightSegment>& rays) {
  std::vector<std::size_t> hidden((rays.size() + kPacketSize - 1) / kPacketSize);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, hidden.size(), 128), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p) {
      RayPacket packet{};
      packet.far.fill(-1.0f);
      for (std::size_t lane = 0; lane < kPacketSize && p * kPacketSize + lane < rays.size(); ++lane) {
        const auto& [from, to] = rays[p * kPacketSize + lane];
        packet.origin_x[lane] = from.x, packet.origin_y[lane] = from.y, packet.origin_z[lane] = from.z;
        packet.direction_x[lane] = to.x - from.x, packet.direction_y[lane] = to.y - from.y;
        packet.direction_z[lane] = to.z - from.z;
        packet.far[lane] = 1.0f;
      }
      hidden[p] = std::size_t(std::popcount(caster.occluded(packet)));
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : hidden) sum += count;
  return sum;
}

/// How many differ: no more than a thousandth.
Result<std::size_t> check_answers(const std::vector<float>& found, const std::vector<float>& expected) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (std::abs(found[i] - expected[i]) > 1e-4f) ++differ;
  }
  if (differ * 1000 <= found.size()) return differ;
  return fail(ErrorCode::check_failed,
              fmt::format("{} of {} rays differ from Embree's", differ, found.size()));
}

struct ShadowBench {
  const Model& model;
  const RayCaster& caster;
  LightSession session;
  std::uint32_t repetitions;
  std::vector<Measurement> out{};

  void add(const std::string& name, const char* unit, std::vector<double> values) {
    out.push_back({name, unit, std::move(values)});
  }
};

/// The walk and Embree turn about.
Result<void> measure_rays(ShadowBench& bench) {
  const std::vector<LightSegment> rays = rays_to(bench.model, lamps(bench.model, 16, 0.0));
  if (rays.empty()) return fail(ErrorCode::check_failed, "no rays");
  std::vector<double> walk, single, packets, ratio;
  for (std::uint32_t r = 0; r <= bench.repetitions; ++r) {
    SubmitTimes times;
    const auto found = bench.session.trace(rays, &times);
    if (!found) return tl::unexpected(found.error());
    std::vector<float> expected;
    const double embree = seconds_of([&] { expected = one_by_one(bench.caster, rays); });
    const double embree8 = seconds_of([&] { in_packets(bench.caster, rays); });
    const auto differ = check_answers(*found, expected);
    if (!differ) return tl::unexpected(differ.error());
    if (r == 0) bench.add("rays that differ from Embree's", "rays", {double(*differ)});
    if (r == 0) continue;  // pipelines compile, caches fill
    const double mrays = 1e-6 * double(rays.size());
    walk.push_back(mrays / times.seconds);
    single.push_back(mrays / embree);
    packets.push_back(mrays / embree8);
    ratio.push_back(embree / times.seconds);
  }
  bench.add("rays", "rays", {double(rays.size())});
  bench.add("walk on the device", "Mray/s", walk);
  bench.add("Embree, one by one", "Mray/s", single);
  bench.add("Embree, packets of 8", "Mray/s", packets);
  bench.add("device over Embree, one by one", "x", ratio);
  return {};
}

/// All lights at once, then one of them moved; nothing where they reach more than any device can bind.
Result<void> measure_lights(ShadowBench& bench, std::size_t count, double range) {
  std::vector<Light> lights = lamps(bench.model, count, range);
  std::vector<double> all, moved, colour;
  std::uint64_t rays = 0, moved_rays = 0;
  const auto set = [&](std::vector<double>& seconds, std::uint64_t* traced) -> Result<void> {
    Result<LightTimes> done = LightTimes{};
    seconds.push_back(1e3 * seconds_of([&] { done = bench.session.set_lights(lights); }));
    if (!done) return tl::unexpected(done.error());
    if (traced != nullptr) *traced = done->rays;
    return {};
  };
  for (std::uint32_t r = 0; r < bench.repetitions; ++r) {
    bench.session.retrace();
    const auto traced = set(all, &rays);
    if (!traced && traced.error().code == ErrorCode::usage) return {};  // more pairs than the device can bind
    if (!traced) return traced;
    lights[0].position.x += 0.01;
    if (auto done = set(moved, &moved_rays); !done) return done;
    lights[0].intensity *= 1.01;
    if (auto done = set(colour, nullptr); !done) return done;
  }
  const std::string name =
      fmt::format("{} lights{}", count, range > 0.0 ? fmt::format(" of {:.2g} m", range) : "");
  bench.add(name, "ms", all);
  bench.add(name + ", rays", "rays", {double(rays)});
  bench.add(name + ", one moved", "ms", moved);
  bench.add(name + ", one moved, rays", "rays", {double(moved_rays)});
  bench.add(name + ", one changes colour", "ms", colour);
  return {};
}

/// What a dispatch takes at most: submissions of one dispatch, of lamps from far off a surface to nearly on
/// it, where few patches are cut often.
Result<void> measure_dispatches(StandaloneDevice& device, ShadowBench& bench) {
  LightSessionOptions options;
  options.max_submit_rays = options.light.max_dispatch_rays;
  auto session = LightSession::create(device, bench.model, options);
  if (!session) return tl::unexpected(session.error());
  const Light lamp = lamps(bench.model, 1, 0.0).front();
  const Cluster& cluster = bench.model.systems.front().clusters.front();
  for (const double off : {1.0, 0.1, 0.01, 0.001}) {
    Light light = lamp;
    light.position = bench.model.origin + glm::dvec3(cluster.centroid) + off * glm::dvec3(cluster.normal);
    std::vector<double> longest;
    for (std::uint32_t r = 0; r <= bench.repetitions; ++r) {
      session->retrace();
      const auto done = session->set_lights(std::span(&light, 1));
      if (!done) return tl::unexpected(done.error());
      if (r > 0) longest.push_back(1e3 * done->longest_gpu_seconds);  // before, pipelines compile
    }
    bench.add(fmt::format("longest dispatch, lamp {:g} m off a surface", off), "ms", longest);
  }
  return {};
}

Result<void> measure(ShadowBench& bench) {
  if (auto done = measure_rays(bench); !done) return done;
  double area = 0.0;
  for (const System& system : bench.model.systems) {
    for (const Cluster& cluster : system.clusters) area += cluster.area;
  }
  // 100 lights that reach a tenth of the surfaces, 10,000 that reach a thousandth.
  const double range = std::sqrt(area / (10.0 * kPi));
  if (auto done = measure_lights(bench, 1, 0.0); !done) return done;
  if (auto done = measure_lights(bench, 100, range); !done) return done;
  return measure_lights(bench, 10000, 0.1 * range);
}

}  // namespace

Measurements shadow_rays(const BenchmarkOptions& asked) {
  const auto scene = benchmark_scene(asked);
  if (!scene) return tl::unexpected(scene.error());
  BenchmarkOptions options = asked;
  options.quality = kQuality;
  PrecomputeReport report;
  const auto model = precompute(*scene, precompute_options(options, *scene), report);
  if (!model) return tl::unexpected(model.error());
  const Occluders& occluders = model->occluders;
  const auto caster = RayCaster::create(occluders.positions, occluders.triangles, occluders.opacity);
  if (!caster) return tl::unexpected(caster.error());
  auto device = StandaloneDevice::create({});
  if (!device) return tl::unexpected(device.error());
  LightSessionOptions light;
  light.light.max_pairs = 1u << 20;
  auto session = LightSession::create(*device, *model, light);
  if (!session) return tl::unexpected(session.error());
  ShadowBench bench{*model, *caster, std::move(*session), options.repetitions};
  bench.add("triangles", "", {double(occluders.triangles.size())});
  if (auto done = measure_dispatches(*device, bench); !done) return tl::unexpected(done.error());
  if (auto done = measure(bench); !done) return tl::unexpected(done.error());
  return std::move(bench.out);
}

}  // namespace relume::bench
