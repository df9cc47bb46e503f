// SPDX-License-Identifier: MIT
#include "precompute/ray_sight.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "precompute/packet_lanes.h"
#include "precompute/ray_recall.h"

namespace relume {
namespace {

/// All lanes at once; the same numbers from either version.
[[gnu::target_clones("avx2", "default")]] void sky_places(const SkyCells& cells, const RayPacket& rays,
                                                          std::array<std::uint32_t, kPacketSize>& places) {
  std::array<std::uint32_t, kPacketSize> of_rays;
  cells.of(rays.direction_x, rays.direction_y, rays.direction_z, of_rays);
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) places[lane] = kSky + of_rays[lane];
}

}  // namespace

RaySight::RaySight(const Geometry& geometry, const RayCaster& caster, const SenderLookup& lookup,
                   const Emitters& emitters, RayMemory* memory)
    : geometry_(geometry),
      caster_(caster),
      lookup_(lookup),
      emitters_(emitters),
      sky_cells_(RayCodes::kSkyResolution),
      recall_(memory != nullptr ? std::make_unique<RayRecall>(*memory, emitters, lookup) : nullptr) {}
RaySight::RaySight(RaySight&&) noexcept = default;
RaySight::~RaySight() = default;

void RaySight::begin(std::uint64_t identity, const Receiver& receiver, std::uint32_t rays,
                     std::uint32_t samples) {
  if (recall_) recall_->begin(identity, receiver, rays, samples);
}

void RaySight::end() {
  if (recall_) recall_->end();
}

std::uint64_t RaySight::kept() const {
  return recall_ ? recall_->kept_rays() : 0;
}

std::uint64_t RaySight::kept_samples() const {
  return recall_ ? recall_->kept_samples() : 0;
}

void RaySight::know(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally) {
  recall_->know(numbers, first, tally);
}

std::uint32_t RaySight::confirm(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays) {
  return recall_->confirm(numbers, lanes, rays);
}

std::uint32_t RaySight::recall(const RayNumbers& numbers, std::uint32_t asked, const RayPacket& rays,
                               PacketSight& sight) {
  sight.place.fill(kNoRay);
  sight.emitters = 0;
  return recall_ ? recall_->recall(numbers, asked, rays, sight) : 0;
}

void RaySight::trace(std::uint32_t lanes, RayPacket& rays, PacketSight& sight) {
  choose_lanes(lanes, rays);
  traced_ += std::uint64_t(std::popcount(lanes));
  caster_.closest_hits(rays, RaySpread::narrow);
  const std::uint32_t doubtful = look_up(lanes, rays, sight);
  if (doubtful == 0) return;
  const RayPacket::Numbers met = rays.triangle;
  caster_.settle(rays, doubtful);
  std::uint32_t changed = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane)
    changed |= rays.triangle[lane] != met[lane] ? 1u << lane : 0u;
  if ((doubtful & changed) != 0) look_up(doubtful & changed, rays, sight);
}

std::uint32_t RaySight::look_up(std::uint32_t lanes, const RayPacket& rays, PacketSight& sight) const {
  look_for_places(lanes, rays, sight);
  std::uint32_t doubtful = 0, emitters = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    const std::uint32_t place = sight.place[lane], bit = lanes & 1u << lane;
    if (!sees_element(place)) {
      doubtful |= place == kNone ? bit : 0u;
      continue;
    }
    const ElementOwner owner = lookup_.owner_of(place);
    sight.sender[lane] = owner.sender();
    doubtful |= owner.near_walls() ? bit : 0u;
    emitters |= emitters_.contain(owner.sender()) ? bit : 0u;
  }
  sight.emitters = (sight.emitters & ~lanes) | emitters;
  for (; emitters != 0; emitters &= emitters - 1)
    add_emitter(std::size_t(std::countr_zero(emitters)), rays, sight);
  return doubtful;
}

void RaySight::look_for_places(std::uint32_t lanes, const RayPacket& rays, PacketSight& sight) const {
  std::array<std::uint32_t, kPacketSize> places;
  const std::uint32_t known = lanes & lookup_.seen(rays, places);
  std::uint32_t missed = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    missed |= rays.triangle[lane] == kNoTriangle ? 1u << lane : 0u;
    sight.place[lane] = (known >> lane & 1u) != 0 ? places[lane] : sight.place[lane];
  }
  missed &= lanes;
  if (missed != 0) {
    sky_places(sky_cells_, rays, places);
    for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane)
      sight.place[lane] = (missed >> lane & 1u) != 0 ? places[lane] : sight.place[lane];
  }
  for (std::uint32_t rest = lanes & ~known & ~missed; rest != 0; rest &= rest - 1) {
    const auto lane = std::size_t(std::countr_zero(rest));
    sight.place[lane] =
        lookup_.seen(rays.triangle[lane], rays.u[lane], rays.v[lane], direction_of(rays, lane));
  }
}

void RaySight::add_emitter(std::size_t lane, const RayPacket& rays, PacketSight& sight) const {
  const glm::vec3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
  sight.distance[lane] = rays.far[lane];
  sight.cosine[lane] = std::abs(glm::dot(direction, geometry_.normals[rays.triangle[lane]]));
}

void RaySight::book(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays,
                    const PacketSight& sight) {
  if (recall_) recall_->book(numbers, lanes, rays, sight);
}

std::uint32_t RaySight::recall_samples(std::uint32_t first, std::uint32_t asked, std::uint32_t useful,
                                       const RayPacket& rays, SeenSamples& seen) {
  return recall_ ? recall_->recall_samples(first, asked, useful, rays, seen) : 0;
}

std::uint32_t RaySight::unhidden(std::uint32_t lanes, RayPacket& rays) {
  choose_lanes(lanes, rays);
  traced_samples_ += std::uint64_t(std::popcount(lanes));
  return lanes & ~caster_.occluded(rays);
}

void RaySight::book_samples(std::uint32_t first, std::uint32_t lanes, const SeenSamples& seen) {
  if (recall_) recall_->book_samples(first, lanes, seen);
}

}  // namespace relume
