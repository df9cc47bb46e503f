// SPDX-License-Identifier: MIT
//
// Points spread evenly over triangles, one at a time or in lanes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "precompute/mutual_visibility.h"
#include "precompute/sampling.h"

namespace relume {

/// A triangle to sample: point = corner + a edge1 + b edge2.
struct Patch {
  glm::vec3 corner{0.0f}, edge1{0.0f}, edge2{0.0f};
  Frame frame{};              ///< about its normal
  float area_below = 0.0f;    ///< m2, of all patches before it
  float inverse_area = 0.0f;  ///< 1/m2
};

/// Points on patches.
struct alignas(32) PointLanes {
  Lanes x, y, z;
  std::array<std::uint32_t, kLanes> patch;  ///< index
};

class AreaSampler {
 public:
  void add(const std::array<glm::vec3, 3>& corners, const glm::vec3& normal, float area);

  const Patch& patch(std::size_t index) const { return patches_[index]; }
  const std::vector<Patch>& patches() const { return patches_; }
  /// Whether all patches have one normal.
  bool flat() const { return flat_; }
  float area() const { return area_above_.empty() ? 0.0f : area_above_.back(); }

  /// u, v in [0, 1).
  SurfacePoint sample(float u, float v) const;

  /// The same for lanes; inline, so that it becomes part of vectorised loops.
  [[gnu::always_inline]] void sample(const Lanes& u, const Lanes& v, PointLanes& points) const {
    Lanes target;
    for (std::size_t lane = 0; lane < kLanes; ++lane) target[lane] = u[lane] * area();
    points.patch.fill(0);
    if (patches_.size() == 1) {
      const Patch only = patches_[0];
      place([&](std::size_t) -> const Patch& { return only; }, target, v, points);
      return;
    }
    choose_patches(target, points);
    place([&](std::size_t lane) -> const Patch& { return patches_[points.patch[lane]]; }, target, v, points);
  }

 private:
  /// Up to so many are counted through in lanes, which is quicker than to search.
  static constexpr std::size_t kFewPatches = 64;

  /// How far into its patch a target lies, in [0, 1).
  static float share(const Patch& patch, float target) {
    const float share = (target - patch.area_below) * patch.inverse_area;
    return share > 0.0f ? (share < 0.99999994f ? share : 0.99999994f) : 0.0f;
  }
  [[gnu::always_inline]] void choose_patches(const Lanes& target, PointLanes& points) const {
    if (patches_.size() > kFewPatches) {
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        points.patch[lane] = std::uint32_t(find(target[lane]));
      return;
    }
    for (std::size_t p = 0; p + 1 < patches_.size(); ++p) {
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        points.patch[lane] += target[lane] >= area_above_[p] ? 1u : 0u;
    }
  }
  template <class PatchOf>
  [[gnu::always_inline]] static void place(const PatchOf& patch_of, const Lanes& target, const Lanes& v,
                                           PointLanes& points) {
    Lanes along1, along2;
    for (std::size_t lane = 0; lane < kLanes; ++lane) along1[lane] = share(patch_of(lane), target[lane]);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const glm::vec2 at = triangle_point(along1[lane], v[lane]);
      along1[lane] = at.x, along2[lane] = at.y;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Patch& patch = patch_of(lane);
      const glm::vec3 point = patch.corner + along1[lane] * patch.edge1 + along2[lane] * patch.edge2;
      points.x[lane] = point.x, points.y[lane] = point.y, points.z[lane] = point.z;
    }
  }
  std::size_t find(float target) const {
    return std::size_t(std::upper_bound(area_above_.begin(), area_above_.end() - 1, target) -
                       area_above_.begin());
  }

  bool flat_ = true;
  std::vector<Patch> patches_;
  std::vector<float> area_above_;  ///< m2, of all patches up to and with each
};

}  // namespace relume
