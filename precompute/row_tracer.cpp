// SPDX-License-Identifier: MIT
#include "precompute/row_tracer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/quantities.h"
#include "core/sky.h"
#include "precompute/hemisphere_rays.h"

namespace relume {
namespace {

/// Area samples of emitters for each ray of a row.
constexpr std::uint32_t kRaysPerAreaSample = 4;
constexpr std::uint32_t kMaxAreaSamples = 4096;

glm::vec3 direction_of(const RayPacket& packet, int lane) {
  return {packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]};
}

/// Of a sample that one technique draws with `own` density and the other with `other`: the power heuristic of
/// exponent 2. The balance heuristic would leave a small lamp's few hits by rays a share, and all of their
/// noise.
double weight(double own, double other) {
  return own * own / (own * own + other * other);
}

}  // namespace

RowTracer::RowTracer(const RowScene& scene)
    : scene_(scene),
      emitter_points_(scene.emitters.list.empty() ? 0 : kMaxAreaSamples),
      counts_(scene.cluster_count + 6 * scene.sky_resolution * scene.sky_resolution, 0),
      emitter_sums_(scene.emitters.list.size(), 0.0) {}

TracedRow RowTracer::trace(const Receiver& receiver, const SobolPoints& points) {
  const std::uint64_t key = mix(receiver.key(), scene_.seed);
  const auto total = std::min(kMaxAreaSamples, points.count() / kRaysPerAreaSample);
  allotted_ = allot_samples(scene_.emitters, receiver, total);
  const Totals totals = trace_hemisphere(receiver, points, key);
  sample_emitters(receiver, points.count(), totals.traced, key);
  rays_ += totals.traced;
  TracedRow result;
  result.back_face_share = totals.traced > 0 ? float(totals.back_faces) / float(totals.traced) : 1.0f;
  result.row = finish_row(totals);
  return result;
}

RowTracer::Totals RowTracer::trace_hemisphere(const Receiver& receiver, const SobolPoints& points,
                                              std::uint64_t key) {
  Totals totals;
  HemispherePacket packet;
  for (std::uint32_t first = 0; first < points.count(); first += kPacketSize) {
    fill_packet(scene_.geometry, scene_.caster, receiver, points, key, first, packet);
    scene_.caster.closest_hits(packet.rays);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (packet.used[lane]) count_hit(packet.rays, lane, packet.normals[lane], points.count(), totals);
    }
  }
  return totals;
}

void RowTracer::count_hit(const RayPacket& packet, int lane, const glm::vec3& normal, std::uint32_t ray_count,
                          Totals& totals) {
  ++totals.traced;
  const std::uint32_t triangle = packet.triangle[lane];
  const glm::vec3 direction = direction_of(packet, lane);
  std::uint32_t sender = 0;
  if (triangle == kNoTriangle) {
    sender = scene_.cluster_count + sky_cell(glm::dvec3(direction), scene_.sky_resolution);
  } else {
    const auto seen =
        seen_surface(scene_.geometry, {triangle, packet.u[lane], packet.v[lane], Side::front}, direction);
    if (!seen) {
      ++totals.back_faces;
      return;
    }
    sender = scene_.lookup.sender(*seen);
    if (sender == kNone) return;
    const std::uint32_t emitter = scene_.emitters.list.empty() ? kNone : scene_.emitters.of_cluster[sender];
    if (emitter != kNone && allotted_[emitter] > 0) {
      ++totals.arrived;
      add_emitter_hit(emitter, packet, lane, normal, ray_count);
      return;
    }
  }
  ++totals.arrived;
  if (counts_[sender]++ == 0) touched_.push_back(sender);
}

void RowTracer::add_emitter_hit(std::uint32_t emitter, const RayPacket& packet, int lane,
                                const glm::vec3& normal, std::uint32_t ray_count) {
  const Emitter& e = scene_.emitters.list[emitter];
  const glm::vec3 direction = direction_of(packet, lane);
  const double cos_receiver = std::max(0.0f, glm::dot(direction, normal));
  const double cos_emitter = std::abs(glm::dot(direction, scene_.geometry.normals[packet.triangle[lane]]));
  const double distance = packet.far[lane];
  const double by_ray = ray_count * cos_receiver / kPi;
  const double by_area = allotted_[emitter] * distance * distance / (e.area * std::max(cos_emitter, 1e-9));
  emitter_sums_[emitter] += weight(by_ray, by_area) / ray_count;
}

void RowTracer::sample_emitters(const Receiver& receiver, std::uint32_t ray_count, std::uint32_t traced,
                                std::uint64_t key) {
  // Hits were booked as one of ray_count each; fewer may have started, where walls cut into the receiver.
  const double started = traced > 0 ? double(ray_count) / traced : 0.0;
  for (std::size_t i = 0; i < allotted_.size(); ++i) {
    const Emitter& emitter = scene_.emitters.list[i];
    const std::uint64_t own_key = mix(key, Receiver::point({emitter.centroid, emitter.normal}).key());
    double sum = 0.0;
    std::uint32_t owned = 0;
    for (std::uint32_t s = 0; s < allotted_[i]; ++s) {
      const SamplePoint p = emitter_points_.scrambled(s, own_key);
      const SurfacePoint origin = receiver.sample(scene_.geometry, p[2], p[3]);
      if (!receiver.owns(scene_.geometry, scene_.caster, origin)) continue;
      ++owned;
      sum +=
          area_sample(emitter, allotted_[i], ray_count, origin, emitter.sample(scene_.geometry, p[0], p[1]));
    }
    emitter_sums_[i] *= started;
    if (owned > 0) emitter_sums_[i] += sum / owned;
  }
}

double RowTracer::area_sample(const Emitter& emitter, std::uint32_t samples, std::uint32_t ray_count,
                              const SurfacePoint& origin, const SurfacePoint& target) {
  const glm::vec3 from = origin.position + origin.normal * scene_.geometry.offset;
  const glm::vec3 to = target.position + target.normal * scene_.geometry.offset;
  const glm::dvec3 way = glm::dvec3(to) - glm::dvec3(from);
  const double squared = glm::dot(way, way);
  if (!(squared > 0.0)) return 0.0;
  const double distance = std::sqrt(squared);
  const double cos_receiver = glm::dot(way, glm::dvec3(origin.normal)) / distance;
  const double cos_emitter = -glm::dot(way, glm::dvec3(target.normal)) / distance;
  if (cos_receiver <= 0.0 || cos_emitter <= 0.0) return 0.0;
  ++occlusion_rays_;
  if (scene_.caster.occluded(from, to)) return 0.0;
  const double by_ray = ray_count * cos_receiver / kPi;
  const double by_area = samples * squared / (emitter.area * cos_emitter);
  return cos_receiver * cos_emitter * emitter.area / (kPi * squared) * weight(by_area, by_ray);
}

FormFactorRow RowTracer::finish_row(const Totals& totals) {
  FormFactorRow row;
  const double row_sum = totals.traced > 0 ? double(totals.arrived) / totals.traced : 0.0;
  double emitted = 0.0;
  for (std::size_t e = 0; e < allotted_.size(); ++e) emitted += emitter_sums_[e];
  std::uint64_t counted = 0;
  for (const auto sender : touched_) counted += counts_[sender];
  const double emitter_scale = emitted > row_sum ? row_sum / emitted : 1.0;
  const double rest_scale =
      counted > 0 ? std::max(0.0, row_sum - emitted * emitter_scale) / double(counted) : 0.0;
  for (std::size_t e = 0; e < allotted_.size(); ++e) {
    if (emitter_sums_[e] > 0.0) touched_.push_back(scene_.emitters.list[e].cluster);
  }
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  for (const auto sender : touched_) {
    double value = counts_[sender] * rest_scale;
    const std::uint32_t emitter = sender < scene_.cluster_count && !scene_.emitters.list.empty()
                                      ? scene_.emitters.of_cluster[sender]
                                      : kNone;
    if (emitter != kNone) value += emitter_sums_[emitter] * emitter_scale;
    row.senders.push_back(sender);
    row.values.push_back(float(value));
    counts_[sender] = 0;
  }
  touched_.clear();
  std::fill(emitter_sums_.begin(), emitter_sums_.end(), 0.0);
  return row;
}

}  // namespace relume
