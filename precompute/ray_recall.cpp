// SPDX-License-Identifier: MIT
#include "precompute/ray_recall.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>

#include "precompute/geometry_keys.h"

namespace relume {
namespace {

/// Receivers are traced side by side: what one of them finds out about whole senders serves those around it,
/// as far away as this many times its reach.
constexpr float kVantage = 6.0f;

/// What is known of a number to count by. Shadow::clear_of writes the first two.
enum Standing : std::uint8_t { kUnasked = 0, kClear = 1, kDoubtful = 2 };

bool before(const EmitterHit& hit, std::uint32_t ray) {
  return hit.ray < ray;
}

}  // namespace

void follow_senders(const SenderLookup& lookup, const Emitters& emitters,
                    std::span<const std::uint32_t> sky_senders, std::uint32_t sender_count,
                    RayMemory& memory) {
  const RayCodes& codes = memory.codes;
  const std::uint32_t open = sender_count + kIsOpen;
  memory.emitters = emitters_key(emitters);
  memory.sender_count = sender_count;
  memory.seen.assign(codes.count(), open);
  memory.seen[RayCodes::kNoRay] = sender_count + kIsNoRay;
  std::copy(sky_senders.begin(), sky_senders.end(), memory.seen.begin() + RayCodes::kFirstCell);
  std::fill_n(memory.seen.begin() + codes.back(0), codes.triangles, sender_count + kSeesBack);
  std::fill_n(memory.seen.begin() + codes.bare(0), codes.triangles, sender_count + kSeesNothing);
  for (std::uint32_t e = 0; e < codes.elements; ++e) {
    const std::uint32_t sender = lookup.sender_of(e);
    if (!emitters.contain(sender)) memory.seen[codes.element(e)] = sender;
  }
  if (memory.kept != nullptr) memory.senders = memory.kept->senders(lookup, memory.seen, open);
}

RayRecall::RayRecall(RayMemory& memory, const Emitters& emitters, const SenderLookup& lookup)
    : memory_(memory),
      emitters_(emitters),
      lookup_(lookup),
      width_(memory.codes.width()),
      chunks_(memory.record ? &memory.record->memory() : nullptr) {}

void RayRecall::open_record(std::uint64_t identity, std::uint32_t rays, std::uint32_t samples) {
  known_ = &memory_.record->of(identity);
  lock_ = std::unique_lock(known_->in_use);
  blank_ = known_->rays == 0;
  if (known_->rays < rays) make_room(rays);
  if (known_->emitters != memory_.emitters) known_->samples.clear();
  known_->emitters = memory_.emitters;
  if (known_->samples.size() < samples) known_->samples.resize(samples, SampleState::unknown);
  sorted_hits_ = known_->emitter_hits.size();
}

/// For so many codes, more than there were.
void RayRecall::make_room(std::uint32_t rays) {
  const std::size_t before = std::size_t{known_->rays} * width_, bytes = std::size_t{rays} * width_;
  const std::span<std::byte> old = known_->codes;
  if (bytes > old.size()) {
    known_->codes = chunks_->take(std::max(bytes, 2 * old.size()));
    std::copy_n(old.begin(), before, known_->codes.begin());
  }
  known_->rays = rays;
}

void RayRecall::begin(std::uint64_t identity, const Receiver& receiver, std::uint32_t rays,
                      std::uint32_t samples) {
  if (memory_.record) open_record(identity, rays, samples);
  old_.reset();
  if (memory_.kept == nullptr) return;
  // Whether an origin belongs to a walled receiver depends on what stands around it.
  const bool moved = receiver.walled() &&
                     memory_.kept->change().disturbed(receiver.middle().position, 3.0f * receiver.reach());
  if (!moved) old_ = memory_.kept->find(identity);
  old_samples_ = memory_.kept->emitters() == memory_.emitters;
  faces_changes_ = memory_.kept->change().added().has_value() && faces_changes(receiver);
  if (faces_changes_ && old_) look_from({receiver.middle().position, receiver.reach()});
}

void RayRecall::look_from(const Ball& origins) {
  own_ = memory_.kept->vantage(origins);
  const Ball& around = vantage_.origins;
  const bool within = glm::length(origins.middle - around.middle) + origins.radius <= around.radius;
  if (within && !standing_.empty()) return;
  const KeptSenders& senders = memory_.senders;
  vantage_ = memory_.kept->vantage({origins.middle, kVantage * origins.radius}, senders.usual_radius);
  standing_.assign(memory_.sender_count + kSeenBeyond, kUnasked);
  vantage_.shadow.clear_of(senders.balls, standing_);
  standing_[memory_.sender_count + kIsNoRay] = standing_[memory_.sender_count + kIsOpen] = kClear;
}

/// Whether some of what was added lies before the plane of the receiver.
bool RayRecall::faces_changes(const Receiver& receiver) const {
  const SurfacePoint& at = receiver.middle();
  if (!receiver.origins().flat() || at.normal == glm::vec3(0.0f)) return true;
  const Box& added = memory_.kept->change().added_bounds();
  const glm::vec3 furthest(at.normal.x > 0.0f ? added.upper.x : added.lower.x,
                           at.normal.y > 0.0f ? added.upper.y : added.lower.y,
                           at.normal.z > 0.0f ? added.upper.z : added.lower.z);
  const glm::vec3 way = furthest - at.position;
  return glm::dot(way, at.normal) >= -1e-4f * glm::length(way);
}

void RayRecall::end() {
  if (known_ == nullptr) return;
  std::sort(known_->emitter_hits.begin(), known_->emitter_hits.end(),
            [](const EmitterHit& a, const EmitterHit& b) { return a.ray < b.ray; });
  lock_.unlock();
  lock_.release();
  known_ = nullptr;
}

bool RayRecall::tell(std::uint32_t code, std::uint32_t ray, std::span<const EmitterHit> hits,
                     std::size_t lane, PacketSight& sight) const {
  const RayCodes& codes = memory_.codes;
  if (code < RayCodes::kFirstCell) {
    sight.place[lane] = kNoRay;
    return code == RayCodes::kNoRay;
  }
  if (!codes.is_element(code)) {
    sight.place[lane] = RayCodes::is_sky(code) ? kSky + (code - RayCodes::kFirstCell)
                        : codes.is_back(code)  ? SenderLookup::kBlackBack
                                               : kNone;
    return true;
  }
  const std::uint32_t element = code - codes.first_element();
  sight.place[lane] = element;
  sight.sender[lane] = lookup_.sender_of(element);
  if (!emitters_.contain(sight.sender[lane])) return true;
  const auto hit = std::lower_bound(hits.begin(), hits.end(), ray, before);
  if (hit == hits.end() || hit->ray != ray) return false;
  sight.emitters |= 1u << lane;
  sight.distance[lane] = hit->distance, sight.cosine[lane] = hit->cosine;
  return true;
}

std::uint32_t RayRecall::known_code(std::uint32_t ray) const {
  if (known_ == nullptr || ray >= known_->rays) return RayCodes::kUnknown;
  return load_exactly(known_->codes.data(), width_, ray);
}

bool RayRecall::stands_clear_from_vantage(std::uint32_t seen) const {
  const KeptSenders& senders = memory_.senders;
  if (seen >= memory_.sender_count) return false;
  if (senders.codes[seen] != RayCodes::kUnknown)
    return memory_.kept->stands_clear(vantage_, senders.codes[seen]);
  return seen < senders.balls.size() && memory_.kept->stands_clear(vantage_, senders.balls.at(seen));
}

/// Whether nothing new can stand before any of a sender, seen from the receiver.
bool RayRecall::stands_clear_of(std::uint32_t seen) {
  if (standing_[seen] == kUnasked) standing_[seen] = stands_clear_from_vantage(seen) ? kClear : kDoubtful;
  return standing_[seen] == kClear;
}

void RayRecall::know(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally) {
  if (known_ != nullptr && !blank_) {
    know_booked(numbers, first, tally);
  } else if (old_) {
    know_old(numbers, first, tally);
  } else {
    for (std::size_t i = 0; i < numbers.size(); ++i) tally.open.push_back(first + std::uint32_t(i));
  }
}

/// Some rays were booked in this run: the others are asked for one by one.
void RayRecall::know_booked(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally) {
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t seen = memory_.seen[known_code(numbers[i])];
    if (seen != memory_.sender_count + kIsOpen) {
      tally.count(seen);
    } else if (old_) {
      know_old(numbers.subspan(i, 1), first + i, tally);
    } else {
      tally.open.push_back(first + i);
    }
  }
}

void RayRecall::know_old(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally) {
  const std::uint32_t width = width_ == memory_.kept->old_width() ? width_ : 0;
  if (width == 2) {
    count_old<2>(numbers, first, tally);
  } else if (width == 3) {
    count_old<3>(numbers, first, tally);
  } else {
    count_old<0>(numbers, first, tally);
  }
}

/// `kWidth` of old codes and of new ones; 0: as they say. All that the loop needs is in local variables: rays
/// are many, and what it writes might be anything.
template <std::uint32_t kWidth>
void RayRecall::count_old(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally) {
  const std::uint32_t senders = memory_.sender_count, open = senders + kIsOpen,
                      rays = known_ != nullptr ? std::min(old_->rays, known_->rays) : old_->rays,
                      old_width = kWidth > 0 ? kWidth : memory_.kept->old_width(),
                      width = kWidth > 0 ? kWidth : width_;
  const KeptSenders::Met* const met = memory_.senders.met.data();
  const std::uint32_t last = std::uint32_t(memory_.senders.met.size()) - 1;
  const std::byte* const old_codes = old_->codes;
  std::byte* const codes = known_ != nullptr ? known_->codes.data() : nullptr;
  const std::uint8_t* const standing = standing_.data();
  const bool faces_changes = faces_changes_;
  std::uint32_t* const counts = tally.counts.data();
  const auto touch = tally.touched.inserter();
  const std::size_t beyond = tally.counts[senders + kIsNoRay] + tally.open.size() + tally.doubtful.size();
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t ray = numbers[i];
    const KeptSenders::Met now =
        ray < rays ? met[std::min(load_code(old_codes, old_width, ray), last)] : met[last];
    if (now.seen == open) [[unlikely]] {
      tally.open.push_back(first + i);
    } else if (faces_changes && standing[now.seen] != kClear && doubtful(now.seen, now.code)) [[unlikely]] {
      tally.doubtful.push_back(first + i), tally.doubts.push_back(now.seen);
    } else {
      ++counts[now.seen];
      touch(now.seen);
      if (codes != nullptr) store_code(codes, width, ray, now.code);
    }
  }
  kept_rays_ +=
      numbers.size() + beyond - (counts[senders + kIsNoRay] + tally.open.size() + tally.doubtful.size());
}

/// Whether something new may stand before what the receiver saw. Kept out of the loop that calls it.
[[gnu::noinline]] bool RayRecall::doubtful(std::uint32_t seen, std::uint32_t code) {
  return !stands_clear_of(seen) && !stands_clear(code);
}

std::uint32_t RayRecall::confirm(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays) {
  std::array<std::uint32_t, kPacketSize> codes{};
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if ((lanes >> lane & 1u) != 0) codes[lane] = memory_.kept->code(*old_, numbers[lane]);
  }
  const std::uint32_t clear = lanes & ~memory_.kept->blocked(rays, lanes, codes);
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize) && known_ != nullptr; ++lane) {
    if ((clear >> lane & 1u) != 0) book_code(numbers[lane], codes[lane]);
  }
  kept_rays_ += std::uint64_t(std::popcount(clear));
  return clear;
}

/// Whether nothing new can stand before what the receiver saw, wherever on both the ray began and ended.
bool RayRecall::stands_clear(std::uint32_t code) const {
  return !faces_changes_ || memory_.kept->stands_clear(own_, code);
}

std::uint32_t RayRecall::recall(const RayNumbers& numbers, std::uint32_t asked, const RayPacket& rays,
                                PacketSight& sight) {
  std::span<const EmitterHit> hits;
  if (known_ != nullptr) hits = std::span(known_->emitter_hits).first(sorted_hits_);
  std::uint32_t answered = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if ((asked >> lane & 1u) == 0) continue;
    const std::uint32_t code = known_code(numbers[lane]);
    if (code != RayCodes::kUnknown && tell(code, numbers[lane], hits, lane, sight)) answered |= 1u << lane;
  }
  if (old_ && answered != asked) answered |= recall_old(numbers, asked & ~answered, rays, sight);
  return answered;
}

std::uint32_t RayRecall::recall_old(const RayNumbers& numbers, std::uint32_t asked, const RayPacket& rays,
                                    PacketSight& sight) {
  std::array<std::uint32_t, kPacketSize> codes{};
  std::uint32_t told = 0, shot = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if ((asked >> lane & 1u) == 0) continue;
    codes[lane] = memory_.kept->code(*old_, numbers[lane]);
    if (codes[lane] == RayCodes::kUnknown ||
        !tell(codes[lane], numbers[lane], old_->emitter_hits, lane, sight)) {
      continue;
    }
    told |= 1u << lane;
    if (codes[lane] != RayCodes::kNoRay) shot |= 1u << lane;
  }
  if (faces_changes_) told &= ~memory_.kept->blocked(rays, shot, codes);
  kept_rays_ += std::uint64_t(std::popcount(told & shot));
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize) && known_ != nullptr; ++lane) {
    if ((told >> lane & 1u) == 0) continue;
    book_code(numbers[lane], codes[lane]);
    book_emitter_hit(numbers[lane], lane, sight);
  }
  return told;
}

void RayRecall::book_emitter_hit(std::uint32_t ray, std::size_t lane, const PacketSight& sight) {
  if ((sight.emitters >> lane & 1u) != 0)
    known_->emitter_hits.push_back({ray, sight.distance[lane], sight.cosine[lane]});
}

void RayRecall::book_code(std::uint32_t ray, std::uint32_t code) {
  if (ray >= known_->rays) make_room(ray + 1);
  store_code(known_->codes.data(), width_, ray, code);
}

void RayRecall::book(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays,
                     const PacketSight& sight) {
  const RayCodes& codes = memory_.codes;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize) && known_ != nullptr; ++lane) {
    if ((lanes >> lane & 1u) == 0) continue;
    const std::uint32_t place = sight.place[lane];
    book_code(numbers[lane], sees_element(place)                 ? codes.element(place)
                             : sees_sky(place)                   ? RayCodes::kFirstCell + (place - kSky)
                             : place == kNoRay                   ? RayCodes::kNoRay
                             : place == SenderLookup::kBlackBack ? codes.back(rays.triangle[lane])
                                                                 : codes.bare(rays.triangle[lane]));
    book_emitter_hit(numbers[lane], lane, sight);
  }
}

std::uint32_t RayRecall::recall_samples(std::uint32_t first, std::uint32_t asked, std::uint32_t useful,
                                        const RayPacket& rays, SeenSamples& seen) {
  std::array<SampleState, kPacketSize> states{};
  std::uint32_t old_hidden = 0, old_visible = 0, answered = 0, old = 0;
  for (std::uint32_t lane = 0; lane < std::uint32_t(kPacketSize); ++lane) {
    if ((asked >> lane & 1u) == 0) continue;
    if (known_ != nullptr) states[lane] = known_->samples[first + lane];
    if (states[lane] == SampleState::unknown && old_ && old_samples_) {
      states[lane] = memory_.kept->sample(*old_, first + lane);
      old |= states[lane] == SampleState::unknown ? 0u : 1u << lane;
      if (states[lane] == SampleState::hidden) old_hidden |= 1u << lane;
      if (states[lane] == SampleState::visible) old_visible |= 1u << lane;
    }
    if (states[lane] != SampleState::unknown) answered |= 1u << lane;
  }
  answered &= ~changed_samples(rays, old_hidden & useful, old_visible & useful);
  for (std::uint32_t lane = 0; lane < std::uint32_t(kPacketSize); ++lane) {
    if ((answered >> lane & 1u) == 0) continue;
    if (known_ != nullptr) known_->samples[first + lane] = states[lane];
    if (states[lane] != SampleState::foreign) seen.owned |= 1u << lane;
    if (states[lane] == SampleState::visible) seen.visible |= 1u << lane;
  }
  kept_samples_ += std::uint64_t(std::popcount(answered & old & useful & seen.owned));
  return answered;
}

/// Of segments that were hidden, or visible: those that may not be any more.
std::uint32_t RayRecall::changed_samples(const RayPacket& rays, std::uint32_t hidden,
                                         std::uint32_t visible) const {
  std::uint32_t changed = 0;
  if (hidden != 0) changed |= memory_.kept->freed(rays, hidden);
  if (visible != 0 && faces_changes_) changed |= memory_.kept->newly_hidden(rays, visible);
  return changed;
}

void RayRecall::book_samples(std::uint32_t first, std::uint32_t lanes, const SeenSamples& seen) {
  for (std::uint32_t lane = 0; lane < std::uint32_t(kPacketSize) && known_ != nullptr; ++lane) {
    if ((lanes >> lane & 1u) == 0) continue;
    known_->samples[first + lane] = (seen.owned >> lane & 1u) == 0     ? SampleState::foreign
                                    : (seen.visible >> lane & 1u) == 0 ? SampleState::hidden
                                                                       : SampleState::visible;
  }
}

}  // namespace relume
