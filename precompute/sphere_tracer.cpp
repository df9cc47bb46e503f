// SPDX-License-Identifier: MIT
#include "precompute/sphere_tracer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include "core/quantities.h"
#include "core/sky.h"
#include "precompute/packet_lanes.h"

namespace relume {
namespace {

/// Directions whose mean is shorter are told in parts: they reach about 20 degrees around it.
constexpr float kShortestMean = 0.97f;
/// Parts are cells of the sphere (core/sky.h) of about so many degrees.
constexpr std::uint32_t kPartResolution = 4;

/// Tells rays over the sphere from those over a hemisphere.
constexpr std::uint64_t kSphere = 0x737068657265;

/// Upper estimate of the solid angle of an emitter: its cosine as large as its size allows.
double largest_solid_angle(const Emitter& emitter, const glm::vec3& position) {
  const glm::vec3 to = emitter.centroid - position;
  const float distance = std::max(glm::length(to), 1e-12f);
  const float slack = std::min(1.0f, emitter.radius / distance);
  const float bend = 1.0f - std::min(1.0f, glm::length(emitter.normal));
  const float cosine = std::clamp(-glm::dot(to / distance, emitter.normal) + slack + bend, 0.0f, 1.0f);
  return std::min(2.0 * kPi, emitter.area * cosine / (double(distance) * distance));
}

double sum_of(const std::vector<SeenSender>& samples) {
  double sum = 0.0;
  for (const SeenSender& sample : samples) sum += double(sample.solid_angle);
  return sum;
}

/// The mean of [first, last), all of one sender.
SeenSender mean_of(std::span<const SeenSender> samples) {
  double solid_angle = 0.0;
  glm::dvec3 moment(0.0);
  for (const SeenSender& sample : samples) {
    solid_angle += double(sample.solid_angle);
    moment += double(sample.solid_angle) * glm::dvec3(sample.direction);
  }
  return {samples.front().sender, float(solid_angle), glm::vec3(moment / std::max(solid_angle, 1e-300))};
}

/// Calls with each run of samples of which `of` gives the same, after sorting them by it.
template <class Key, class Use>
void for_each_run(std::span<SeenSender> samples, const Key& of, const Use& use) {
  std::stable_sort(samples.begin(), samples.end(),
                   [&](const SeenSender& a, const SeenSender& b) { return of(a) < of(b); });
  for (std::size_t first = 0, last = 0; first < samples.size(); first = last) {
    while (last < samples.size() && of(samples[last]) == of(samples[first])) ++last;
    use(samples.subspan(first, last - first));
  }
}

}  // namespace

std::vector<SeenSender> unite_senders(std::vector<SeenSender> samples) {
  std::vector<SeenSender> result;
  const auto add = [&](std::span<const SeenSender> run) {
    const SeenSender seen = mean_of(run);
    if (seen.solid_angle > 0.0f) result.push_back(seen);
  };
  const auto sender = [](const SeenSender& sample) { return sample.sender; };
  const SkyCells parts(kPartResolution);
  const auto part = [&](const SeenSender& sample) { return parts.of(glm::dvec3(sample.direction)); };
  for_each_run(samples, sender, [&](std::span<SeenSender> run) {
    if (glm::length(mean_of(run).direction) >= kShortestMean) {
      add(run);
    } else {
      for_each_run(run, part, add);
    }
  });
  return result;
}

SphereTracer::SphereTracer(const RowScene& scene)
    : scene_(scene),
      sight_(scene.geometry, scene.caster, scene.lookup, scene.emitters, scene.memory),
      emitter_points_(scene.emitters.list.empty() ? 0 : kMaxAreaSamples) {}

ProbeRow SphereTracer::trace(const glm::vec3& position, const SobolPoints& points) {
  const Receiver receiver = Receiver::point({position, glm::vec3(0.0f)});
  const std::uint64_t key = mix(receiver.key(), scene_.seed);
  counted_.clear(), emitted_.clear();
  area_samples_ = std::min(kMaxAreaSamples, points.count() / kRaysPerAreaSample);
  density_by_ray_ = points.count() / (4.0 * kPi);
  choose_emitters(position);
  if (scene_.memory != nullptr) {
    const std::uint32_t samples = choice_.any() ? area_samples_ + kPacketSize : 0;
    sight_.begin(mix(receiver.identity(), kSphere), receiver, points.count(), samples);
  }
  const Totals totals = trace_rays(position, points, key);
  if (choice_.any()) sample_emitters(position, mix(key, 1));
  if (scene_.memory != nullptr) sight_.end();
  rays_ += points.count();
  close(totals.arrived / density_by_ray_);
  counted_.insert(counted_.end(), emitted_.begin(), emitted_.end());
  return {unite_senders(counted_), float(totals.back_faces) / float(points.count())};
}

void SphereTracer::choose_emitters(const glm::vec3& position) {
  choice_.probability.clear(), choice_.cumulative.clear();
  double sum = 0.0;
  for (const Emitter& emitter : scene_.emitters.list) {
    choice_.probability.push_back(largest_solid_angle(emitter, position));
    sum += choice_.probability.back();
  }
  double below = 0.0;
  for (double& probability : choice_.probability) {
    probability = sum > 0.0 ? probability / sum : 0.0;
    choice_.cumulative.push_back(below += probability);
  }
}

SphereTracer::Totals SphereTracer::trace_rays(const glm::vec3& position, const SobolPoints& points,
                                              std::uint64_t key) {
  Totals totals;
  PacketSight seen;
  for (std::uint32_t first = 0; first < points.count(); first += kPacketSize) {
    SampleLanes samples;
    points.scrambled(first, key, samples);
    RayPacket packet;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const glm::vec3 direction = sphere_direction(samples.coordinate[0][lane], samples.coordinate[1][lane]);
      set_ray(packet, lane, position, direction, std::numeric_limits<float>::infinity());
    }
    sight_.see(points.numbers(first), kAllLanes, packet, seen, [](std::uint32_t lanes) { return lanes; });
    for (std::size_t lane = 0; lane < kLanes; ++lane) add_hit(packet, seen, lane, totals);
  }
  return totals;
}

void SphereTracer::add_hit(const RayPacket& packet, const PacketSight& seen, std::size_t lane,
                           Totals& totals) {
  const std::uint32_t place = seen.place[lane];
  if (place == SenderLookup::kBlackBack) ++totals.back_faces;
  if (place >= SenderLookup::kBlackBack) return;
  const glm::vec3 direction = direction_of(packet, lane);
  const double whole = 1.0 / density_by_ray_;
  if (sees_sky(place)) {
    ++totals.arrived;
    counted_.push_back({scene_.sky_senders[place - kSky], float(whole), direction});
    return;
  }
  ++totals.arrived;
  const std::uint32_t sender = seen.sender[lane], emitter = scene_.emitters.of(sender);
  if (emitter == kNone || !(choice_.probability[emitter] > 0.0)) {
    counted_.push_back({sender, float(whole), direction});
    return;
  }
  const double by_area =
      density_by_area(emitter, double(seen.distance[lane]) * seen.distance[lane], double(seen.cosine[lane]));
  emitted_.push_back({sender, float(whole * power_heuristic(density_by_ray_, by_area)), direction});
}

double SphereTracer::density_by_area(std::uint32_t emitter, double squared_distance, double cosine) const {
  return area_samples_ * choice_.probability[emitter] * squared_distance /
         (scene_.emitters.list[emitter].area * std::max(cosine, 1e-9));
}

void SphereTracer::sample_emitters(const glm::vec3& position, std::uint64_t key) {
  for (std::uint32_t first = 0; first < area_samples_; first += kPacketSize)
    add_connections(position, first, key);
}

void SphereTracer::add_connections(const glm::vec3& position, std::uint32_t first, std::uint64_t key) {
  SampleLanes samples;
  emitter_points_.scrambled(first, key, samples);
  RayPacket packet;
  std::array<SeenSender, kLanes> drawn;
  std::uint32_t useful = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    float u = samples.coordinate[0][lane];
    const auto chosen = std::uint32_t(choice_.choose(u));
    const Emitter& emitter = scene_.emitters.list[chosen];
    const SurfacePoint target = emitter.points.sample(u, samples.coordinate[1][lane]);
    const glm::vec3 way = target.position + scene_.geometry.offset * target.normal - position;
    const double squared = glm::dot(way, way), distance = std::sqrt(squared);
    const double cosine = -glm::dot(way, target.normal) / std::max(distance, 1e-30);
    const bool sampled = first + lane < area_samples_ && squared > 0.0 && cosine > 0.0;
    set_ray(packet, lane, position, way, sampled ? 1.0f : -1.0f);
    if (!sampled) continue;
    useful |= 1u << lane;
    const double by_area = density_by_area(chosen, squared, cosine);
    drawn[lane] = {emitter.cluster, float(power_heuristic(by_area, density_by_ray_) / by_area),
                   way / float(distance)};
    ++occlusion_rays_;
  }
  const SeenSamples seen =
      sight_.see_emitters(first, useful, useful, packet, [](std::uint32_t lanes) { return lanes; });
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if ((seen.visible >> lane & 1u) != 0) emitted_.push_back(drawn[lane]);
  }
}

void SphereTracer::close(double solid_angle) {
  const RowScales scales = close_row(sum_of(emitted_), sum_of(counted_), solid_angle);
  for (SeenSender& sample : emitted_) sample.solid_angle *= float(scales.emitted);
  for (SeenSender& sample : counted_) sample.solid_angle *= float(scales.counted);
}

}  // namespace relume
