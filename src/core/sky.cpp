// SPDX-License-Identifier: MIT
#include "core/sky.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace relume {
namespace {

struct CellPlace {
  std::uint32_t face = 0;
  std::uint32_t row = 0;
  std::uint32_t column = 0;
};

/// Angle of the warped coordinate at the lower edge of cell `index`; index = resolution gives the upper edge
/// of the last.
double edge_angle(double index, std::uint32_t resolution) {
  return (2.0 * index / resolution - 1.0) * kPi / 4.0;
}

CellPlace place_of(std::uint32_t cell, std::uint32_t resolution) {
  const std::uint32_t face = cell / (resolution * resolution);
  return {face, cell / resolution % resolution, cell % resolution};
}

/// Solid angle of the part of a face at distance 1 that lies below x and y, counted from the centre of the
/// face.
double corner_solid_angle(double x, double y) {
  return std::atan2(x * y, std::sqrt(x * x + y * y + 1.0));
}

/// Sums of radiance x solid angle, and of solid angle, per cell of the whole sphere.
struct CellSums {
  std::vector<Rgb> flux;
  std::vector<double> solid_angle;
};

/// How often a pixel is cut in each direction so that a cell is at least 16 parts high.
std::uint32_t parts_per_pixel(const EquirectangularSky& sky, std::uint32_t resolution) {
  return std::max(1u, (32 * resolution + sky.height - 1) / sky.height);
}

/// Adds one row of pixel parts, at the height `theta` (from +Y) and with the solid angle `part` each.
void add_row(const EquirectangularSky& sky, std::uint32_t y, double theta, double part, std::uint32_t parts,
             const SkyCells& cells, CellSums& sums) {
  const std::uint32_t count = sky.width * parts;
  for (std::uint32_t k = 0; k < count; ++k) {
    // The centre column is -Z, +X is to the right of it.
    const double phi = ((k + 0.5) / count - 0.5) * 2.0 * kPi;
    const glm::dvec3 direction(std::sin(theta) * std::sin(phi), std::cos(theta),
                               -std::sin(theta) * std::cos(phi));
    const std::uint32_t cell = cells.of(direction);
    sums.flux[cell] += part * Rgb(sky.radiance[std::size_t{y} * sky.width + k / parts]);
    sums.solid_angle[cell] += part;
  }
}

CellSums integrate(const EquirectangularSky& sky, std::uint32_t resolution) {
  const std::size_t cells = std::size_t{6} * resolution * resolution;
  CellSums sums{std::vector<Rgb>(cells, Rgb(0.0)), std::vector<double>(cells, 0.0)};
  if (sky.width == 0 || sky.height == 0) return sums;
  const std::uint32_t parts = parts_per_pixel(sky, resolution);
  const std::uint32_t rows = sky.height * parts;
  const SkyCells cell_index(resolution);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const double top = kPi * row / rows;
    const double bottom = kPi * (row + 1) / rows;
    const double part = (std::cos(top) - std::cos(bottom)) * 2.0 * kPi / (sky.width * parts);
    add_row(sky, row / parts, (top + bottom) / 2.0, part, parts, cell_index, sums);
  }
  return sums;
}

/// Through s = (a + 1) / 2, t = (b + 1) / 2 of a face of a cube map.
glm::dvec3 cube_direction(std::uint32_t face, double a, double b) {
  switch (face) {
    case 0:
      return {1.0, -b, -a};
    case 1:
      return {-1.0, -b, a};
    case 2:
      return {a, 1.0, b};
    case 3:
      return {a, -1.0, -b};
    case 4:
      return {a, -b, 1.0};
    default:
      return {-a, -b, -1.0};
  }
}

CellSums integrate(const CubeSky& sky, std::uint32_t resolution) {
  const std::size_t cells = std::size_t{6} * resolution * resolution;
  CellSums sums{std::vector<Rgb>(cells, Rgb(0.0)), std::vector<double>(cells, 0.0)};
  const std::uint32_t parts = std::max(1u, (16 * resolution + sky.size - 1) / sky.size);
  const std::uint32_t edge = sky.size * parts;
  const SkyCells cell_index(resolution);
  for (std::uint32_t face = 0; face < 6; ++face) {
    for (std::uint32_t k = 0; k < edge * edge; ++k) {
      const std::uint32_t row = k / edge, column = k % edge;
      const glm::dvec3 direction =
          cube_direction(face, 2.0 * (column + 0.5) / edge - 1.0, 2.0 * (row + 0.5) / edge - 1.0);
      const double part = std::pow(glm::dot(direction, direction), -1.5);
      const std::uint32_t cell = cell_index.of(direction);
      const std::size_t pixel = (std::size_t{face} * sky.size + row / parts) * sky.size + column / parts;
      sums.flux[cell] += part * Rgb(sky.radiance[pixel]);
      sums.solid_angle[cell] += part;
    }
  }
  return sums;
}

std::vector<Rgb> cell_means(const CellSums& sums, const std::vector<std::uint32_t>& cells) {
  std::vector<Rgb> radiosity;
  radiosity.reserve(cells.size());
  for (const std::uint32_t cell : cells) {
    const double solid_angle = sums.solid_angle[cell];
    const Rgb mean = solid_angle > 0.0 ? sums.flux[cell] / solid_angle : Rgb(0.0);
    radiosity.push_back(exitance_from_radiance(mean));
  }
  return radiosity;
}

}  // namespace

SkyCells::SkyCells(std::uint32_t resolution) {
  for (std::uint32_t i = 1; i < resolution; ++i) edges_.push_back(float(std::tan(edge_angle(i, resolution))));
}

glm::dvec3 sky_cell_direction(std::uint32_t cell, std::uint32_t resolution) {
  const CellPlace place = place_of(cell, resolution);
  const double x = std::tan(edge_angle(place.column + 0.5, resolution));
  const double y = std::tan(edge_angle(place.row + 0.5, resolution));
  const double sign = place.face % 2 == 0 ? 1.0 : -1.0;
  const glm::dvec3 on_face = place.face < 2   ? glm::dvec3(sign, y, x)
                             : place.face < 4 ? glm::dvec3(x, sign, y)
                                              : glm::dvec3(x, y, sign);
  return glm::normalize(on_face);
}

double sky_cell_solid_angle(std::uint32_t cell, std::uint32_t resolution) {
  const CellPlace place = place_of(cell, resolution);
  const double x0 = std::tan(edge_angle(place.column, resolution));
  const double x1 = std::tan(edge_angle(place.column + 1.0, resolution));
  const double y0 = std::tan(edge_angle(place.row, resolution));
  const double y1 = std::tan(edge_angle(place.row + 1.0, resolution));
  return corner_solid_angle(x1, y1) - corner_solid_angle(x0, y1) - corner_solid_angle(x1, y0) +
         corner_solid_angle(x0, y0);
}

std::vector<Rgb> sky_radiosity(const Sky& sky, const std::vector<std::uint32_t>& cells,
                               std::uint32_t resolution) {
  if (const Rgb* radiance = std::get_if<Rgb>(&sky)) {
    return std::vector<Rgb>(cells.size(), exitance_from_radiance(*radiance));
  }
  if (cells.empty()) return {};
  return cell_means(integrate(std::get<EquirectangularSky>(sky), resolution), cells);
}

std::vector<Rgb> sky_radiosity(const CubeSky& sky, const std::vector<std::uint32_t>& cells,
                               std::uint32_t resolution) {
  if (cells.empty() || sky.size == 0) return std::vector<Rgb>(cells.size(), Rgb(0.0));
  return cell_means(integrate(sky, resolution), cells);
}

}  // namespace relume
