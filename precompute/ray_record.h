// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "precompute/chunk_memory.h"
#include "precompute/ray_codes.h"
#include "precompute/rows_file.h"

namespace relume {

/// What is known of the rays of one receiver.
struct KnownRays {
  explicit KnownRays(std::uint64_t of_receiver) : identity(of_receiver) {}

  std::mutex in_use;                     ///< hold it while you read or write
  const std::uint64_t identity;          ///< of the receiver
  std::uint32_t rays = 0;                ///< codes
  std::span<std::byte> codes;            ///< room for so many, and maybe more
  std::vector<EmitterHit> emitter_hits;  ///< ascending by ray, between the rows of a receiver
  std::vector<SampleState> samples;
  std::uint64_t emitters = 0;  ///< key of those that the samples were drawn from
};

/// What a .rows file says of rays.
struct RecordedRays {
  std::vector<ReceiverRecord> receivers;
  std::vector<std::byte> samples;
  std::vector<EmitterHit> emitter_hits;
  std::vector<std::span<const std::byte>> codes;  ///< with their padding
  std::uint64_t checksum = 0;                     ///< of the codes
  std::shared_ptr<const void> owner;              ///< of their bytes
};

/// The bytes of a .rows file, with the rest of it in `file`.
FileParts encode_rows(RowsFile& file, RecordedRays rays);

/// Grows while rays are traced: whoever asks again for a ray need not trace it. Thread-safe.
class RayRecord {
 public:
  explicit RayRecord(const RayCodes& codes);

  /// Of a receiver, by its identity; lives as long as the record.
  KnownRays& of(std::uint64_t identity);
  /// Of these it will be asked soon: what is far from the processor is fetched side by side.
  void fetch(std::span<const std::uint64_t> identities);
  /// For the codes that one thread finds; lives as long as the record, until all is taken.
  ChunkMemory& memory();
  /// Everything; forgets it. Samples of other emitters than those of this key are left out.
  RecordedRays take(std::uint64_t emitters);

 private:
  /// Identities are here as well: to look for one is not to look at its rays.
  struct Place {
    std::uint64_t identity = 0;
    KnownRays* rays = nullptr;
  };
  /// Receivers whose identities begin alike, each in the first free place from where its last bits say.
  struct Shelf {
    std::mutex mutex;
    std::deque<KnownRays> rays;
    std::vector<Place> places;  ///< a power of two of them, at most half of them taken
  };
  Shelf& shelf_of(std::uint64_t identity);
  static Place& place_of(std::uint64_t identity, std::vector<Place>& places);
  static std::vector<Place> sorted(const Shelf& shelf);

  RayCodes codes_;
  std::vector<Shelf> shelves_;
  std::mutex mutex_;
  std::deque<ChunkMemory> memories_;
};

}  // namespace relume
