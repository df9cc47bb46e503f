// SPDX-License-Identifier: MIT
//
// Questions about what surrounds a surface, asked of the caster or remembered from an earlier precompute.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/mutual_visibility.h"
#include "precompute/scene_change.h"

namespace relume {

/// Thread-safe. Answers are kept by keys of the points that were asked about, with the answer in the lowest
/// bit.
class Views {
 public:
  /// Borrows all of it. `change` may be missing; with it, what its old rows know is not asked again where
  /// nothing has changed. `record`: answers are kept.
  Views(const Geometry& geometry, const RayCaster& caster, const SceneChange* change = nullptr,
        bool record = false);

  /// mutually_visible; rays that were traced are added to `rays`. The answer is kept.
  bool see_each_other(const SurfacePoint& a, const SurfacePoint& b, std::uint64_t& rays);
  /// The same; nothing is kept.
  bool ask(const SurfacePoint& a, const SurfacePoint& b, std::uint64_t& rays) const;
  /// The same of each of some points, which is faster for several at once.
  std::vector<bool> ask_each(const SurfacePoint& a, std::span<const SurfacePoint> points,
                             std::uint64_t& rays) const;
  void keep(const SurfacePoint& a, const SurfacePoint& b, bool visible);
  /// Whether answers are kept at all.
  bool records() const { return record_; }
  /// Whether a point lies inside other geometry: more than half of some rays meet back faces. The answer is
  /// kept.
  bool inside(const SurfacePoint& point, std::uint64_t& rays);

  /// All that was kept, ascending. Forgets it.
  std::vector<std::uint64_t> take_answers();

 private:
  enum class Answer : std::uint8_t { unknown, no, yes };
  std::vector<Answer> recall_each(std::span<const std::uint64_t> keys) const;
  Answer recall(std::uint64_t key) const;
  bool settle(Answer old, const SurfacePoint& a, const SurfacePoint& b, std::uint64_t& rays) const;
  void keep(std::uint64_t key, bool answer);

  const Geometry& geometry_;
  const RayCaster& caster_;
  const SceneChange* change_;
  bool record_;
  std::vector<std::uint32_t> first_;  ///< of the old answers, by the first bits of their keys
  int skipped_bits_ = 0;              ///< all others: a larger table than there are answers is farther away
  tbb::enumerable_thread_specific<std::vector<std::uint64_t>> answers_;
};

}  // namespace relume
