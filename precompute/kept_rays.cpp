// SPDX-License-Identifier: MIT
#include "precompute/kept_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <set>
#include <unordered_map>

#include "core/ray_offset.h"
#include "precompute/unchanged_elements.h"

namespace relume {
namespace {

/// Rounding of hits, and the slack with which ties are settled (ray_caster.cpp), are far below this share of
/// the largest coordinate.
constexpr float kMargin = 0x1p-15f;

/// Of `old_of`, the longest part that ascends (M. Fredman, On Computing the Length of Longest Increasing
/// Subsequences, 1975): true where an entry belongs to it. kNone never does.
std::vector<bool> ascending(const std::vector<std::uint32_t>& old_of) {
  std::vector<std::uint32_t> ends, before(old_of.size(), kNone);  // indices into old_of
  for (std::uint32_t i = 0; i < old_of.size(); ++i) {
    if (old_of[i] == kNone) continue;
    const auto at =
        std::lower_bound(ends.begin(), ends.end(), old_of[i],
                         [&](std::uint32_t end, std::uint32_t value) { return old_of[end] < value; });
    if (at != ends.begin()) before[i] = *(at - 1);
    if (at == ends.end()) {
      ends.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<bool> chosen(old_of.size(), false);
  for (std::uint32_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i]) chosen[i] = true;
  return chosen;
}

template <class Positions, class Triangles>
Box box_of(const Positions& positions, const Triangles& triangle) {
  Box box{positions[triangle[0]], positions[triangle[0]]};
  for (const auto corner : triangle) box = join(box, {positions[corner], positions[corner]});
  return box;
}

Result<std::optional<RayCaster>> caster_of(std::span<const glm::vec3> positions,
                                           std::span<const std::array<std::uint32_t, 3>> triangles,
                                           const std::vector<std::uint32_t>& some) {
  if (some.empty()) return std::optional<RayCaster>();
  std::vector<std::array<std::uint32_t, 3>> own;
  for (const auto t : some) own.push_back(triangles[t]);
  auto caster = RayCaster::create(positions, own);
  if (!caster) return tl::unexpected(caster.error());
  return std::optional<RayCaster>(std::move(*caster));
}

void choose_lanes(std::uint32_t lanes, RayPacket& packet) {
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if ((lanes >> lane & 1u) == 0) packet.far[lane] = -1.0f;
  }
}

Result<void> check_settings(const RowsFile& old, const std::string& name, std::uint64_t seed,
                            double texel_size, const RayCaster& caster) {
  const auto bad = [&](const std::string& what) {
    return fail(ErrorCode::bad_input, fmt::format("{}: {}; precompute without --update", name, what));
  };
  if (old.settings.seed != seed)
    return bad(fmt::format("expected rows of --seed {}, found those of {}", seed, old.settings.seed));
  if (old.settings.texel_size != texel_size) {
    return bad(fmt::format("expected rows of --texel-size {}, found those of {}", texel_size,
                           old.settings.texel_size));
  }
  if (old.ray_tracer != caster.description()) {
    return bad(
        fmt::format("expected rows traced by {}, found those of {}", caster.description(), old.ray_tracer));
  }
  return {};
}

}  // namespace

Result<KeptRays> KeptRays::compare(const RowsFile& old, const std::string& name, const Scene& scene,
                                   std::uint64_t seed, double texel_size, const Surfaces& surfaces,
                                   const RayCaster& caster, const SenderLookup& lookup,
                                   std::span<const std::uint64_t> triangle_keys,
                                   std::span<const std::uint64_t> element_keys) {
  if (auto same = check_settings(old, name, seed, texel_size, caster); !same)
    return tl::unexpected(same.error());
  KeptRays kept(old);
  const Geometry& geometry = surfaces.geometry;
  kept.old_codes_ = old.ray_codes();
  kept.codes_ = {std::uint32_t(geometry.triangles.size()), lookup.element_count()};
  kept.margin_ = kMargin * largest_coordinate(geometry.positions);
  kept.match_triangles(geometry, scene, triangle_keys);
  if (kept.removed_triangles_.size() == old.triangles.size()) {
    return fail(
        ErrorCode::bad_input,
        fmt::format("{}: expected rows of an earlier {}, found those of {}, which has no triangle in common "
                    "with it; precompute without --update",
                    name, scene.file_name, old.scene_file));
  }
  if (old.settings.origin != geometry.origin || old.settings.offset != geometry.offset) return kept;
  if (auto cast = kept.cast_changes(geometry); !cast) return tl::unexpected(cast.error());
  kept.find_balls(surfaces);
  kept.translate(surfaces, caster, lookup, element_keys);
  kept.index_receivers();
  return kept;
}

void KeptRays::match_triangles(const Geometry& geometry, const Scene& scene,
                               std::span<const std::uint64_t> keys) {
  std::unordered_map<std::uint64_t, std::uint32_t> old_of_key;
  old_of_key.reserve(old_.triangles.size());
  for (std::uint32_t t = 0; t < old_.triangles.size(); ++t) old_of_key.try_emplace(old_.triangle_keys[t], t);
  std::vector<std::uint32_t> old_of(keys.size(), kNone);
  for (std::uint32_t t = 0; t < keys.size(); ++t) {
    if (const auto found = old_of_key.find(keys[t]); found != old_of_key.end()) old_of[t] = found->second;
  }
  // Hits at equal distance go to the lowest triangle: those that changed places are new ones.
  const std::vector<bool> unchanged = ascending(old_of);
  std::set<std::string> nodes;
  new_triangle_.assign(old_.triangles.size(), kNone);
  for (std::uint32_t t = 0; t < keys.size(); ++t) {
    if (unchanged[t]) {
      new_triangle_[old_of[t]] = t;
      continue;
    }
    added_triangles_.push_back(t);
    nodes.insert(scene.nodes[geometry.node[t]].path);
  }
  for (std::uint32_t t = 0; t < new_triangle_.size(); ++t) {
    if (new_triangle_[t] != kNone) continue;
    removed_triangles_.push_back(t);
    nodes.insert(old_.nodes[old_.triangle_nodes[t]]);
  }
  changed_nodes_.assign(nodes.begin(), nodes.end());
}

Result<void> KeptRays::cast_changes(const Geometry& geometry) {
  auto added = caster_of(geometry.positions, geometry.triangles, added_triangles_);
  if (!added) return tl::unexpected(added.error());
  auto removed = caster_of(old_.positions, old_.triangles, removed_triangles_);
  if (!removed) return tl::unexpected(removed.error());
  added_ = std::move(*added), removed_ = std::move(*removed);
  std::vector<Box> boxes;
  for (const auto t : added_triangles_) boxes.push_back(box_of(geometry.positions, geometry.triangles[t]));
  if (!boxes.empty()) {
    added_bounds_ = BoxTree(boxes).bounds();
    added_ball_ = {0.5f * (added_bounds_.lower + added_bounds_.upper),
                   0.5f * glm::length(added_bounds_.upper - added_bounds_.lower)};
  }
  for (const auto t : removed_triangles_) boxes.push_back(box_of(old_.positions, old_.triangles[t]));
  changes_ = BoxTree(std::move(boxes));
  return {};
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
}

void KeptRays::translate(const Surfaces& surfaces, const RayCaster& caster, const SenderLookup& lookup,
                         std::span<const std::uint64_t> keys) {
  const Geometry& geometry = surfaces.geometry;
  const auto ties = [](const std::vector<std::uint8_t>& flags, std::uint32_t t) {
    return !flags.empty() && flags[t] != 0;
  };
  std::vector<bool> settled(geometry.triangles.size(),
                            false);  // unchanged, and ties are looked for as before
  for (std::uint32_t t = 0; t < new_triangle_.size(); ++t) {
    if (new_triangle_[t] == kNone) continue;
    settled[new_triangle_[t]] = ties(old_.ties, t) == ties(caster.ties(), new_triangle_[t]);
  }
  new_codes_.assign(old_codes_.count(), RayCodes::kUnknown);
  new_codes_[RayCodes::kNoRay] = RayCodes::kNoRay;
  for (std::uint32_t code = RayCodes::kFirstCell; RayCodes::is_sky(code); ++code) new_codes_[code] = code;
  std::vector<bool> charted(geometry.triangles.size(), false);
  for (const Chart& chart : surfaces.charts) {
    for (const auto t : chart.triangles) charted[t] = true;
  }
  for (std::uint32_t t = 0; t < new_triangle_.size(); ++t) {
    const std::uint32_t own = new_triangle_[t];
    if (own == kNone || !settled[own]) continue;
    const std::uint32_t opposite = geometry.opposite[own];
    if (opposite == kNone && !geometry.double_sided[geometry.material[own]])
      new_codes_[old_codes_.back(t)] = codes_.back(own);
    if (!charted[own] && (opposite == kNone || !charted[opposite]))
      new_codes_[old_codes_.bare(t)] = codes_.bare(own);
  }
  const std::vector<std::uint32_t> old_elements = unchanged_elements(
      surfaces, lookup, keys, old_.element_keys, settled,
      [&](std::uint32_t e, float reach) { return disturbed(balls_[e].middle, balls_[e].radius + reach); });
  for (std::uint32_t e = 0; e < old_elements.size(); ++e) {
    if (old_elements[e] != kNone) new_codes_[old_codes_.element(old_elements[e])] = codes_.element(e);
  }
}

void KeptRays::index_receivers() {
  std::uint64_t codes = 0, samples = 0, hits = 0;
  for (const ReceiverRecord& receiver : old_.receivers) {
    first_code_.push_back(codes), first_sample_.push_back(samples), first_hit_.push_back(hits);
    codes += receiver.rays;
    samples += (receiver.samples + kSamplesPerByte - 1) / kSamplesPerByte;
    hits += receiver.emitter_hits;
  }
}

std::optional<OldRays> KeptRays::find(std::uint64_t identity) const {
  if (new_codes_.empty()) return std::nullopt;
  const auto found = std::lower_bound(
      old_.receivers.begin(), old_.receivers.end(), identity,
      [](const ReceiverRecord& receiver, std::uint64_t wanted) { return receiver.identity < wanted; });
  if (found == old_.receivers.end() || found->identity != identity) return std::nullopt;
  const auto i = std::size_t(found - old_.receivers.begin());
  return OldRays{old_.codes.data() + first_code_[i] * old_codes_.width(), found->rays,
                 old_.samples.data() + first_sample_[i], found->samples,
                 old_.emitter_hits.subspan(first_hit_[i], found->emitter_hits)};
}

std::uint32_t KeptRays::code(const OldRays& rays, std::uint32_t ray) const {
  if (ray >= rays.rays) return RayCodes::kUnknown;
  const std::uint32_t old = load_code(rays.codes, old_codes_.width(), ray);
  return old < new_codes_.size() ? new_codes_[old] : RayCodes::kUnknown;
}

SampleState KeptRays::sample(const OldRays& rays, std::uint32_t sample) const {
  if (sample >= rays.sample_count) return SampleState::unknown;
  const unsigned four = std::to_integer<unsigned>(rays.samples[sample / kSamplesPerByte]);
  return SampleState(four >> (2 * (sample % kSamplesPerByte)) & 3u);
}

bool KeptRays::disturbed(const glm::vec3& position, float reach) const {
  const glm::vec3 far(reach + margin_);
  return changes_.meets({position - far, position + far});
}

bool KeptRays::stands_clear(const glm::vec3& from, float reach, std::uint32_t element) const {
  const Ball& ball = balls_[element];
  const glm::vec3 way = ball.middle - from, to = added_ball_.middle - from;
  const float along = std::clamp(glm::dot(to, way) / std::max(glm::dot(way, way), 1e-30f), 0.0f, 1.0f);
  const glm::vec3 aside = to - along * way;
  const float apart = added_ball_.radius + std::max(reach, ball.radius) + margin_;
  return glm::dot(aside, aside) > apart * apart;
}

std::uint32_t KeptRays::blocked(const RayPacket& packet, std::uint32_t lanes,
                                const std::array<std::uint32_t, kPacketSize>& codes) const {
  if (!added_ || lanes == 0) return 0;
  RayPacket test = packet;
  test.far.fill(std::numeric_limits<float>::infinity());
  choose_lanes(lanes, test);
  added_->closest_hits(test, RaySpread::narrow);
  std::uint32_t blocked = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if ((lanes >> lane & 1u) == 0 || test.triangle[lane] == kNoTriangle) continue;
    float reach = std::numeric_limits<float>::infinity();
    if (codes_.is_element(codes[lane])) {
      const Ball& ball = balls_[codes[lane] - codes_.first_element()];
      const glm::vec3 origin(packet.origin_x[lane], packet.origin_y[lane], packet.origin_z[lane]);
      reach = glm::length(ball.middle - origin) + ball.radius + margin_;
    }
    if (test.far[lane] <= reach) blocked |= 1u << lane;
  }
  return blocked;
}

std::uint32_t KeptRays::newly_hidden(const RayPacket& packet, std::uint32_t lanes) const {
  if (!added_ || lanes == 0) return 0;
  RayPacket test = packet;
  choose_lanes(lanes, test);
  return added_->occluded(test);
}

std::uint32_t KeptRays::freed(const RayPacket& packet, std::uint32_t lanes) const {
  if (!removed_ || lanes == 0) return 0;
  RayPacket test = packet;
  choose_lanes(lanes, test);
  return removed_->occluded(test);
}

}  // namespace relume
