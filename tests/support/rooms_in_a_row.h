// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "support/scene_builder.h"

namespace relume::test {

/// Rooms of the given lengths in a row along x, 3 m wide and high, closed but for a door, 1 m wide and 3 m
/// high, in each wall of 0.2 m between two of them. Surfaces are nodes "room0/floor" and so on, those of
/// doors "door0/floor".
inline Scene rooms_in_a_row(const std::vector<double>& lengths, double albedo = 0.5) {
  SceneBuilder b;
  const auto paint = b.material("paint", Rgb(albedo));
  using P = glm::dvec3;
  const auto add_tube = [&](const std::string& name, double x0, double x1, double width) {
    b.add_quad(name + "/floor", paint, {P(x0, 0, 0), P(x0, 0, width), P(x1, 0, width), P(x1, 0, 0)});
    b.add_quad(name + "/ceiling", paint, {P(x0, 3, 0), P(x1, 3, 0), P(x1, 3, width), P(x0, 3, width)});
    b.add_quad(name + "/near", paint, {P(x0, 0, 0), P(x1, 0, 0), P(x1, 3, 0), P(x0, 3, 0)});
    b.add_quad(name + "/far", paint, {P(x1, 0, width), P(x0, 0, width), P(x0, 3, width), P(x1, 3, width)});
  };
  double x0 = 0.0;
  for (std::size_t r = 0; r < lengths.size(); ++r) {
    const double x1 = x0 + lengths[r];
    const std::string number = std::to_string(r);
    add_tube("room" + number, x0, x1, 3.0);
    const bool last = r + 1 == lengths.size();
    const double before = r == 0 ? 0.0 : 1.0, after = last ? 0.0 : 1.0;
    b.add_quad("room" + number + "/-x", paint,
               {P(x0, 0, 3), P(x0, 0, before), P(x0, 3, before), P(x0, 3, 3)});
    b.add_quad("room" + number + "/+x", paint, {P(x1, 0, after), P(x1, 0, 3), P(x1, 3, 3), P(x1, 3, after)});
    if (!last) add_tube("door" + number, x1, x1 + 0.2, 1.0);
    x0 = x1 + 0.2;
  }
  return b.scene();
}

}  // namespace relume::test
