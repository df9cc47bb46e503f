// SPDX-License-Identifier: MIT
#include "precompute/ray_record.h"

#include <algorithm>
#include <bit>
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
  for (Shelf& shelf : shelves_) shelf.places.resize(std::bit_ceil(2 * expected + 1), nullptr);
}

KnownRays*& RayRecord::place_of(std::uint64_t identity, std::vector<KnownRays*>& places) {
  std::size_t at = identity & (places.size() - 1);
  while (places[at] != nullptr && places[at]->identity != identity) at = (at + 1) & (places.size() - 1);
  return places[at];
}

KnownRays& RayRecord::of(std::uint64_t identity) {
  Shelf& shelf = shelves_[identity >> (64 - kShelfBits)];
  const std::lock_guard lock(shelf.mutex);
  KnownRays*& known = place_of(identity, shelf.places);
  if (known != nullptr) return *known;
  KnownRays& fresh = *(known = &shelf.rays.emplace_back(identity));
  if (2 * shelf.rays.size() > shelf.places.size()) {
    std::vector<KnownRays*> more(2 * shelf.places.size(), nullptr);
    for (KnownRays& each : shelf.rays) place_of(each.identity, more) = &each;
    shelf.places = std::move(more);
  }
  return fresh;
}

ChunkMemory& RayRecord::memory() {
  const std::lock_guard lock(mutex_);
  return memories_.emplace_back();
}

std::vector<KnownRays*> RayRecord::sorted(Shelf& shelf) {
  std::vector<KnownRays*> all;
  all.reserve(shelf.rays.size());
  for (KnownRays& known : shelf.rays) all.push_back(&known);
  std::sort(all.begin(), all.end(),
            [](const KnownRays* a, const KnownRays* b) { return a->identity < b->identity; });
  return all;
}

RecordedRays RayRecord::take(std::uint64_t emitters) {
  RecordedRays rays;
  for (Shelf& shelf : shelves_) {
    for (const KnownRays* known : sorted(shelf)) {
      const bool current = known->emitters == emitters;
      rays.receivers.push_back({known->identity, known->rays,
                                current ? std::uint32_t(known->samples.size()) : 0,
                                std::uint32_t(known->emitter_hits.size()), 0});
      if (current) append_samples(known->samples, rays.samples);
      rays.emitter_hits.insert(rays.emitter_hits.end(), known->emitter_hits.begin(),
                               known->emitter_hits.end());
      rays.codes.emplace_back(known->codes.first(codes_.width() * std::size_t{known->rays}));
    }
    std::fill(shelf.places.begin(), shelf.places.end(), nullptr);
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
