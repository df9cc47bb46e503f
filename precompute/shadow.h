// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "precompute/box_tree.h"

namespace relume {

struct Ball {
  glm::vec3 middle{0.0f};
  float radius = 0.0f;
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

 private:
  glm::vec3 from_{0.0f};
  float radius_ = -1.0f;                    ///< so large may balls be
  std::array<int, 3> axes_{0, 1, 2};        ///< towards the box, and aside
  float side_ = 1.0f;                       ///< of the box, along the first axis
  float nearest_ = 0.0f;                    ///< of the box, along the first axis
  std::array<float, 2> lower_{}, upper_{};  ///< slopes of the pyramid
};

}  // namespace relume
