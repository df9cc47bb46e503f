// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "precompute/box_tree.h"

namespace relume {

struct Ball {
  glm::vec3 middle{0.0f};
  float radius = 0.0f;
};

/// The same of many, coordinate by coordinate.
struct Balls {
  std::array<std::vector<float>, 3> middle;
  std::vector<float> radius;

  std::size_t size() const { return radius.size(); }
  Ball at(std::size_t i) const { return {{middle[0][i], middle[1][i], middle[2][i]}, radius[i]}; }
  void push_back(const Ball& ball);
};

/// Where a box may hide something from a place: behind the box, grown, in the pyramid that it is seen in, cut
/// along two coordinate axes. Balls no larger than what the box was grown by are told apart by their middles.
class Shadow {
 public:
  /// Everything may be hidden.
  Shadow() = default;
  /// Of the box grown by `radius`, from anywhere within `radius` of `from`.
  Shadow(const Box& box, const glm::vec3& from, float radius);

  /// Whether the box is between no place that it is seen from and none of the ball.
  bool clear_of(const Ball& ball) const {
    const glm::vec3 way = ball.middle - from_;
    const float ahead = side_ * way[axes_[0]], a = way[axes_[1]], b = way[axes_[2]];
    const bool beside = ahead < nearest_ || a < lower_[0] * ahead || a > upper_[0] * ahead ||
                        b < lower_[1] * ahead || b > upper_[1] * ahead;
    return beside && ball.radius <= radius_;
  }
  /// The same of each ball: 1 or 0.
  void clear_of(const Balls& balls, std::span<std::uint8_t> clear) const;

 private:
  glm::vec3 from_{0.0f};
  float radius_ = -1.0f;                    ///< so large may balls be
  std::array<int, 3> axes_{0, 1, 2};        ///< towards the box, and aside
  float side_ = 1.0f;                       ///< of the box, along the first axis
  float nearest_ = 0.0f;                    ///< of the box, along the first axis
  std::array<float, 2> lower_{}, upper_{};  ///< slopes of the pyramid
};

}  // namespace relume
