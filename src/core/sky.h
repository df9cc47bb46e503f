// SPDX-License-Identifier: MIT
//
// The sky as senders: the sphere of directions cut into 6 x n x n sky patches, cells of a cube map whose face
// coordinates are warped by tan (so that cells differ little in solid angle). Face order +X, -X, +Y, -Y, +Z,
// -Z. With u, v in [-1, 1] after the warp (x = tan(u pi/4), y = tan(v pi/4)) the direction is the normalised
//   +X (1, y, x)  -X (-1, y, x)  +Y (x, 1, y)  -Y (x, -1, y)  +Z (x, y, 1)  -Z (x, y, -1)
// Cell index = (face * n + row) * n + column, row along v, column along u.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/quantities.h"
#include "core/result.h"

namespace relume {

/// Finds the cells of directions, in single precision. Made once for many of them: edges are compared with,
/// for rays have no time for arc tangents.
class SkyCells {
 public:
  /// `resolution` is n >= 1.
  explicit SkyCells(std::uint32_t resolution);
  /// Index of the cell that a direction falls into; it need not be unit, but not 0.
  std::uint32_t of(const glm::dvec3& direction) const {
    std::array<std::uint32_t, 1> cell;
    of<1>({float(direction.x)}, {float(direction.y)}, {float(direction.z)}, cell);
    return cell[0];
  }
  /// The same of many; without branches, so that lanes go together.
  template <std::size_t kLanes>
  [[gnu::always_inline]] void of(const std::array<float, kLanes>& x, const std::array<float, kLanes>& y,
                                 const std::array<float, kLanes>& z,
                                 std::array<std::uint32_t, kLanes>& cells) const {
    std::array<float, kLanes> u, v, face, row{}, column{};  // numbers, for vector units keep to one type
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float a = std::abs(x[lane]), b = std::abs(y[lane]), c = std::abs(z[lane]);
      const bool on_y = b > a, on_z = c > (on_y ? b : a);
      const float along = on_z ? z[lane] : on_y ? y[lane] : x[lane];
      const float scale = 1.0f / std::abs(along);
      u[lane] = scale * (on_z || on_y ? x[lane] : z[lane]);
      v[lane] = scale * (on_y && !on_z ? z[lane] : y[lane]);
      face[lane] = (on_z ? 4.0f : on_y ? 2.0f : 0.0f) + (along < 0.0f ? 1.0f : 0.0f);
    }
    for (const float edge : edges_) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) column[lane] += u[lane] >= edge ? 1.0f : 0.0f;
      for (std::size_t lane = 0; lane < kLanes; ++lane) row[lane] += v[lane] >= edge ? 1.0f : 0.0f;
    }
    const float n = float(edges_.size() + 1);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      cells[lane] = std::uint32_t(std::int32_t((face[lane] * n + row[lane]) * n + column[lane]));
  }

 private:
  std::vector<float> edges_;  ///< tangents where one cell ends and the next begins
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
