// SPDX-License-Identifier: MIT
//
// Embree as anybody would use it, without the precompute's ray caster.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>

#include "core/result.h"
#include "ray_list.h"

namespace relume::bench {

/// What all rays together met: a sum that depends on every one of them.
struct HitCount {
  std::uint64_t hits = 0;
  std::uint64_t triangle_sum = 0;
};

class BareEmbree {
 public:
  /// Robust scene, default build quality; `configuration` as rtcNewDevice takes it.
  static Result<BareEmbree> create(std::span<const glm::vec3> positions,
                                   std::span<const std::array<std::uint32_t, 3>> triangles,
                                   const std::string& configuration);
  BareEmbree(BareEmbree&&) noexcept;
  ~BareEmbree();

  /// Closest hits of all rays on all cores, by rtcIntersect1, 8 or 16 (`width`), a list a task; with Embree's
  /// hint that rays of a packet are alike, or without.
  HitCount trace(std::span<const RayList> lists, int width, bool alike) const;

 private:
  struct State;
  explicit BareEmbree(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace relume::bench
