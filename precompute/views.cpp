// SPDX-License-Identifier: MIT
#include "precompute/views.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/geometric.hpp>
#include <limits>

#include "core/mix.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

/// Rays that decide whether a point lies inside other geometry; inside when more than half meet back faces.
constexpr int kInsideRays = 16;

constexpr std::uint64_t kSeeEachOther = 0x736565ull, kInside = 0x696e73ull;

std::uint64_t mix_point(std::uint64_t key, const SurfacePoint& point) {
  const auto pair = [](float a, float b) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(a)} << 32 | std::bit_cast<std::uint32_t>(b);
  };
  key = mix(key, pair(point.position.x, point.position.y));
  key = mix(key, pair(point.position.z, point.normal.x));
  return mix(key, pair(point.normal.y, point.normal.z));
}

std::uint64_t key_of(const SurfacePoint& a, const SurfacePoint& b) {
  return mix_point(mix_point(kSeeEachOther, a), b) & ~std::uint64_t{1};
}

using InsideRays = std::array<RayPacket, kInsideRays / kPacketSize>;

InsideRays inside_rays(const Geometry& geometry, const SurfacePoint& point) {
  static const SobolPoints points(kInsideRays);
  const Frame frame = frame_about(point.normal);
  const glm::vec3 origin = point.position + point.normal * geometry.offset;
  InsideRays rays;
  for (int i = 0; i < kInsideRays; ++i) {
    RayPacket& packet = rays[std::size_t(i / kPacketSize)];
    const int lane = i % kPacketSize;
    const SamplePoint s = points.scrambled(std::uint32_t(i), 1);
    const glm::vec3 d = frame.to_world(cosine_direction(s[0], s[1]));
    packet.origin_x[lane] = origin.x, packet.origin_y[lane] = origin.y, packet.origin_z[lane] = origin.z;
    packet.direction_x[lane] = d.x, packet.direction_y[lane] = d.y, packet.direction_z[lane] = d.z;
    packet.near[lane] = 0.0f, packet.far[lane] = std::numeric_limits<float>::infinity();
  }
  return rays;
}

bool mostly_back_faces(const Geometry& geometry, const RayCaster& caster, InsideRays rays) {
  int back_faces = 0;
  for (RayPacket& packet : rays) {
    caster.closest_hits(packet);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const std::uint32_t t = packet.triangle[lane];
      if (t == kNoTriangle) continue;
      const glm::vec3 d(packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]);
      back_faces += seen_surface(geometry, {t, packet.u[lane], packet.v[lane], Side::front}, d) ? 0 : 1;
    }
  }
  return 2 * back_faces > kInsideRays;
}

bool any_meets(const std::optional<RayCaster>& caster, InsideRays rays) {
  return caster && std::any_of(rays.begin(), rays.end(),
                               [&](RayPacket& packet) { return caster->occluded(packet) != 0; });
}

}  // namespace

Views::Views(const Geometry& geometry, const RayCaster& caster, const SceneChange* change, bool record)
    : geometry_(geometry),
      caster_(caster),
      change_(change != nullptr && change->comparable() ? change : nullptr),
      record_(record) {
  if (change_ == nullptr) return;
  const std::vector<std::uint64_t>& answers = change_->old().views;
  skipped_bits_ = 64 - std::max(1, int(std::bit_width(answers.size())));
  first_.assign((std::size_t{1} << (64 - skipped_bits_)) + 1, 0);
  for (const std::uint64_t answer : answers) ++first_[(answer >> skipped_bits_) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
}

Views::Answer Views::recall(std::uint64_t key) const {
  const std::size_t bits = key >> skipped_bits_;
  for (std::uint32_t i = first_[bits]; i < first_[bits + 1]; ++i) {
    const std::uint64_t answer = change_->old().views[i];
    if ((answer & ~std::uint64_t{1}) == key) return (answer & 1) != 0 ? Answer::yes : Answer::no;
  }
  return Answer::unknown;
}

std::vector<Views::Answer> Views::recall_each(std::span<const std::uint64_t> keys) const {
  for (const std::uint64_t key : keys) __builtin_prefetch(&first_[key >> skipped_bits_]);
  for (const std::uint64_t key : keys)
    __builtin_prefetch(change_->old().views.data() + first_[key >> skipped_bits_]);
  std::vector<Answer> answers;
  for (const std::uint64_t key : keys) answers.push_back(recall(key));
  return answers;
}

void Views::keep(std::uint64_t key, bool answer) {
  if (record_) answers_.local().push_back(key | (answer ? 1u : 0u));
}

void Views::keep(const SurfacePoint& a, const SurfacePoint& b, bool visible) {
  if (record_) keep(key_of(a, b), visible);
}

bool Views::settle(Answer old, const SurfacePoint& a, const SurfacePoint& b, std::uint64_t& rays) const {
  const float reach = kLiftReach * glm::length(b.position - a.position) + 2.0f * geometry_.offset;
  const bool stands = change_ != nullptr && old != Answer::unknown && !change_->disturbed(a.position, reach);
  if (stands) return old == Answer::yes;
  rays += 3;
  return mutually_visible(geometry_, caster_, a, b);
}

bool Views::ask(const SurfacePoint& a, const SurfacePoint& b, std::uint64_t& rays) const {
  return settle(change_ != nullptr ? recall(key_of(a, b)) : Answer::unknown, a, b, rays);
}

std::vector<bool> Views::ask_each(const SurfacePoint& a, std::span<const SurfacePoint> points,
                                  std::uint64_t& rays) const {
  std::vector<Answer> old(points.size(), Answer::unknown);
  if (change_ != nullptr) {
    std::vector<std::uint64_t> keys;
    for (const SurfacePoint& point : points) keys.push_back(key_of(a, point));
    old = recall_each(keys);
  }
  std::vector<bool> visible;
  for (std::size_t i = 0; i < points.size(); ++i) visible.push_back(settle(old[i], a, points[i], rays));
  return visible;
}

bool Views::see_each_other(const SurfacePoint& a, const SurfacePoint& b, std::uint64_t& rays) {
  const bool visible = ask(a, b, rays);
  keep(a, b, visible);
  return visible;
}

bool Views::inside(const SurfacePoint& point, std::uint64_t& rays) {
  const std::uint64_t key = mix_point(kInside, point) & ~std::uint64_t{1};
  const Answer old = change_ != nullptr ? recall(key) : Answer::unknown;
  const InsideRays packets = inside_rays(geometry_, point);
  bool answer = old == Answer::yes;
  if (old == Answer::unknown || any_meets(change_->added(), packets) ||
      any_meets(change_->removed(), packets)) {
    answer = mostly_back_faces(geometry_, caster_, packets);
    rays += kInsideRays;
  }
  keep(key, answer);
  return answer;
}

std::vector<std::uint64_t> Views::take_answers() {
  std::vector<std::uint64_t> all;
  for (std::vector<std::uint64_t>& own : answers_) all.insert(all.end(), own.begin(), own.end());
  answers_.clear();
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace relume
