// SPDX-License-Identifier: MIT
#include "precompute/shadow.h"

namespace relume {
namespace {

/// A pyramid from its tip on, cut along two axes, and what is asked of balls.
struct Pyramid {
  std::array<float, 3> from;  ///< towards the box, and aside
  float side, nearest;
  std::array<float, 2> lower, upper;
  float radius;
};

[[gnu::target_clones("avx2", "default")]] void beside(const Pyramid& pyramid, const float* towards,
                                                      const float* a, const float* b, const float* radius,
                                                      std::size_t count, std::uint8_t* clear) {
  const auto [from, side, nearest, lower, upper, most] = pyramid;
  for (std::size_t i = 0; i < count; ++i) {
    const float ahead = side * (towards[i] - from[0]), aside = a[i] - from[1], up = b[i] - from[2];
    const int out = int(ahead < nearest) | int(aside < lower[0] * ahead) | int(aside > upper[0] * ahead) |
                    int(up < lower[1] * ahead) | int(up > upper[1] * ahead);
    clear[i] = std::uint8_t(out & int(radius[i] <= most));
  }
}

}  // namespace

void Balls::push_back(const Ball& ball) {
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis].push_back(ball.middle[int(axis)]);
  radius.push_back(ball.radius);
}

Shadow::Shadow(const Box& box, const glm::vec3& from, float radius) : from_(from) {
  const glm::vec3 lower = box.lower - radius - from, upper = box.upper + radius - from;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {1.0f, -1.0f}) {
      const float nearest = side > 0.0f ? lower[axis] : -upper[axis];
      if (!(nearest > nearest_)) continue;
      nearest_ = nearest, side_ = side;
      axes_ = {axis, (axis + 1) % 3, (axis + 2) % 3};
    }
  }
  if (!(nearest_ > 0.0f)) return;  // the place is within the box
  const float furthest = side_ > 0.0f ? upper[axes_[0]] : -lower[axes_[0]];
  for (std::size_t i = 0; i < 2; ++i) {
    const float low = lower[axes_[i + 1]], high = upper[axes_[i + 1]];
    lower_[i] = low / (low < 0.0f ? nearest_ : furthest);
    upper_[i] = high / (high > 0.0f ? nearest_ : furthest);
  }
  radius_ = radius;
}

void Shadow::clear_of(const Balls& balls, std::span<std::uint8_t> clear) const {
  const auto along = [&](std::size_t i) { return balls.middle[std::size_t(axes_[i])].data(); };
  const Pyramid pyramid{
      {from_[axes_[0]], from_[axes_[1]], from_[axes_[2]]}, side_, nearest_, lower_, upper_, radius_};
  beside(pyramid, along(0), along(1), along(2), balls.radius.data(), balls.size(), clear.data());
}

}  // namespace relume
