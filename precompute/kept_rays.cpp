// SPDX-License-Identifier: MIT
#include "precompute/kept_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numeric>

#include "core/sky.h"
#include "precompute/mutual_visibility.h"
#include "precompute/packet_lanes.h"
#include "precompute/unchanged_elements.h"

namespace relume {
namespace {

/// Receivers are searched for among those that begin with so many bits of their identities: these are as good
/// as random.
constexpr unsigned kFirstBits = 16;

constexpr std::size_t kCacheLine = 64;

constexpr float kFar = std::numeric_limits<float>::max();

/// Most balls are no larger than so many times their mean.
constexpr float kUsual = 1.5f;

float usual(std::span<const float> radii) {
  const double sum = std::accumulate(radii.begin(), radii.end(), 0.0);
  return kUsual * float(sum / double(std::max<std::size_t>(radii.size(), 1)));
}

/// Whether a ball that moves from a to b stays clear of a box (C. Ericson, Real-Time Collision Detection,
/// 2005: a segment and a box that is grown by the radius, by axes that part them).
bool passes(const glm::vec3& a, const glm::vec3& b, float radius, const Box& box) {
  const glm::vec3 half = 0.5f * (box.upper - box.lower) + radius, way = 0.5f * (b - a),
                  middle = 0.5f * (a + b) - 0.5f * (box.lower + box.upper), reach = glm::abs(way);
  if (glm::any(glm::greaterThan(glm::abs(middle), half + reach))) return true;
  const glm::vec3 apart = glm::abs(glm::cross(middle, way));
  return apart.x > half.y * reach.z + half.z * reach.y || apart.y > half.x * reach.z + half.z * reach.x ||
         apart.z > half.x * reach.y + half.y * reach.x;
}

/// No direction of a cell of the sky is further than this from the one through its middle: half a step along
/// both of its angles (core/sky.h).
constexpr float kCellReach = 1.4143f * 3.1416f / (4.0f * float(RayCodes::kSkyResolution));

}  // namespace

Result<KeptRays> KeptRays::compare(const SceneChange& change, const std::string& name, double texel_size,
                                   const Surfaces& surfaces, const RayCaster& caster,
                                   const SenderLookup& lookup, std::span<const std::uint64_t> element_keys) {
  KeptRays kept(change);
  if (kept.old_.settings.texel_size != texel_size) {
    return fail(
        ErrorCode::bad_input,
        fmt::format("{}: expected rows of --texel-size {}, found those of {}; precompute without --update",
                    name, texel_size, kept.old_.settings.texel_size));
  }
  if (kept.old_.ray_tracer != caster.description()) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected rows traced by {}, found those of {}; precompute without --update",
                            name, caster.description(), kept.old_.ray_tracer));
  }
  if (!change.comparable()) return kept;
  kept.old_codes_ = kept.old_.ray_codes();
  kept.old_width_ = kept.old_codes_.width();
  kept.codes_ = {std::uint32_t(surfaces.geometry.triangles.size()), lookup.element_count()};
  const glm::vec3 margin(change.margin());
  kept.added_ = {change.added_bounds().lower - margin, change.added_bounds().upper + margin};
  kept.find_balls(surfaces);
  kept.translate(surfaces, caster, lookup, element_keys);
  kept.index_receivers();
  return kept;
}

void KeptRays::find_balls(const Surfaces& surfaces) {
  for (const ClusteredSurface& system : surfaces.systems) {
    for (const Element& element : system.surface.elements) {
      balls_.push_back({element.position, 0.0f});
      for (std::uint32_t p = 0; p < element.piece_count; ++p) {
        const SurfacePiece& shape = system.surface.pieces[element.first_piece + p].shape;
        for (const glm::vec2& corner : shape.corners) {
          const glm::vec3 at = surfaces.geometry.point(shape.triangle, corner.x, corner.y);
          balls_.back().radius = std::max(balls_.back().radius, glm::length(at - element.position));
        }
      }
    }
  }
  std::vector<float> radii;
  for (const Ball& ball : balls_) radii.push_back(ball.radius);
  usual_radius_ = usual(radii);
  const Geometry& geometry = surfaces.geometry;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    Ball& ball = triangle_balls_.emplace_back(Ball{geometry.point(t, 1.0f / 3.0f, 1.0f / 3.0f)});
    for (const auto corner : geometry.triangles[t])
      ball.radius = std::max(ball.radius, glm::length(geometry.positions[corner] - ball.middle));
  }
}

void KeptRays::translate(const Surfaces& surfaces, const RayCaster& caster, const SenderLookup& lookup,
                         std::span<const std::uint64_t> keys) {
  const Geometry& geometry = surfaces.geometry;
  const std::vector<bool> settled = change_.settled(geometry, caster);
  new_codes_.assign(old_codes_.count(), RayCodes::kUnknown);
  new_codes_[RayCodes::kNoRay] = RayCodes::kNoRay;
  for (std::uint32_t code = RayCodes::kFirstCell; RayCodes::is_sky(code); ++code) {
    new_codes_[code] = code;
    cells_.emplace_back(sky_cell_direction(code - RayCodes::kFirstCell, RayCodes::kSkyResolution));
  }
  std::vector<bool> charted(geometry.triangles.size(), false);
  for (const Chart& chart : surfaces.charts) {
    for (const auto t : chart.triangles) charted[t] = true;
  }
  for (std::uint32_t t = 0; t < change_.new_triangles().size(); ++t) {
    const std::uint32_t own = change_.new_triangles()[t];
    if (own == kNone || !settled[own]) continue;
    const std::uint32_t opposite = geometry.opposite[own];
    if (opposite == kNone && !geometry.has_back(own)) new_codes_[old_codes_.back(t)] = codes_.back(own);
    if (!charted[own] && (opposite == kNone || !charted[opposite]))
      new_codes_[old_codes_.bare(t)] = codes_.bare(own);
  }
  std::vector<std::uint32_t> old_of(keys.size());
  std::transform(keys.begin(), keys.end(), old_of.begin(),
                 [&](std::uint64_t key) { return change_.old_element(key); });
  old_elements_ = unchanged_elements(surfaces, lookup, old_of, settled, [&](std::uint32_t e, float reach) {
    return change_.disturbed(balls_[e].middle, balls_[e].radius + reach);
  });
  for (std::uint32_t e = 0; e < old_elements_.size(); ++e) {
    if (old_elements_[e] != kNone) new_codes_[old_codes_.element(old_elements_[e])] = codes_.element(e);
  }
}

KeptSenders KeptRays::senders(const SenderLookup& lookup, std::span<const std::uint32_t> seen,
                              std::uint32_t open) const {
  KeptSenders kept;
  for (const std::uint32_t code : new_codes_) {
    const std::uint32_t now = code == RayCodes::kUnknown ? open : seen[code];
    kept.met.push_back({now == open ? std::uint32_t{RayCodes::kUnknown} : code, now});
  }
  kept.met.push_back({RayCodes::kUnknown, open});
  kept.codes.assign(open, RayCodes::kUnknown);
  for (std::uint32_t code = RayCodes::kFirstCell; RayCodes::is_sky(code); ++code)
    kept.codes[seen[code]] = code;
  std::vector<Box> boxes;
  const auto for_each_kept = [&](auto&& visit) {
    for (std::uint32_t e = 0; e < old_elements_.size(); ++e) {
      if (old_elements_[e] != kNone) visit(e, lookup.sender_of(e));
    }
  };
  for_each_kept([&](std::uint32_t e, std::uint32_t sender) {
    const Box own{balls_[e].middle - balls_[e].radius, balls_[e].middle + balls_[e].radius};
    if (sender >= boxes.size()) boxes.resize(sender + 1, {glm::vec3(kFar), glm::vec3(-kFar)});
    boxes[sender] = join(boxes[sender], own);
  });
  for (const Box& box : boxes) kept.balls.push_back({0.5f * (box.lower + box.upper), 0.0f});
  for_each_kept([&](std::uint32_t e, std::uint32_t sender) {
    float& radius = kept.balls.radius[sender];
    radius =
        std::max(radius, glm::length(balls_[e].middle - kept.balls.at(sender).middle) + balls_[e].radius);
  });
  kept.usual_radius = usual(kept.balls.radius);
  return kept;
}

void KeptRays::index_receivers() {
  first_place_.assign((std::size_t{1} << kFirstBits) + 1, 0);
  for (const ReceiverRecord& receiver : old_.receivers)
    ++first_place_[(receiver.identity >> (64 - kFirstBits)) + 1];
  for (std::size_t i = 1; i < first_place_.size(); ++i) first_place_[i] += first_place_[i - 1];
  places_.reserve(old_.receivers.size());
  std::uint64_t codes = 0, samples = 0, hits = 0;
  for (const ReceiverRecord& receiver : old_.receivers) {
    places_.push_back(
        {receiver.identity, codes, samples, hits, receiver.rays, receiver.samples, receiver.emitter_hits});
    codes += receiver.rays;
    samples += (receiver.samples + kSamplesPerByte - 1) / kSamplesPerByte;
    hits += receiver.emitter_hits;
  }
}

void KeptRays::fetch(std::span<const std::uint64_t> identities) const {
  if (new_codes_.empty()) return;
  const auto bits = [](std::uint64_t identity) { return identity >> (64 - kFirstBits); };
  for (const std::uint64_t identity : identities) __builtin_prefetch(&first_place_[bits(identity)]);
  for (const std::uint64_t identity : identities)
    __builtin_prefetch(places_.data() + first_place_[bits(identity)]);
  for (const std::uint64_t identity : identities) static_cast<void>(find(identity));
}

std::optional<OldRays> KeptRays::find(std::uint64_t identity) const {
  if (new_codes_.empty()) return std::nullopt;
  const std::uint64_t bits = identity >> (64 - kFirstBits);
  const auto end = places_.begin() + first_place_[bits + 1];
  const auto found =
      std::lower_bound(places_.begin() + first_place_[bits], end, identity,
                       [](const Place& place, std::uint64_t wanted) { return place.identity < wanted; });
  if (found == end || found->identity != identity) return std::nullopt;
  const OldRays rays{old_.codes.data() + found->first_code * old_width_, found->rays,
                     old_.samples.data() + found->first_sample, found->samples,
                     old_.emitter_hits.subspan(found->first_hit, found->hits)};
  // They are asked for in another order than they lie in.
  for (std::size_t byte = 0; byte < std::size_t{rays.rays} * old_width_; byte += kCacheLine)
    __builtin_prefetch(rays.codes + byte);
  return rays;
}

SampleState KeptRays::sample(const OldRays& rays, std::uint32_t sample) const {
  if (sample >= rays.sample_count) return SampleState::unknown;
  const unsigned four = std::to_integer<unsigned>(rays.samples[sample / kSamplesPerByte]);
  return SampleState(four >> (2 * (sample % kSamplesPerByte)) & 3u);
}

bool KeptRays::was_whole(std::uint32_t element) const {
  if (element >= old_elements_.size() || old_elements_[element] == kNone) return false;
  // Between its middle and its patches, lifted.
  const Ball& ball = balls_[element];
  return old_.whole_elements[old_elements_[element]] != 0 &&
         !change_.disturbed(ball.middle, kLiftReach * ball.radius);
}

Vantage KeptRays::vantage(const Ball& origins, float usual) const {
  return {origins, Shadow(added_, origins.middle, std::max(origins.radius, usual))};
}

bool KeptRays::stands_clear(const Vantage& from, std::uint32_t code) const {
  if (codes_.is_element(code)) return stands_clear(from, balls_[code - codes_.first_element()]);
  if (codes_.is_back(code)) return stands_clear(from, triangle_balls_[code - codes_.back(0)]);
  if (codes_.is_bare(code)) return stands_clear(from, triangle_balls_[code - codes_.bare(0)]);
  return code == RayCodes::kNoRay ||
         (RayCodes::is_sky(code) && clear_of_sky(from, code - RayCodes::kFirstCell));
}

bool KeptRays::stands_clear(const Vantage& from, const Ball& ball) const {
  if (from.shadow.clear_of(ball)) return true;
  return ball.radius > usual_radius_ &&
         passes(from.origins.middle, ball.middle, std::max(from.origins.radius, ball.radius), added_);
}

/// Rays to a cell of the sky stay within a cone.
bool KeptRays::clear_of_sky(const Vantage& from, std::uint32_t cell) const {
  const auto& [middle, radius] = from.origins;
  const float beyond = radius + glm::length(0.5f * (added_.lower + added_.upper) - middle) +
                       glm::length(added_.upper - added_.lower);
  return passes(middle, middle + beyond * cells_[cell], radius + beyond * kCellReach, added_);
}

std::uint32_t KeptRays::blocked(const RayPacket& packet, std::uint32_t lanes,
                                const std::array<std::uint32_t, kPacketSize>& codes) const {
  if (!change_.added() || lanes == 0) return 0;
  RayPacket test = packet;
  test.far.fill(std::numeric_limits<float>::infinity());
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if (!codes_.is_element(codes[lane])) continue;
    const Ball& ball = balls_[codes[lane] - codes_.first_element()];
    const glm::vec3 origin(packet.origin_x[lane], packet.origin_y[lane], packet.origin_z[lane]);
    test.far[lane] = glm::length(ball.middle - origin) + ball.radius + change_.margin();
  }
  choose_lanes(lanes, test);
  return change_.added()->occluded(test);
}

std::uint32_t KeptRays::newly_hidden(const RayPacket& packet, std::uint32_t lanes) const {
  if (!change_.added() || lanes == 0) return 0;
  RayPacket test = packet;
  choose_lanes(lanes, test);
  return change_.added()->occluded(test);
}

std::uint32_t KeptRays::freed(const RayPacket& packet, std::uint32_t lanes) const {
  if (!change_.removed() || lanes == 0) return 0;
  RayPacket test = packet;
  choose_lanes(lanes, test);
  return change_.removed()->occluded(test);
}

}  // namespace relume
