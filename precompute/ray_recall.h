// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "precompute/kept_rays.h"
#include "precompute/ray_record.h"
#include "precompute/ray_sight.h"
#include "precompute/receiver.h"

namespace relume {

/// What a precompute remembers of rays.
struct RayMemory {
  RayCodes codes;
  std::optional<RayRecord> record;  ///< of those of this run, where they are to be kept
  const KeptRays* kept = nullptr;   ///< of an earlier one
  KeptSenders senders;              ///< of `kept`
  std::uint32_t sender_count = 0;   ///< cells of the sky are among them
  std::vector<std::uint32_t> seen;  ///< per code: a number to count by; open those of possible emitters
  std::uint64_t emitters = 0;  ///< key of the possible emitters (geometry_keys.h) that samples are drawn from
};

/// Call it for possible emitters that are new, and whenever senders have new numbers. `sky_senders`: per
/// cell.
void follow_senders(const SenderLookup& lookup, const Emitters& emitters,
                    std::span<const std::uint32_t> sky_senders, std::uint32_t sender_count,
                    RayMemory& memory);

/// One per thread: answers for rays whose answers are known, and books those of others.
class RayRecall {
 public:
  /// Borrows all of it.
  RayRecall(RayMemory& memory, const Emitters& emitters, const SenderLookup& lookup);

  /// From here to end() it is about the rays of one receiver with this identity: `rays` and `samples` at
  /// most.
  void begin(std::uint64_t identity, const Receiver& receiver, std::uint32_t rays, std::uint32_t samples);
  void end();

  /// As RaySight::know.
  void know(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally);
  /// As RaySight::confirm.
  std::uint32_t confirm(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays);
  /// Of the lanes `asked`, with these numbers in the sequence: those that are known, and what they see. Of
  /// the rays of the packet only origins and directions count.
  std::uint32_t recall(const RayNumbers& numbers, std::uint32_t asked, const RayPacket& rays,
                       PacketSight& sight);
  /// Books what lanes that were traced have met.
  void book(const RayNumbers& numbers, std::uint32_t lanes, const RayPacket& rays, const PacketSight& sight);

  /// The same of samples [first, first + kPacketSize) of emitters' area; `useful` lanes have a segment to
  /// look along.
  std::uint32_t recall_samples(std::uint32_t first, std::uint32_t asked, std::uint32_t useful,
                               const RayPacket& rays, SeenSamples& seen);
  void book_samples(std::uint32_t first, std::uint32_t lanes, const SeenSamples& seen);

  /// So many rays, and samples, were taken from an earlier precompute.
  std::uint64_t kept_rays() const { return kept_rays_; }
  std::uint64_t kept_samples() const { return kept_samples_; }

 private:
  void know_booked(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally);
  void know_old(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally);
  template <std::uint32_t kWidth>
  void count_old(std::span<const std::uint32_t> numbers, std::uint32_t first, RayTally& tally);
  bool doubtful(std::uint32_t seen, std::uint32_t code);
  void look_from(const Ball& origins);
  bool stands_clear_from_vantage(std::uint32_t seen) const;
  bool stands_clear_of(std::uint32_t seen);
  bool tell(std::uint32_t code, std::uint32_t ray, std::span<const EmitterHit> hits, std::size_t lane,
            PacketSight& sight) const;
  std::uint32_t recall_old(const RayNumbers& numbers, std::uint32_t asked, const RayPacket& rays,
                           PacketSight& sight);
  std::uint32_t known_code(std::uint32_t ray) const;
  void open_record(std::uint64_t identity, std::uint32_t rays, std::uint32_t samples);
  void make_room(std::uint32_t rays);
  void book_code(std::uint32_t ray, std::uint32_t code);
  void book_emitter_hit(std::uint32_t ray, std::size_t lane, const PacketSight& sight);
  bool faces_changes(const Receiver& receiver) const;
  bool stands_clear(std::uint32_t code) const;
  std::uint32_t changed_samples(const RayPacket& rays, std::uint32_t hidden, std::uint32_t visible) const;

  RayMemory& memory_;
  const Emitters& emitters_;
  const SenderLookup& lookup_;
  std::uint32_t width_;         ///< of codes
  ChunkMemory* chunks_;         ///< none without a record
  KnownRays* known_ = nullptr;  ///< none without a record
  std::unique_lock<std::mutex> lock_;
  bool blank_ = false;           ///< nothing was in known_
  std::size_t sorted_hits_ = 0;  ///< of known_
  std::optional<OldRays> old_;
  bool old_samples_ = false;   ///< are of the same emitters
  bool faces_changes_ = true;  ///< rays may meet what was added
  Vantage own_{};              ///< of the receiver, where it faces changes
  Vantage vantage_{};          ///< of the receiver, and of others around it
  /// Per number to count by, seen from the vantage: kClear, where nothing new can stand before it, kUnasked
  /// or kDoubtful. Empty before there is one.
  std::vector<std::uint8_t> standing_;
  std::uint64_t kept_rays_ = 0, kept_samples_ = 0;
};

}  // namespace relume
