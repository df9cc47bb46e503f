// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "precompute/box_tree.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"
#include "precompute/rows_file.h"

namespace relume {

/// A point is open when more than so large a share of the directions around it escapes, or meets backs.
inline constexpr double kMaxEscapes = 0.2, kMaxBackFaces = 0.5;

inline constexpr int kLookDirections = 64;
/// Evenly spread (R. Swinbank, R. Purser, Fibonacci Grids, 2006).
glm::vec3 sphere_direction(int i, int count);

/// Enclosed points of a grid over the scene.
struct EnclosedGrid {
  LookGrid grid;
  std::vector<PointLook> looks;        ///< per point
  std::vector<std::uint8_t> enclosed;  ///< per point

  const glm::ivec3& size() const { return grid.size; }
  glm::vec3 point(std::size_t i) const {
    const int x = int(i) % grid.size.x, y = int(i) / grid.size.x % grid.size.y,
              z = int(i) / (grid.size.x * grid.size.y);
    return grid.lower + (glm::vec3(x, y, z) + 0.5f) * grid.step;
  }
};

/// What an earlier precompute saw from the points of a grid, and boxes outside of which rays meet what they
/// met then.
struct EarlierLooks {
  const RowsFile& old;
  std::vector<Box> changed;
};

/// `earlier` may be missing; the grid is the same with it.
EnclosedGrid find_enclosed(const Geometry& geometry, const RayCaster& caster, const EarlierLooks* earlier);

}  // namespace relume
