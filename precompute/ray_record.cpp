// SPDX-License-Identifier: MIT
#include "precompute/ray_record.h"

#include <algorithm>
#include <cstring>

namespace relume {
namespace {

void append_samples(const std::vector<SampleState>& samples, std::vector<std::byte>& packed) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % kSamplesPerByte == 0) packed.push_back(std::byte{0});
    packed.back() |= std::byte(unsigned(samples[i]) << (2 * (i % kSamplesPerByte)));
  }
}

}  // namespace

KnownRays& RayRecord::of(std::uint64_t identity) {
  Shelf& shelf = shelves_[identity % kShelves];
  const std::lock_guard lock(shelf.mutex);
  std::unique_ptr<KnownRays>& known = shelf.rays[identity];
  if (!known) known = std::make_unique<KnownRays>();
  return *known;
}

void RayRecord::move_into(RowsFile& file) {
  std::vector<std::pair<std::uint64_t, std::unique_ptr<KnownRays>>> all;
  for (Shelf& shelf : shelves_) {
    for (auto& [identity, known] : shelf.rays) all.emplace_back(identity, std::move(known));
    shelf.rays.clear();
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t codes = 0, hits = 0;
  for (const auto& [identity, known] : all)
    codes += std::size_t{known->rays} * codes_.width(), hits += known->emitter_hits.size();
  std::vector<std::byte> samples;
  file.bytes.assign((hits * sizeof(EmitterHit)) + codes + kCodePadding, std::byte{0});
  std::byte *hit = file.bytes.data(), *code = hit + hits * sizeof(EmitterHit);
  file.emitter_hits = {reinterpret_cast<const EmitterHit*>(hit), hits};
  file.codes = {code, codes + kCodePadding};
  for (auto& [identity, known] : all) {
    const bool current = known->emitters == file.settings.emitters;
    file.receivers.push_back({identity, known->rays, current ? std::uint32_t(known->samples.size()) : 0,
                              std::uint32_t(known->emitter_hits.size()), 0});
    if (current) append_samples(known->samples, samples);
    const std::size_t own = std::size_t{known->rays} * codes_.width(),
                      own_hits = known->emitter_hits.size() * sizeof(EmitterHit);
    if (own > 0) std::memcpy(code, known->codes.data(), own);
    if (own_hits > 0) std::memcpy(hit, known->emitter_hits.data(), own_hits);
    code += own, hit += own_hits;
    known.reset();
  }
  file.sample_bytes = std::move(samples);
  file.samples = file.sample_bytes;
}

}  // namespace relume
