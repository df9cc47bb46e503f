// SPDX-License-Identifier: MIT
#include "precompute/shadow.h"

namespace relume {

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

}  // namespace relume
