// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/result.h"
#include "precompute/enclosed_grid.h"
#include "precompute/kept_rays.h"
#include "precompute/light_samples.h"
#include "precompute/precompute.h"
#include "precompute/ray_recall.h"
#include "precompute/surfaces.h"

namespace relume {

/// Remembers the rays of a precompute, from PrecomputeOptions::old_rows on, until they become
/// PrecomputeReport::rows.
class RowsKeeper {
 public:
  /// Before surfaces are cut. Borrows scene and options. Fails as SceneChange::find does.
  static Result<std::unique_ptr<RowsKeeper>> start(const Scene& scene, const PrecomputeOptions& options,
                                                   const Geometry& geometry, PrecomputeReport& report);
  /// As RayCaster::create takes them.
  std::vector<std::uint8_t> known_ties(const Geometry& geometry) const;
  /// For cut_surfaces; nothing without old rows.
  std::optional<EarlierSurfaces> earlier() const;
  /// Once they are cut; borrows all. Fails as KeptRays::compare and RowsFile::await_rays do.
  Result<void> follow(const Surfaces& surfaces, const SenderLookup& lookup, const RayCaster& caster,
                      const PrecomputeReport& report);

  /// Since the old rows; nothing without.
  const SceneChange* change() const { return change_ ? &*change_ : nullptr; }
  RayMemory& memory() { return memory_; }
  /// Elements whose light patches are known to be all their own, in the `orders` in which the model has
  /// elements; and what has been found.
  WholeElements known_whole(const std::vector<std::vector<std::uint32_t>>& orders) const;
  /// Of the others, `views` are the answers about their patches.
  void keep_whole(const std::vector<std::vector<std::uint32_t>>& orders, const WholeElements& whole,
                  std::vector<std::uint64_t> views);
  /// Of what the rig sees; nothing without old rows.
  std::optional<EarlierLooks> earlier_looks(const Geometry& geometry, const RayCaster& caster) const;
  void keep_looks(EnclosedGrid grid);
  /// Bytes that so many rays take, until their file is written.
  std::uint64_t memory_of(std::uint64_t rays) const;
  /// Once all rays are traced, where options ask to keep rows.
  void take_rays();
  /// Then: the bytes of a .rows file. Forgets the rays.
  FileParts finish(const PrecomputeReport& report);

 private:
  RowsKeeper(const Scene& scene, const PrecomputeOptions& options, const Geometry& geometry);

  const Scene& scene_;
  const PrecomputeOptions& options_;
  const Surfaces* surfaces_ = nullptr;  ///< once they are cut
  const RayCaster* caster_ = nullptr;   ///< then
  std::vector<std::uint64_t> triangle_keys_, element_keys_;
  std::vector<std::uint8_t> whole_;  ///< per element of all systems
  std::vector<std::uint64_t> patch_views_;
  EnclosedGrid looked_;
  RecordedRays rays_;
  std::optional<SceneChange> change_;
  std::optional<KeptRays> kept_;
  RayMemory memory_;
};

}  // namespace relume
