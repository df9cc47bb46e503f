// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "precompute/ray_codes.h"
#include "precompute/rows_file.h"

namespace relume {

/// What is known of the rays of one receiver.
struct KnownRays {
  std::mutex in_use;                     ///< hold it while you read or write
  std::uint32_t rays = 0;                ///< room for so many codes
  std::vector<std::byte> codes;          ///< `rays` of them
  std::vector<EmitterHit> emitter_hits;  ///< ascending by ray, between the rows of a receiver
  std::vector<SampleState> samples;
  std::uint64_t emitters = 0;  ///< key of those that the samples were drawn from
};

/// Grows while rays are traced: whoever asks again for a ray need not trace it. Thread-safe.
class RayRecord {
 public:
  explicit RayRecord(const RayCodes& codes);

  /// Of a receiver, by its identity; lives as long as the record.
  KnownRays& of(std::uint64_t identity);
  /// The bytes of a .rows file of everything, with the rest of it in `file`; forgets it. Samples of other
  /// emitters than settings.emitters of the file are left out.
  FileParts encode(RowsFile& file);

 private:
  static constexpr std::size_t kShelves = 64;
  struct Shelf {
    std::mutex mutex;
    std::unordered_map<std::uint64_t, KnownRays> rays;
  };
  std::vector<Shelf> shelves_;
};

}  // namespace relume
