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
    const auto [towards, a, b] = axes_;
    return pyramid_.clear_of(ball.middle[towards], ball.middle[a], ball.middle[b], ball.radius) != 0;
  }
  /// The same of each ball: 1 or 0.
  void clear_of(const Balls& balls, std::span<std::uint8_t> clear) const;

 private:
  /// From its tip on; coordinates are along the axes towards the box, and aside.
  struct Pyramid {
    std::array<float, 3> tip{};
    float side = 1.0f;                      ///< of the box, along the first axis
    float nearest = 0.0f;                   ///< of the box, along the first axis
    std::array<float, 2> lower{}, upper{};  ///< slopes
    float radius = -1.0f;                   ///< so large may balls be

    /// Without branches, so that balls go together.
    [[gnu::always_inline]] int clear_of(float towards, float a, float b, float of_ball) const {
      const float ahead = side * (towards - tip[0]), aside = a - tip[1], up = b - tip[2];
      const int beside = int(ahead < nearest) | int(aside < lower[0] * ahead) |
                         int(aside > upper[0] * ahead) | int(up < lower[1] * ahead) |
                         int(up > upper[1] * ahead);
      return beside & int(of_ball <= radius);
    }
  };
  static void clear_of(const Pyramid& pyramid, const std::array<const float*, 3>& middles, const float* radii,
                       std::size_t count, std::uint8_t* clear);

  std::array<int, 3> axes_{0, 1, 2};  ///< towards the box, and aside
  Pyramid pyramid_;
};

}  // namespace relume
