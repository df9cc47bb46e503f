// SPDX-License-Identifier: MIT
#include "precompute/ray_record.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include "core/section_table.h"

namespace relume {
namespace {

/// So many bits of an identity say where it belongs.
constexpr unsigned kShelfBits = 6;

void append_samples(const std::vector<SampleState>& samples, std::vector<std::byte>& packed) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % kSamplesPerByte == 0) packed.push_back(std::byte{0});
    packed.back() |= std::byte(unsigned(samples[i]) << (2 * (i % kSamplesPerByte)));
  }
}

}  // namespace

RayRecord::RayRecord(const RayCodes& codes) : codes_(codes), shelves_(std::size_t{1} << kShelfBits) {
  const std::size_t expected = codes.elements / shelves_.size() + codes.elements / shelves_.size() / 8;
  for (Shelf& shelf : shelves_) shelf.places.resize(std::bit_ceil(2 * expected + 1));
}

RayRecord::Place& RayRecord::place_of(std::uint64_t identity, std::vector<Place>& places) {
  std::size_t at = identity & (places.size() - 1);
  while (places[at].rays != nullptr && places[at].identity != identity) at = (at + 1) & (places.size() - 1);
  return places[at];
}

RayRecord::Shelf& RayRecord::shelf_of(std::uint64_t identity) {
  return shelves_[identity >> (64 - kShelfBits)];
}

void RayRecord::fetch(std::span<const std::uint64_t> identities) {
  for (const std::uint64_t identity : identities) {
    Shelf& shelf = shelf_of(identity);
    const std::lock_guard lock(shelf.mutex);
    __builtin_prefetch(&shelf.places[identity & (shelf.places.size() - 1)]);
  }
}

KnownRays& RayRecord::of(std::uint64_t identity) {
  Shelf& shelf = shelf_of(identity);
  const std::lock_guard lock(shelf.mutex);
  Place& place = place_of(identity, shelf.places);
  if (place.rays != nullptr) return *place.rays;
  KnownRays& fresh = shelf.rays.emplace_back(identity);
  place = {identity, &fresh};
  if (2 * shelf.rays.size() > shelf.places.size()) {
    std::vector<Place> more(2 * shelf.places.size());
    for (const Place& each : shelf.places) {
      if (each.rays != nullptr) place_of(each.identity, more) = each;
    }
    shelf.places = std::move(more);
  }
  return fresh;
}

ChunkMemory& RayRecord::memory() {
  const std::lock_guard lock(mutex_);
  return memories_.emplace_back();
}

std::vector<RayRecord::Place> RayRecord::sorted(const Shelf& shelf) {
  std::vector<Place> all;
  all.reserve(shelf.rays.size());
  std::copy_if(shelf.places.begin(), shelf.places.end(), std::back_inserter(all),
               [](const Place& place) { return place.rays != nullptr; });
  std::sort(all.begin(), all.end(), [](const Place& a, const Place& b) { return a.identity < b.identity; });
  return all;
}

RecordedRays RayRecord::take(std::uint64_t emitters) {
  RecordedRays rays;
  for (Shelf& shelf : shelves_) {
    for (const auto& [identity, known] : sorted(shelf)) {
      const bool current = known->emitters == emitters;
      rays.receivers.push_back({identity, known->rays, current ? std::uint32_t(known->samples.size()) : 0,
                                std::uint32_t(known->emitter_hits.size()), 0});
      if (current) append_samples(known->samples, rays.samples);
      rays.emitter_hits.insert(rays.emitter_hits.end(), known->emitter_hits.begin(),
                               known->emitter_hits.end());
      rays.codes.emplace_back(known->codes.first(codes_.width() * std::size_t{known->rays}));
    }
    std::fill(shelf.places.begin(), shelf.places.end(), Place{});
    shelf.rays.clear();
  }
  rays.codes.emplace_back(kCodesEnd);
  rays.checksum = checksum_of(rays.codes);
  rays.owner = std::make_shared<const std::deque<ChunkMemory>>(std::exchange(memories_, {}));
  return rays;
}

FileParts encode_rows(RowsFile& file, RecordedRays rays) {
  file.receivers = std::move(rays.receivers);
  file.samples = rays.samples, file.emitter_hits = rays.emitter_hits;
  FileParts parts = encode_rows(file, rays.codes, rays.checksum);
  parts.owners.push_back(std::move(rays.owner));
  return parts;
}

}  // namespace relume
