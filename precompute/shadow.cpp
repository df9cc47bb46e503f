// SPDX-License-Identifier: MIT
#include "precompute/shadow.h"

namespace relume {

void Balls::push_back(const Ball& ball) {
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis].push_back(ball.middle[int(axis)]);
  radius.push_back(ball.radius);
}

Shadow::Shadow(const Box& box, const glm::vec3& from, float radius) {
  const glm::vec3 lower = box.lower - radius - from, upper = box.upper + radius - from;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {1.0f, -1.0f}) {
      const float nearest = side > 0.0f ? lower[axis] : -upper[axis];
      if (!(nearest > pyramid_.nearest)) continue;
      pyramid_.nearest = nearest, pyramid_.side = side;
      axes_ = {axis, (axis + 1) % 3, (axis + 2) % 3};
    }
  }
  if (!(pyramid_.nearest > 0.0f)) return;  // the place is within the box
  const float furthest = pyramid_.side > 0.0f ? upper[axes_[0]] : -lower[axes_[0]];
  for (std::size_t i = 0; i < 3; ++i) pyramid_.tip[i] = from[axes_[i]];
  for (std::size_t i = 0; i < 2; ++i) {
    const float low = lower[axes_[i + 1]], high = upper[axes_[i + 1]];
    pyramid_.lower[i] = low / (low < 0.0f ? pyramid_.nearest : furthest);
    pyramid_.upper[i] = high / (high > 0.0f ? pyramid_.nearest : furthest);
  }
  pyramid_.radius = radius;
}

[[gnu::target_clones("avx2", "default")]] void Shadow::clear_of(const Pyramid& pyramid,
                                                                const std::array<const float*, 3>& middles,
                                                                const float* radii, std::size_t count,
                                                                std::uint8_t* clear) {
  const Pyramid own = pyramid;  // what is written might be anything
  const auto [towards, a, b] = middles;
  for (std::size_t i = 0; i < count; ++i)
    clear[i] = std::uint8_t(own.clear_of(towards[i], a[i], b[i], radii[i]));
}

void Shadow::clear_of(const Balls& balls, std::span<std::uint8_t> clear) const {
  const auto along = [&](std::size_t i) { return balls.middle[std::size_t(axes_[i])].data(); };
  clear_of(pyramid_, {along(0), along(1), along(2)}, balls.radius.data(), balls.size(), clear.data());
}

}  // namespace relume
