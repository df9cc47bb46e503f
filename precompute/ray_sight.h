// SPDX-License-Identifier: MIT
//
// What rays see, packet by packet: asked of the caster, or remembered.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/sky.h"
#include "precompute/emitters.h"
#include "precompute/ray_caster.h"
#include "precompute/sender_lookup.h"
#include "precompute/sender_set.h"

namespace relume {

class RayRecall;
struct RayMemory;

/// Which points of a sequence the lanes of a packet are.
using RayNumbers = std::span<const std::uint32_t, kPacketSize>;

/// In place of an element, besides kNone (a surface without elements) and SenderLookup::kBlackBack: there is
/// no ray; and, from kSky on, a cell of the sky.
inline constexpr std::uint32_t kNoRay = kNone - 2, kSky = 0xf0000000u;

inline bool sees_element(std::uint32_t place) {
  return place < kSky;
}
inline bool sees_sky(std::uint32_t place) {
  return place >= kSky && place < kNoRay;
}

/// What the lanes of a packet see.
struct PacketSight {
  std::array<std::uint32_t, kPacketSize> place;   ///< an element of all systems, or one of the above
  std::array<std::uint32_t, kPacketSize> sender;  ///< of elements
  std::uint32_t emitters = 0;                     ///< lanes that see elements of possible emitters, as bits
  /// Of these: m, and the cosine to their normal, above 0.
  std::array<float, kPacketSize> distance, cosine;
};

/// What a ray sees as a number to count by: a sender, or one of these, so many more than there are senders.
enum SeenBeyond : std::uint32_t {
  kSeesBack = 0,  ///< SenderLookup::kBlackBack
  kSeesNothing,   ///< kNone
  kIsNoRay,
  kIsOpen,  ///< not known
  kSeenBeyond
};

/// Rays of one receiver: those whose answers are known are counted, the others are listed.
struct RayTally {
  explicit RayTally(std::size_t numbers) : counts(numbers, 0), touched(numbers) {}

  std::vector<std::uint32_t> counts;            ///< per number to count by
  SenderSet touched;                            ///< with a count
  std::vector<std::uint32_t> open;              ///< points that are to be traced
  std::vector<std::uint32_t> doubtful, doubts;  ///< points, and what they see unless something new is before

  void count(std::uint32_t number) {
    ++counts[number];
    touched.insert(number);
  }
};

/// Of samples of emitters' area, lane by lane as bits.
struct SeenSamples {
  std::uint32_t owned = 0;    ///< the origin belongs to the receiver
  std::uint32_t visible = 0;  ///< and nothing stands in between
};

/// One per thread.
class RaySight {
 public:
  /// Borrows all of it; `memory` may be missing.
  RaySight(const Geometry& geometry, const RayCaster& caster, const SenderLookup& lookup,
           const Emitters& emitters, RayMemory* memory);
  RaySight(RaySight&&) noexcept;
  ~RaySight();

  /// Rays, and samples of emitters, up to end() belong to one receiver, with this identity.
  void begin(std::uint64_t identity, const Receiver& receiver, std::uint32_t rays, std::uint32_t samples);
  void end();

  /// Counts what the rays with these numbers, points from `first` on, are known to see, and adds the others
  /// to the lists; possible emitters are left open. Only with a memory.
  void know(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally);
  /// Of doubtful lanes of a packet: those that see what they saw. Of the rays only origins and directions
  /// count.
  std::uint32_t confirm(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays);

  /// What the lanes `asked` see; the others have no ray. `own(lanes)`: those of the lanes that belong to the
  /// receiver; only asked of rays that must be traced. `rays` is used up.
  template <class Own>
  void see(const RayNumbers& numbers, std::uint32_t asked, RayPacket& rays, PacketSight& sight, Own&& own) {
    const std::uint32_t open = asked & ~recall(numbers, asked, rays, sight);
    if (open == 0) return;
    trace(open & own(open), rays, sight);
    book(numbers, open, rays, sight);
  }

  /// Of samples [first, first + kPacketSize) of the emitters' area, the lanes `asked`: whose origin the
  /// receiver owns
  /// (`own(lanes)`), and which see their emitter. Only `useful` ones of them have a segment to look along.
  template <class Own>
  SeenSamples see_emitters(std::uint32_t first, std::uint32_t asked, std::uint32_t useful, RayPacket& rays,
                           Own&& own) {
    SeenSamples seen;
    const std::uint32_t open = asked & ~recall_samples(first, asked, useful, rays, seen);
    if (open == 0) return seen;
    const std::uint32_t owned = open & own(open);
    seen.owned |= owned;
    seen.visible |= unhidden(owned & useful, rays);
    book_samples(first, open, seen);
    return seen;
  }

  std::uint64_t traced() const { return traced_; }
  std::uint64_t traced_samples() const { return traced_samples_; }
  std::uint64_t kept() const;
  std::uint64_t kept_samples() const;

 private:
  std::uint32_t recall(const RayNumbers& numbers, std::uint32_t asked, const RayPacket& rays,
                       PacketSight& sight);
  void trace(std::uint32_t lanes, RayPacket& rays, PacketSight& sight);
  /// What the lanes have met. Returns those near whose hits surfaces cross or touch, so that others may be as
  /// far away.
  std::uint32_t look_up(std::uint32_t lanes, const RayPacket& rays, PacketSight& sight) const;
  void look_for_places(std::uint32_t lanes, const RayPacket& rays, PacketSight& sight) const;
  void add_emitter(std::size_t lane, const RayPacket& rays, PacketSight& sight) const;
  void book(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays, const PacketSight& sight);
  std::uint32_t recall_samples(std::uint32_t first, std::uint32_t asked, std::uint32_t useful,
                               const RayPacket& rays, SeenSamples& seen);
  std::uint32_t unhidden(std::uint32_t lanes, RayPacket& rays);
  void book_samples(std::uint32_t first, std::uint32_t lanes, const SeenSamples& seen);

  const Geometry& geometry_;
  const RayCaster& caster_;
  const SenderLookup& lookup_;
  const Emitters& emitters_;
  SkyCells sky_cells_;
  std::unique_ptr<RayRecall> recall_;
  std::uint64_t traced_ = 0, traced_samples_ = 0;
};

}  // namespace relume
