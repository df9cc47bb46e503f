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
    if (patches_.size() > 1) choose_patches(target, points);
    PatchLanes lanes;
    spread(points.patch, lanes);
    place(lanes, target, v, points);
  }

 private:
  /// Up to so many are counted through in lanes, which is quicker than to search.
  static constexpr std::size_t kFewPatches = 64;
  /// Up to so many are compared with in lanes, which is quicker than to fetch what each lane needs.
  static constexpr std::size_t kVeryFewPatches = 4;

  /// What it takes to place a point: area_below, inverse_area, corner, edge1, edge2.
  static constexpr std::size_t kFields = 11;
  static std::array<float, kFields> fields(const Patch& p) {
    return {p.area_below, p.inverse_area, p.corner.x, p.corner.y, p.corner.z, p.edge1.x,
            p.edge1.y,    p.edge1.z,      p.edge2.x,  p.edge2.y,  p.edge2.z};
  }
  using PatchLanes = std::array<Lanes, kFields>;

  /// How far into its patch a target lies, in [0, 1).
  static float share(float area_below, float inverse_area, float target) {
    const float share = (target - area_below) * inverse_area;
    return share > 0.0f ? (share < 0.99999994f ? share : 0.99999994f) : 0.0f;
  }
  [[gnu::always_inline]] void choose_patches(const Lanes& target, PointLanes& points) const {
    if (patches_.size() > kFewPatches) {
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        points.patch[lane] = std::uint32_t(find(target[lane]));
      return;
    }
    Lanes chosen{};  // numbers, for vector units keep to one type
    for (std::size_t p = 0; p + 1 < patches_.size(); ++p) {
      const float above = area_above_[p];
      for (std::size_t lane = 0; lane < kLanes; ++lane) chosen[lane] += target[lane] >= above ? 1.0f : 0.0f;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      points.patch[lane] = std::uint32_t(std::int32_t(chosen[lane]));
  }
  /// The fields of the patch of each lane.
  [[gnu::always_inline]] void spread(const std::array<std::uint32_t, kLanes>& patch,
                                     PatchLanes& lanes) const {
    if (patches_.size() > kVeryFewPatches) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const auto own = fields(patches_[patch[lane]]);
        for (std::size_t f = 0; f < kFields; ++f) lanes[f][lane] = own[f];
      }
      return;
    }
    for (Lanes& values : lanes) values.fill(0.0f);
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      Lanes own;  // 1 or 0: sums of products go together in lanes where choices do not
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        own[lane] = float(std::int32_t(patch[lane])) == float(p) ? 1.0f : 0.0f;
      for (std::size_t f = 0; f < kFields; ++f) {
        const float value = few_[f][p];
        for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[f][lane] += own[lane] * value;
      }
    }
  }
  [[gnu::always_inline]] static void place(const PatchLanes& patch, const Lanes& target, const Lanes& v,
                                           PointLanes& points) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const glm::vec2 at = triangle_point(share(patch[0][lane], patch[1][lane], target[lane]), v[lane]);
      points.x[lane] = patch[2][lane] + at.x * patch[5][lane] + at.y * patch[8][lane];
      points.y[lane] = patch[3][lane] + at.x * patch[6][lane] + at.y * patch[9][lane];
      points.z[lane] = patch[4][lane] + at.x * patch[7][lane] + at.y * patch[10][lane];
    }
  }
  std::size_t find(float target) const {
    return std::size_t(std::upper_bound(area_above_.begin(), area_above_.end() - 1, target) -
                       area_above_.begin());
  }

  bool flat_ = true;
  std::vector<Patch> patches_;
  std::vector<float> area_above_;                                  ///< m2, of all patches up to and with each
  std::array<std::array<float, kVeryFewPatches>, kFields> few_{};  ///< fields of the first patches
};

}  // namespace relume
