// SPDX-License-Identifier: MIT
//
// The sky as senders: the sphere of directions cut into 6 x n x n sky patches, cells of a cube map whose face
// coordinates are warped by tan (so that cells differ little in solid angle). Face order +X, -X, +Y, -Y, +Z,
// -Z. With u, v in [-1, 1] after the warp (x = tan(u pi/4), y = tan(v pi/4)) the direction is the normalised
//   +X (1, y, x)  -X (-1, y, x)  +Y (x, 1, y)  -Y (x, -1, y)  +Z (x, y, 1)  -Z (x, y, -1)
// Cell index = (face * n + row) * n + column, row along v, column along u.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/quantities.h"
#include "core/result.h"

namespace relume {

/// Finds the cells of directions. Made once for many of them: edges are compared with, for rays have no time
/// for arc tangents.
class SkyCells {
 public:
  /// `resolution` is n >= 1.
  explicit SkyCells(std::uint32_t resolution);
  /// Index of the cell that a direction falls into; it need not be unit, but not 0.
  std::uint32_t of(const glm::dvec3& direction) const;

 private:
  std::uint32_t index_of(double tangent) const;

  std::uint32_t resolution_;
  std::vector<double> edges_;  ///< tangents where one cell ends and the next begins
};

/// Unit direction through the centre of a cell.
glm::dvec3 sky_cell_direction(std::uint32_t cell, std::uint32_t resolution);

/// Solid angle of a cell in steradian; all cells sum to 4 pi.
double sky_cell_solid_angle(std::uint32_t cell, std::uint32_t resolution);

/// Radiance image of the whole sphere, equirectangular: row 0 is +Y, the centre column is -Z, +X is to the
/// right of it.
struct EquirectangularSky {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<glm::vec3> radiance;  ///< cd/m2, row by row
};

/// Radiance images of six faces, as graphics APIs hold a cube map (Vulkan specification, Cube Map Face
/// Selection): +X, -X, +Y, -Y, +Z, -Z, each row by row from its t = 0; on +Z, s grows with +X and t
/// against +Y.
struct CubeSky {
  std::uint32_t size = 0;           ///< pixels along an edge, at least 1
  std::vector<glm::vec3> radiance;  ///< cd/m2, 6 x size x size
};

/// Either one radiance (cd/m2) from everywhere, or an image.
using Sky = std::variant<Rgb, EquirectangularSky>;

/// Mean radiance of the sky over each cell of `cells` by solid angle, times pi: what the cells send as
/// radiosity (lm/m2).
std::vector<Rgb> sky_radiosity(const Sky& sky, const std::vector<std::uint32_t>& cells,
                               std::uint32_t resolution);
/// The same of a cube map.
std::vector<Rgb> sky_radiosity(const CubeSky& sky, const std::vector<std::uint32_t>& cells,
                               std::uint32_t resolution);

}  // namespace relume
