// SPDX-License-Identifier: MIT
//
// The rays of a precompute as lists, made by the precompute's own code.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "precompute/geometry.h"
#include "precompute/precompute.h"
#include "precompute/receiver.h"
#include "precompute/sampling.h"
#include "scene/scene.h"

namespace relume::bench {

/// Rays of one receiver.
struct RayList {
  std::vector<float> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z;
  std::size_t size() const { return origin_x.size(); }
};

/// Rays of one receiver: as the sequence gives them, or as the precompute groups them, so that those of a
/// packet go nearly the same way.
enum class RayOrder { sequence, grouped };

/// All closest-hit rays that precompute() traces for the lumels and clusters of a scene, receivers in the
/// order of their clusters. They are made slice by slice: all of them together need 24 bytes each.
class RaysOfPrecompute {
 public:
  /// `options` has sizes and a quality. Borrows geometry and caster.
  static Result<RaysOfPrecompute> create(const Scene& scene, const Geometry& geometry,
                                         const RayCaster& caster, const PrecomputeOptions& options);

  std::size_t receivers() const { return receivers_.size(); }
  std::uint32_t quality() const { return sequence_.count(); }
  /// A list for each of the receivers [first, first + lists.size()).
  void list(std::size_t first, RayOrder order, std::span<RayList> lists) const;

 private:
  RaysOfPrecompute(const Geometry& geometry, const RayCaster& caster, const PrecomputeOptions& options);

  const Geometry& geometry_;
  const RayCaster& caster_;
  std::uint64_t seed_;
  SobolPoints sequence_, grouped_;
  std::vector<Receiver> receivers_;
};

}  // namespace relume::bench
