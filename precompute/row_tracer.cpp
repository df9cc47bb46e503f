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
constexpr std::uint32_t kRaysPerAreaSample = 8;
constexpr std::uint32_t kMaxAreaSamples = 4096;

glm::vec3 direction_of(const RayPacket& packet, int lane) {
  return {packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]};
}

}  // namespace

RowTracer::RowTracer(const RowScene& scene)
    : scene_(scene),
      emitter_points_(scene.emitters.list.empty() ? 0 : kMaxAreaSamples),
      counts_(scene.cluster_count + 6 * scene.sky_resolution * scene.sky_resolution, 0),
      touched_(counts_.size()),
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
      if (packet.used[lane])
        count_hit(packet.rays, lane, packet.normal(receiver, lane), points.count(), totals);
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
    sender = scene_.lookup.seen(triangle, packet.u[lane], packet.v[lane], direction);
    if (sender == SenderLookup::kBlackBack) ++totals.back_faces;
    if (sender >= SenderLookup::kBlackBack) return;
    const std::uint32_t emitter = scene_.emitters.list.empty() ? kNone : scene_.emitters.of_cluster[sender];
    if (emitter != kNone && allotted_[emitter] > 0) {
      ++totals.arrived;
      ++totals.arrived_at_emitters;
      add_emitter_hit(emitter, packet, lane, normal, ray_count);
      return;
    }
  }
  ++totals.arrived;
  ++counts_[sender];
  touched_.insert(sender);
}

void RowTracer::add_emitter_hit(std::uint32_t emitter, const RayPacket& packet, int lane,
                                const glm::vec3& normal, std::uint32_t ray_count) {
  const glm::vec3 direction = direction_of(packet, lane);
  const double cos_receiver = std::max(0.0f, glm::dot(direction, normal));
  const double cos_emitter = std::abs(glm::dot(direction, scene_.geometry.normals[packet.triangle[lane]]));
  const double weight = ray_weight({ray_count, allotted_[emitter]}, scene_.emitters.list[emitter].area,
                                   cos_receiver, cos_emitter, packet.far[lane]);
  emitter_sums_[emitter] += weight / ray_count;
}

void RowTracer::sample_emitters(const Receiver& receiver, std::uint32_t ray_count, std::uint32_t traced,
                                std::uint64_t key) {
  // Hits were booked as one of ray_count each; fewer may have started, where walls cut into the receiver.
  const double started = traced > 0 ? double(ray_count) / traced : 0.0;
  for (std::size_t i = 0; i < allotted_.size(); ++i) {
    emitter_sums_[i] *= started;
    if (allotted_[i] > 0) {
      const Emitter& emitter = scene_.emitters.list[i];
      emitter_sums_[i] +=
          mean_area_sample(receiver, emitter, {ray_count, allotted_[i]}, mix(key, emitter.key));
    }
  }
}

double RowTracer::mean_area_sample(const Receiver& receiver, const Emitter& emitter,
                                   const SampleCounts& counts, std::uint64_t key) {
  double sum = 0.0;
  std::uint32_t owned = 0;
  for (std::uint32_t first = 0; first < counts.area; first += kPacketSize) {
    ConnectionPacket packet;
    fill_connections(receiver, emitter, counts, emitter_points_, key, first, scene_.geometry.offset, packet);
    std::array<bool, kPacketSize> own;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      own[lane] =
          first + lane < counts.area && receiver.owns(scene_.geometry, scene_.caster, packet.origins, lane);
      if (!own[lane]) packet.rays.far[lane] = -1.0f;
      occlusion_rays_ += packet.rays.far[lane] > 0.0f ? 1 : 0;
    }
    const std::uint32_t hidden = scene_.caster.occluded(packet.rays);
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      if (!own[lane]) continue;
      ++owned;
      if ((hidden >> lane & 1u) == 0) sum += packet.form_factor[lane];
    }
  }
  return owned > 0 ? sum / owned : 0.0;
}

FormFactorRow RowTracer::finish_row(const Totals& totals) {
  FormFactorRow row;
  const double row_sum = totals.traced > 0 ? double(totals.arrived) / totals.traced : 0.0;
  double emitted = 0.0;
  for (std::size_t e = 0; e < allotted_.size(); ++e) {
    emitted += emitter_sums_[e];
    if (emitter_sums_[e] > 0.0) touched_.insert(scene_.emitters.list[e].cluster);
  }
  const std::uint32_t counted = totals.arrived - totals.arrived_at_emitters;
  const double emitter_scale = emitted > row_sum ? row_sum / emitted : 1.0;
  const double rest_scale =
      counted > 0 ? std::max(0.0, row_sum - emitted * emitter_scale) / double(counted) : 0.0;
  touched_.drain([&](std::uint32_t sender) {
    double value = counts_[sender] * rest_scale;
    const std::uint32_t emitter = sender < scene_.cluster_count && !scene_.emitters.list.empty()
                                      ? scene_.emitters.of_cluster[sender]
                                      : kNone;
    if (emitter != kNone) value += emitter_sums_[emitter] * emitter_scale;
    row.senders.push_back(sender);
    row.values.push_back(float(value));
    counts_[sender] = 0;
  });
  std::fill(emitter_sums_.begin(), emitter_sums_.end(), 0.0);
  return row;
}

}  // namespace relume
