// SPDX-License-Identifier: MIT
#include "precompute/row_tracer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "core/quantities.h"
#include "precompute/packet_lanes.h"
#include "precompute/ray_recall.h"

namespace relume {
namespace {

/// Where in their sequence the area samples begin that go with the rays of `range`.
std::uint32_t first_sample(const PointRange& range, std::uint32_t samples) {
  return std::min(range.first / kRaysPerAreaSample, kMaxAreaSamples - samples) / kPacketSize * kPacketSize;
}

/// Those of `lanes` whose origins belong to the receiver.
std::uint32_t owned_lanes(const RowScene& scene, const Receiver& receiver, const PointLanes& origins,
                          std::uint32_t lanes) {
  if (!receiver.walled()) return lanes;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    if ((lanes >> lane & 1u) != 0 && !receiver.owns(scene.geometry, scene.caster, origins, lane))
      lanes &= ~(1u << lane);
  }
  return lanes;
}

/// Whether all lanes see elements, none of them of possible emitters.
bool sees_elements_only(const PacketSight& seen) {
  bool elements = seen.emitters == 0;
  for (const std::uint32_t place : seen.place) elements &= sees_element(place);
  return elements;
}

/// Calls with so many points that they fill a packet, the last ones with fewer.
template <class Use>
void for_each_packet(std::span<const std::uint32_t> points, Use&& use) {
  for (; !points.empty(); points = points.subspan(std::min<std::size_t>(kPacketSize, points.size())))
    use(points.first(std::min<std::size_t>(kPacketSize, points.size())));
}

}  // namespace

std::size_t sender_count(const RowScene& scene) {
  return scene.cluster_count + scene.sky_senders.size();
}

RowTracer::RowTracer(const RowScene& scene)
    : scene_(scene),
      sight_(scene.geometry, scene.caster, scene.lookup, scene.emitters, scene.memory),
      emitter_points_(scene.emitters.list.empty() ? 0 : kMaxAreaSamples),
      tally_(sender_count(scene) + kSeenBeyond),
      emitter_sums_(scene.emitters.list.size(), 0.0),
      area_sums_(scene.emitters.list.size(), 0.0) {
  if (!scene.directional) return;
  direction_sums_.assign(sender_count(scene), glm::dvec3(0.0));
  emitter_moments_.assign(emitter_sums_.size(), glm::dvec3(0.0));
  area_moments_ = emitter_moments_;
}

void RowTracer::expect(std::span<const Receiver> receivers) {
  if (scene_.memory == nullptr) return;
  expected_.clear();
  for (const Receiver& receiver : receivers) expected_.push_back(receiver.identity());
  if (scene_.memory->record) scene_.memory->record->fetch(expected_);
  if (scene_.memory->kept != nullptr) scene_.memory->kept->fetch(expected_);
}

TracedRow RowTracer::trace(const Receiver& receiver, const SobolPoints& points, const PointRange& range) {
  const std::uint64_t key = mix(receiver.key(), scene_.seed);
  area_samples_ = std::min(kMaxAreaSamples, range.count / kRaysPerAreaSample);
  choose_emitters(scene_.emitters, receiver, choice_);
  if (scene_.memory != nullptr) {
    const std::uint32_t samples =
        choice_.any() ? first_sample(range, area_samples_) + area_samples_ + kPacketSize : 0;
    sight_.begin(receiver.identity(), receiver, range.first + range.count, samples);
  }
  const Totals totals = trace_hemisphere(receiver, points, range, key);
  sample_emitters(receiver, range, totals.traced, key);
  if (scene_.memory != nullptr) sight_.end();
  rays_ += totals.traced;
  TracedRow result;
  result.back_face_share = totals.traced > 0 ? float(totals.back_faces) / float(totals.traced) : 1.0f;
  result.row = finish_row(totals);
  return result;
}

RowTracer::Totals RowTracer::trace_hemisphere(const Receiver& receiver, const SobolPoints& points,
                                              const PointRange& range, std::uint64_t key) {
  Totals totals;
  tally_.open.clear();
  if (scene_.memory != nullptr && !scene_.directional) {
    count_known(receiver, points, range, key, totals);
  } else {
    for (std::uint32_t p = range.first; p < std::min(range.first + range.count, points.count()); ++p)
      tally_.open.push_back(p);
  }
  HemispherePacket packet;
  PacketSight seen;
  for_each_packet(tally_.open, [&](std::span<const std::uint32_t> some) {
    make_packet(scene_.geometry, receiver, points, key, some, packet);
    sight_.see(packet.numbers, packet.used_lanes(), packet.rays, seen,
               [&](std::uint32_t lanes) { return owned_lanes(scene_, receiver, packet.origins, lanes); });
    if (!scene_.directional && sees_elements_only(seen)) {
      totals.traced += kLanes, totals.arrived += kLanes;
      for (const std::uint32_t sender : seen.sender) tally_.count(sender);
      return;
    }
    for (int lane = 0; lane < kPacketSize; ++lane)
      count_hit(receiver, packet, seen, lane, range.count, totals);
  });
  return totals;
}

void RowTracer::count_known(const Receiver& receiver, const SobolPoints& points, const PointRange& range,
                            std::uint64_t key, Totals& totals) {
  const auto senders = std::uint32_t(sender_count(scene_));
  const auto numbers = points.numbers(range.first, range.count);
  sight_.know(numbers, range.first, tally_);
  if (!tally_.doubtful.empty()) settle_doubts(receiver, points, key);
  const auto take = [&](SeenBeyond beyond) { return std::exchange(tally_.counts[senders + beyond], 0u); };
  totals.traced = std::uint32_t(numbers.size() - tally_.open.size()) - take(kIsNoRay);
  totals.back_faces = take(kSeesBack);
  totals.arrived = totals.traced - totals.back_faces - take(kSeesNothing);
}

void RowTracer::settle_doubts(const Receiver& receiver, const SobolPoints& points, std::uint64_t key) {
  HemispherePacket packet;
  std::size_t next = 0;
  for_each_packet(tally_.doubtful, [&](std::span<const std::uint32_t> some) {
    make_packet(scene_.geometry, receiver, points, key, some, packet);
    const std::uint32_t certain = sight_.confirm(packet.numbers, packet.used_lanes(), packet.rays);
    for (std::size_t lane = 0; lane < some.size(); ++lane, ++next) {
      if ((certain >> lane & 1u) != 0) {
        tally_.count(tally_.doubts[next]);
      } else {
        tally_.open.push_back(some[lane]);
      }
    }
  });
  tally_.doubtful.clear(), tally_.doubts.clear();
}

/// The sender that is seen, whose ray is counted; kNone where none is.
inline std::uint32_t RowTracer::count_arrival(std::uint32_t place, std::uint32_t sender, Totals& totals) {
  if (place == kNoRay) return kNone;
  ++totals.traced;
  if (place == SenderLookup::kBlackBack) ++totals.back_faces;
  if (place >= SenderLookup::kBlackBack) return kNone;
  ++totals.arrived;
  return sees_sky(place) ? scene_.sky_senders[place - kSky] : sender;
}

inline std::uint32_t RowTracer::count_place(std::uint32_t place, std::uint32_t sender, Totals& totals) {
  const std::uint32_t seen = count_arrival(place, sender, totals);
  if (seen == kNone) return kNone;
  tally_.count(seen);
  return seen;
}

inline void RowTracer::count_hit(const Receiver& receiver, const HemispherePacket& packet,
                                 const PacketSight& seen, int lane, std::uint32_t ray_count, Totals& totals) {
  const std::uint32_t place = seen.place[std::size_t(lane)], sender = seen.sender[std::size_t(lane)];
  if ((seen.emitters >> lane & 1u) != 0) {
    const std::uint32_t emitter = scene_.emitters.of(sender);
    if (choice_.probability[emitter] > 0.0) {
      count_arrival(place, sender, totals);
      ++totals.arrived_at_emitters;
      add_emitter_hit(emitter, packet.rays, seen, lane, packet.normal(receiver, lane), ray_count);
      return;
    }
  }
  const std::uint32_t counted = count_place(place, sender, totals);
  if (scene_.directional && counted != kNone)
    direction_sums_[counted] += glm::dvec3(direction_of(packet.rays, lane));
}

void RowTracer::add_emitter_hit(std::uint32_t emitter, const RayPacket& packet, const PacketSight& seen,
                                int lane, const glm::vec3& normal, std::uint32_t ray_count) {
  const glm::vec3 direction = direction_of(packet, lane);
  const double cos_receiver = std::max(0.0f, glm::dot(direction, normal));
  const double cos_emitter = seen.cosine[std::size_t(lane)];
  const SampleCounts counts{double(ray_count), area_samples_ * choice_.probability[emitter]};
  const double weight = ray_weight(counts, scene_.emitters.list[emitter].area, cos_receiver, cos_emitter,
                                   seen.distance[std::size_t(lane)]);
  emitter_sums_[emitter] += weight / ray_count;
  if (scene_.directional) emitter_moments_[emitter] += weight / ray_count * glm::dvec3(direction);
}

void RowTracer::sample_emitters(const Receiver& receiver, const PointRange& range, std::uint32_t traced,
                                std::uint64_t key) {
  // Hits were booked as one of range.count each; fewer may have started, where walls cut into the receiver.
  const double started = traced > 0 ? double(range.count) / traced : 0.0;
  for (double& sum : emitter_sums_) sum *= started;
  for (glm::dvec3& moment : emitter_moments_) moment *= started;
  if (!choice_.any()) return;
  const std::uint32_t start = first_sample(range, area_samples_);
  const Connections connections{receiver,      scene_.emitters,       choice_, range.count, start,
                                area_samples_, scene_.geometry.offset};
  std::fill(area_sums_.begin(), area_sums_.end(), 0.0);
  std::fill(area_moments_.begin(), area_moments_.end(), glm::dvec3(0.0));
  std::uint32_t owned = 0;
  for (std::uint32_t first = 0; first < area_samples_; first += kPacketSize) {
    ConnectionPacket packet;
    fill_connections(connections, emitter_points_, mix(key, 1), first, packet);
    owned += add_connections(receiver, start, first, packet);
  }
  for (std::size_t i = 0; i < area_sums_.size() && owned > 0; ++i) emitter_sums_[i] += area_sums_[i] / owned;
  for (std::size_t i = 0; i < area_moments_.size() && owned > 0; ++i)
    emitter_moments_[i] += area_moments_[i] / double(owned);
}

std::uint32_t RowTracer::add_connections(const Receiver& receiver, std::uint32_t start, std::uint32_t first,
                                         ConnectionPacket& packet) {
  std::uint32_t asked = 0, useful = 0;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    if (first + lane < area_samples_) asked |= 1u << lane;
    if (packet.rays.far[lane] > 0.0f) useful |= 1u << lane;
  }
  const SeenSamples seen = sight_.see_emitters(
      start + first, asked, useful, packet.rays,
      [&](std::uint32_t lanes) { return owned_lanes(scene_, receiver, packet.origins, lanes); });
  occlusion_rays_ += std::uint64_t(std::popcount(seen.owned & useful));
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    if ((seen.visible >> lane & 1u) == 0) continue;
    area_sums_[packet.emitter[lane]] += packet.form_factor[lane];
    if (!scene_.directional) continue;
    const glm::dvec3 way(direction_of(packet.rays, int(lane)));
    area_moments_[packet.emitter[lane]] += packet.form_factor[lane] * glm::normalize(way);
  }
  return std::uint32_t(std::popcount(seen.owned));
}

FormFactorRow RowTracer::finish_row(const Totals& totals) {
  FormFactorRow row;
  const double row_sum = totals.traced > 0 ? double(totals.arrived) / totals.traced : 0.0;
  double emitted = 0.0;
  for (std::size_t e = 0; e < emitter_sums_.size(); ++e) {
    emitted += emitter_sums_[e];
    if (emitter_sums_[e] > 0.0) tally_.touched.insert(scene_.emitters.list[e].cluster);
  }
  const std::uint32_t counted = totals.arrived - totals.arrived_at_emitters;
  const RowScales scales =
      close_row(emitted, totals.traced > 0 ? double(counted) / totals.traced : 0.0, row_sum);
  row.senders.resize(tally_.touched.size());
  row.values.resize(row.senders.size());
  const bool any_emitters = !scene_.emitters.list.empty();
  const double rays = std::max(1u, totals.traced);
  // In local variables: what is written might be anything.
  const std::size_t senders = sender_count(scene_);
  std::uint32_t *const counts = tally_.counts.data(), *sender_out = row.senders.data();
  float* value_out = row.values.data();
  tally_.touched.drain([&](std::uint32_t sender) {
    if (sender >= senders) return;
    double value = std::exchange(counts[sender], 0u) * scales.counted / rays;
    const std::uint32_t emitter =
        any_emitters && sender < scene_.cluster_count ? scene_.emitters.of(sender) : kNone;
    if (emitter != kNone) value += emitter_sums_[emitter] * scales.emitted;
    *sender_out++ = sender, *value_out++ = float(value);
    if (scene_.directional) row.moments.push_back(finish_moment(sender, emitter, scales, totals.traced));
  });
  row.senders.resize(std::size_t(sender_out - row.senders.data())), row.values.resize(row.senders.size());
  std::fill(emitter_sums_.begin(), emitter_sums_.end(), 0.0);
  std::fill(emitter_moments_.begin(), emitter_moments_.end(), glm::dvec3(0.0));
  return row;
}

glm::vec3 RowTracer::finish_moment(std::uint32_t sender, std::uint32_t emitter, const RowScales& scales,
                                   std::uint32_t traced) {
  glm::dvec3 moment = direction_sums_[sender] * (scales.counted / std::max(1u, traced));
  direction_sums_[sender] = glm::dvec3(0.0);
  if (emitter != kNone) moment += emitter_moments_[emitter] * scales.emitted;
  return glm::vec3(moment);
}

}  // namespace relume
