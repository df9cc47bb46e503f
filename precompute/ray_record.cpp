// SPDX-License-Identifier: MIT
#include "precompute/ray_record.h"

#include <algorithm>
#include <utility>

#include "core/section_table.h"

namespace relume {
namespace {

void append_samples(const std::vector<SampleState>& samples, std::vector<std::byte>& packed) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % kSamplesPerByte == 0) packed.push_back(std::byte{0});
    packed.back() |= std::byte(unsigned(samples[i]) << (2 * (i % kSamplesPerByte)));
  }
}

}  // namespace

RayRecord::RayRecord(const RayCodes& codes) : codes_(codes), shelves_(kShelves) {
  for (Shelf& shelf : shelves_) shelf.rays.reserve(codes.elements / kShelves + codes.elements / kShelves / 8);
}

KnownRays& RayRecord::of(std::uint64_t identity) {
  Shelf& shelf = shelves_[identity % kShelves];
  const std::lock_guard lock(shelf.mutex);
  return shelf.rays[identity];
}

ChunkMemory& RayRecord::memory() {
  const std::lock_guard lock(mutex_);
  return memories_.emplace_back();
}

RecordedRays RayRecord::take(std::uint64_t emitters) {
  std::vector<std::pair<std::uint64_t, KnownRays*>> all;
  for (Shelf& shelf : shelves_) {
    for (auto& [identity, known] : shelf.rays) all.emplace_back(identity, &known);
  }
  std::sort(all.begin(), all.end());
  RecordedRays rays;
  for (const auto& [identity, known] : all) {
    const bool current = known->emitters == emitters;
    rays.receivers.push_back({identity, known->rays, current ? std::uint32_t(known->samples.size()) : 0,
                              std::uint32_t(known->emitter_hits.size()), 0});
    if (current) append_samples(known->samples, rays.samples);
    rays.emitter_hits.insert(rays.emitter_hits.end(), known->emitter_hits.begin(), known->emitter_hits.end());
    rays.codes.emplace_back(known->codes.first(codes_.width() * std::size_t{known->rays}));
  }
  rays.codes.emplace_back(kCodesEnd);
  rays.checksum = checksum_of(rays.codes);
  for (Shelf& shelf : shelves_) shelf.rays.clear();
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
