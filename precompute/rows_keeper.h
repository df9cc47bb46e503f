// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/result.h"
#include "precompute/kept_rays.h"
#include "precompute/precompute.h"
#include "precompute/ray_recall.h"
#include "precompute/surfaces.h"

namespace relume {

/// Remembers the rays of a precompute, from PrecomputeOptions::old_rows on, until they become
/// PrecomputeReport::rows.
class RowsKeeper {
 public:
  /// Borrows everything. Fails as KeptRays::compare does.
  static Result<std::unique_ptr<RowsKeeper>> start(const Scene& scene, const PrecomputeOptions& options,
                                                   const Surfaces& surfaces, const RayCaster& caster,
                                                   const SenderLookup& lookup, PrecomputeReport& report);

  RayMemory& memory() { return memory_; }
  /// Bytes that so many rays take at most, until their file is written.
  std::uint64_t memory_of(std::uint64_t rays) const;
  /// The bytes of a .rows file, where options ask to keep rows. Forgets the rays.
  std::vector<std::byte> finish(const PrecomputeReport& report);

 private:
  RowsKeeper(const Scene& scene, std::uint64_t seed, const Surfaces& surfaces, const RayCaster& caster,
             const SenderLookup& lookup);

  const Scene& scene_;
  std::uint64_t seed_;
  const Surfaces& surfaces_;
  const RayCaster& caster_;
  std::vector<std::uint64_t> triangle_keys_, element_keys_;
  std::optional<KeptRays> kept_;
  RayMemory memory_;
};

}  // namespace relume
