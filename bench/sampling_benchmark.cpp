// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "benchmarks.h"
#include "core/sky.h"
#include "precompute/hemisphere_rays.h"
#include "precompute/rows.h"
#include "precompute/surfaces.h"

namespace relume::bench {
namespace {

constexpr double kClusterSize = 0.5, kTexelSize = 0.1;
constexpr std::uint32_t kReceivers = 48, kSkyResolution = 8;
constexpr std::uint32_t kTruthRays = 1u << 17, kTruthSeed = 1000;
constexpr std::uint32_t kFewest = 64, kMost = 4096, kAt = 1024;
/// Sequences per receiver, whose squared errors are averaged.
constexpr std::uint32_t kSeeds = 8;

using Row = std::vector<double>;  ///< per sender

/// The scene in clusters of half a metre; emitters are surfaces like all others.
struct SamplingScene {
  RayCaster caster;
  Surfaces surfaces;
  Emitters none;
  SenderLookup lookup;
  RowScene rows;
  std::vector<Receiver> receivers;

  SamplingScene(RayCaster ray_caster, Surfaces cut)
      : caster(std::move(ray_caster)),
        surfaces(std::move(cut)),
        lookup(surfaces.geometry, surfaces.charts, surfaces.layouts, surfaces.systems, caster),
        rows{surfaces.geometry, caster, lookup, none, surfaces.cluster_count(), kSkyResolution, {}, 0} {
    rows.sky_senders.resize(6 * kSkyResolution * kSkyResolution);
    std::iota(rows.sky_senders.begin(), rows.sky_senders.end(), surfaces.cluster_count());
    for (std::size_t s = 0; s < surfaces.systems.size(); ++s) {
      const ClusteredSurface& system = surfaces.systems[s];
      const TracedSystem traced{surfaces.charts, system, surfaces.own_elements[s]};
      const auto elements = std::uint32_t(system.surface.elements.size());
      const std::uint32_t step = elements / kReceivers + 1;
      for (std::uint32_t e = step / 2; e < elements; e += step) {
        for (Receiver& receiver : receivers_of(rows, traced, {&e, 1})) receivers.push_back(receiver);
      }
    }
    RowTracer tracer(rows);
    const SobolPoints points(kFewest);
    std::erase_if(receivers, [&](const Receiver& receiver) {  // inside other geometry
      return tracer.trace(receiver, points, {0, kFewest}).back_face_share > kInvalidShare;
    });
  }
  SamplingScene(const SamplingScene&) = delete;
};

Row dense(const FormFactorRow& row, std::size_t senders) {
  Row values(senders, 0.0);
  for (std::size_t i = 0; i < row.senders.size(); ++i) values[row.senders[i]] = double(row.values[i]);
  return values;
}

/// Rays of directions and origins that know nothing of each other.
void fill_random(const SamplingScene& scene, const Receiver& receiver, std::uint64_t& state,
                 HemispherePacket& packet) {
  std::array<Lanes, 4> random;
  for (Lanes& lanes : random) {
    for (float& value : lanes) value = float(mix(++state) >> 40) * 0x1p-24f;
  }
  receiver.origins().sample(random[2], random[3], packet.origins);
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const Frame& frame = receiver.origins().patch(packet.origins.patch[lane]).frame;
    const glm::vec3 direction = frame.to_world(cosine_direction(random[0][lane], random[1][lane]));
    const glm::vec3 lift = scene.surfaces.geometry.offset * frame.normal;
    RayPacket& rays = packet.rays;
    rays.direction_x[lane] = direction.x, rays.direction_y[lane] = direction.y,
    rays.direction_z[lane] = direction.z;
    rays.origin_x[lane] = packet.origins.x[lane] + lift.x,
    rays.origin_y[lane] = packet.origins.y[lane] + lift.y;
    rays.origin_z[lane] = packet.origins.z[lane] + lift.z;
    packet.used[lane] = receiver.owns(scene.surfaces.geometry, scene.caster, packet.origins, lane);
    rays.near[lane] = 0.0f;
    rays.far[lane] = packet.used[lane] ? std::numeric_limits<float>::infinity() : -1.0f;
  }
}

std::uint32_t sender_seen(const SenderLookup& lookup, const RayPacket& rays, std::size_t lane,
                          const glm::vec3& direction) {
  const std::uint32_t element = lookup.seen(rays.triangle[lane], rays.u[lane], rays.v[lane], direction);
  return element < SenderLookup::kBlackBack ? lookup.sender_of(element) : kNone;
}

Row random_row(const SamplingScene& scene, const Receiver& receiver, std::uint32_t rays, std::uint64_t seed) {
  Row counts(sender_count(scene.rows), 0.0);
  std::uint64_t state = mix(receiver.key(), seed);
  double traced = 0.0;
  HemispherePacket packet;
  const SkyCells cells(kSkyResolution);
  for (std::uint32_t first = 0; first < rays; first += std::uint32_t(kLanes)) {
    fill_random(scene, receiver, state, packet);
    scene.caster.closest_hits(packet.rays, RaySpread::wide);
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      if (!packet.used[lane]) continue;
      traced += 1.0;
      const RayPacket& r = packet.rays;
      const glm::vec3 direction(r.direction_x[lane], r.direction_y[lane], r.direction_z[lane]);
      const std::uint32_t sender = r.triangle[lane] == kNoTriangle
                                       ? scene.rows.sky_senders[cells.of(glm::dvec3(direction))]
                                       : sender_seen(scene.lookup, r, lane, direction);
      if (sender < counts.size()) counts[sender] += 1.0;
    }
  }
  for (double& count : counts) count /= std::max(traced, 1.0);
  return counts;
}

Row our_row(SamplingScene& scene, const Receiver& receiver, const SobolPoints& points, std::uint64_t seed) {
  scene.rows.seed = seed;
  RowTracer tracer(scene.rows);
  return dense(tracer.trace(receiver, points, {0, points.count()}).row, sender_count(scene.rows));
}

double squared_distance(const Row& a, const Row& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Relative errors (L2 over the row, mean square over seeds) for kFewest, twice as many ... kMost rays.
struct RowErrors {
  std::vector<double> ours, random;
};

RowErrors errors_of(SamplingScene& scene, const Receiver& receiver, const SobolPoints& truth_points) {
  const Row truth = our_row(scene, receiver, truth_points, kTruthSeed);
  const double norm = squared_distance(truth, Row(truth.size(), 0.0));
  RowErrors errors;
  for (std::uint32_t rays = kFewest; rays <= kMost; rays *= 2) {
    const SobolPoints points(rays, rays);
    double ours = 0.0, random = 0.0;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      ours += squared_distance(our_row(scene, receiver, points, seed), truth);
      random += squared_distance(random_row(scene, receiver, rays, mix(rays, seed)), truth);
    }
    errors.ours.push_back(std::sqrt(ours / (kSeeds * norm)));
    errors.random.push_back(std::sqrt(random / (kSeeds * norm)));
  }
  return errors;
}

std::size_t index_of(std::uint32_t rays) {
  std::size_t index = 0;
  for (; rays > kFewest; rays /= 2) ++index;
  return index;
}

/// How many random rays make our error at kAt rays, over kAt: errors of random ones fall with the root of
/// their number.
double ray_ratio(const RowErrors& errors) {
  double log_constant = 0.0;
  for (std::size_t k = 0; k < errors.random.size(); ++k)
    log_constant += std::log(errors.random[k]) + 0.5 * std::log(double(kFewest << k));
  const double at_one = std::exp(log_constant / double(errors.random.size()));
  const double rays = std::pow(at_one / errors.ours[index_of(kAt)], 2.0);
  return rays / kAt;
}

struct RayRates {
  std::vector<double> ours, random;  ///< 1/s, on one thread
};

RayRates measure_rates(SamplingScene& scene, std::uint32_t repetitions) {
  RayRates rates;
  const SobolPoints points(kAt, kAt);
  const double rays = double(kAt) * double(scene.receivers.size());
  scene.rows.seed = 0;
  RowTracer tracer(scene.rows);
  for (std::uint32_t r = 0; r < repetitions; ++r) {
    rates.ours.push_back(rays / seconds_of([&] {
                           for (const Receiver& receiver : scene.receivers)
                             tracer.trace(receiver, points, {0, kAt});
                         }));
    rates.random.push_back(rays / seconds_of([&] {
                             for (const Receiver& receiver : scene.receivers)
                               random_row(scene, receiver, kAt, r);
                           }));
  }
  return rates;
}

/// Many random rays find the same row as many of ours.
Result<void> check_answers(SamplingScene& scene, const SobolPoints& truth_points) {
  const Receiver& receiver = scene.receivers.front();
  const Row ours = our_row(scene, receiver, truth_points, kTruthSeed);
  const Row random = random_row(scene, receiver, kTruthRays, 0);
  const double error =
      std::sqrt(squared_distance(ours, random) / squared_distance(ours, Row(ours.size(), 0.0)));
  // The variance of n random rays over cells of probability p sums to at most 1 / n.
  const double expected = 1.0 / std::sqrt(kTruthRays * squared_distance(ours, Row(ours.size(), 0.0)));
  if (error < 2.0 * expected) return {};
  return fail(ErrorCode::check_failed,
              fmt::format("expected rows of {} random rays within {} of ours, found {}", kTruthRays,
                          2.0 * expected, error));
}

}  // namespace

Measurements sampling(const BenchmarkOptions& options) {
  const auto input = benchmark_scene(options);
  if (!input) return tl::unexpected(input.error());
  PrecomputeOptions sizes;
  sizes.cluster_size = kClusterSize, sizes.texel_size = kTexelSize;
  const Geometry geometry = make_geometry(*input);
  auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  PrecomputeReport report;
  auto surfaces = cut_surfaces(*input, sizes, *caster, geometry, report);
  if (!surfaces) return tl::unexpected(surfaces.error());
  cluster_surfaces(*input, *caster, report, 0.0, {}, *surfaces);
  SamplingScene scene(std::move(*caster), std::move(*surfaces));
  const SobolPoints truth_points(kTruthRays, kTruthRays);
  if (auto ok = check_answers(scene, truth_points); !ok) return tl::unexpected(ok.error());

  std::vector<std::vector<double>> ours(index_of(kMost) + 1), random = ours;
  std::vector<double> ratios;
  for (const Receiver& receiver : scene.receivers) {
    const RowErrors errors = errors_of(scene, receiver, truth_points);
    for (std::size_t k = 0; k < ours.size(); ++k)
      ours[k].push_back(errors.ours[k]), random[k].push_back(errors.random[k]);
    ratios.push_back(ray_ratio(errors));
  }
  const RayRates rates = measure_rates(scene, options.repetitions);
  std::vector<double> seconds;
  for (const double ratio : ratios) seconds.push_back(ratio * median(rates.ours) / median(rates.random));
  std::vector<Measurement> result{{"receivers", "", {double(scene.receivers.size())}}};
  for (std::size_t k = 0; k < ours.size(); ++k) {
    result.push_back({fmt::format("row error, our {} rays", kFewest << k), "", ours[k]});
    result.push_back({fmt::format("row error, random {} rays", kFewest << k), "", random[k]});
  }
  result.push_back({"random rays for our error at 1024 / 1024", "", ratios});
  result.push_back({"our rays, one thread", "rays/s", rates.ours});
  result.push_back({"random rays, one thread", "rays/s", rates.random});
  result.push_back({"seconds of random rays / ours, equal row error", "", seconds});
  return result;
}

}  // namespace relume::bench
