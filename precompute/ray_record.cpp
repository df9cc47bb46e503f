// SPDX-License-Identifier: MIT
#include "precompute/ray_record.h"

#include <algorithm>

namespace relume {
namespace {

void append_samples(const std::vector<SampleState>& samples, std::vector<std::byte>& packed) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % kSamplesPerByte == 0) packed.push_back(std::byte{0});
    packed.back() |= std::byte(unsigned(samples[i]) << (2 * (i % kSamplesPerByte)));
  }
}

}  // namespace

RayRecord::RayRecord(const RayCodes& codes) : shelves_(kShelves) {
  for (Shelf& shelf : shelves_) shelf.rays.reserve(codes.elements / kShelves + codes.elements / kShelves / 8);
}

KnownRays& RayRecord::of(std::uint64_t identity) {
  Shelf& shelf = shelves_[identity % kShelves];
  const std::lock_guard lock(shelf.mutex);
  return shelf.rays[identity];
}

FileParts RayRecord::encode(RowsFile& file) {
  std::vector<std::pair<std::uint64_t, KnownRays*>> all;
  for (Shelf& shelf : shelves_) {
    for (auto& [identity, known] : shelf.rays) all.emplace_back(identity, &known);
  }
  std::sort(all.begin(), all.end());
  std::vector<std::byte> samples;
  std::vector<EmitterHit> hits;
  std::vector<std::span<const std::byte>> codes;
  for (const auto& [identity, known] : all) {
    const bool current = known->emitters == file.settings.emitters;
    file.receivers.push_back({identity, known->rays, current ? std::uint32_t(known->samples.size()) : 0,
                              std::uint32_t(known->emitter_hits.size()), 0});
    if (current) append_samples(known->samples, samples);
    hits.insert(hits.end(), known->emitter_hits.begin(), known->emitter_hits.end());
    codes.emplace_back(known->codes);
  }
  file.samples = samples, file.emitter_hits = hits;
  FileParts parts = encode_rows(file, codes);
  for (const auto& [identity, known] : all) parts.owned.push_back(std::move(known->codes));
  for (Shelf& shelf : shelves_) shelf.rays.clear();
  return parts;
}

}  // namespace relume
