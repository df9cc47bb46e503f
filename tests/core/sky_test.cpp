// SPDX-License-Identifier: MIT
#include "core/sky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

namespace relume {
namespace {

std::vector<std::uint32_t> all_cells(std::uint32_t resolution) {
  std::vector<std::uint32_t> cells(6 * resolution * resolution);
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) cells[cell] = cell;
  return cells;
}

TEST(Sky, SolidAnglesOfAllCellsSumToTheSphere) {
  for (const std::uint32_t resolution : {1u, 2u, 7u, 32u}) {
    double sum = 0.0;
    for (const std::uint32_t cell : all_cells(resolution)) sum += sky_cell_solid_angle(cell, resolution);
    EXPECT_NEAR(sum, 4.0 * kPi, 1e-11) << resolution;
  }
  EXPECT_NEAR(sky_cell_solid_angle(3, 1), 4.0 * kPi / 6.0, 1e-14);
}

TEST(Sky, SolidAnglesAreTheShareOfRandomDirections) {
  // 10^6 directions in 24 cells: a share has a standard error below 0.02 %; 5 of them are 1e-3.
  constexpr std::uint32_t kResolution = 2;
  constexpr int kCount = 1000000;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> share(6 * kResolution * kResolution, 0.0);
  const SkyCells cells(kResolution);
  for (int k = 0; k < kCount; ++k) {
    share[cells.of({normal(random), normal(random), normal(random)})] += 1.0 / kCount;
  }
  for (std::uint32_t cell = 0; cell < share.size(); ++cell) {
    EXPECT_NEAR(share[cell], sky_cell_solid_angle(cell, kResolution) / (4.0 * kPi), 1e-3) << cell;
  }
}

TEST(Sky, CellsDifferLittleInSolidAngle) {
  double smallest = 10.0;
  double largest = 0.0;
  for (const std::uint32_t cell : all_cells(16)) {
    smallest = std::min(smallest, sky_cell_solid_angle(cell, 16));
    largest = std::max(largest, sky_cell_solid_angle(cell, 16));
  }
  // After the tan warp the density of solid angle is 1 in the middle of a face, 4 / 3^1.5 = 0.77 in its
  // corners and, lowest, 2 / 2^1.5 = 0.707 in the middle of its edges.
  EXPECT_LT(largest / smallest, 1.42);
}

TEST(Sky, DirectionOfACellLeadsBackToIt) {
  for (const std::uint32_t resolution : {1u, 3u, 16u}) {
    for (const std::uint32_t cell : all_cells(resolution)) {
      const glm::dvec3 direction = sky_cell_direction(cell, resolution);
      EXPECT_NEAR(glm::length(direction), 1.0, 1e-14);
      EXPECT_EQ(SkyCells(resolution).of(direction), cell);
      EXPECT_EQ(SkyCells(resolution).of(direction * 1e-3), cell) << "directions need not be unit";
    }
  }
}

TEST(Sky, FacesStandAsDocumented) {
  EXPECT_EQ(SkyCells(1).of({1, 0.1, 0.1}), 0u);
  EXPECT_EQ(SkyCells(1).of({-1, 0.1, 0.1}), 1u);
  EXPECT_EQ(SkyCells(1).of({0.1, 1, 0.1}), 2u);
  EXPECT_EQ(SkyCells(1).of({0.1, -1, 0.1}), 3u);
  EXPECT_EQ(SkyCells(1).of({0.1, 0.1, 1}), 4u);
  EXPECT_EQ(SkyCells(1).of({0.1, 0.1, -1}), 5u);
  // Of face +X, columns run along z and rows along y: (row 0, column 1) of 2 x 2 has y < 0 and z > 0.
  EXPECT_EQ(SkyCells(2).of({1, -0.5, 0.5}), 1u);
  // Of face -Y, columns run along x and rows along z.
  EXPECT_EQ(SkyCells(2).of({0.5, -1, -0.5}), 3u * 4 + 1);
  // Of face +Z, columns run along x and rows along y.
  EXPECT_EQ(SkyCells(2).of({-0.5, 0.5, 1}), 4u * 4 + 2);
}

TEST(Sky, CornersAndEdgesFallIntoSomeCell) {
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) EXPECT_LT(SkyCells(5).of({x, y, z}), 150u);
    }
  }
}

EquirectangularSky black_image(std::uint32_t width, std::uint32_t height) {
  return {width, height, std::vector<glm::vec3>(std::size_t{width} * height, glm::vec3(0.0f))};
}

/// The cell that receives most of one bright pixel.
std::uint32_t cell_of_pixel(std::uint32_t x, std::uint32_t y) {
  EquirectangularSky image = black_image(64, 32);
  image.radiance[y * 64 + x] = glm::vec3(1.0f);
  const std::vector<Rgb> radiosity = sky_radiosity(image, all_cells(1), 1);
  const auto brightest = std::max_element(radiosity.begin(), radiosity.end(),
                                          [](const Rgb& a, const Rgb& b) { return a.x < b.x; });
  return static_cast<std::uint32_t>(brightest - radiosity.begin());
}

TEST(Sky, EquirectangularImagesAreTheRightWayRound) {
  EXPECT_EQ(cell_of_pixel(10, 0), 2u) << "row 0 is +Y";
  EXPECT_EQ(cell_of_pixel(10, 31), 3u) << "the last row is -Y";
  EXPECT_EQ(cell_of_pixel(32, 16), 5u) << "the centre is -Z";
  EXPECT_EQ(cell_of_pixel(48, 16), 0u) << "+X is to its right";
  EXPECT_EQ(cell_of_pixel(16, 16), 1u) << "-X is to its left";
  EXPECT_EQ(cell_of_pixel(0, 16), 4u) << "the edges are +Z";
  EXPECT_EQ(cell_of_pixel(63, 16), 4u);
}

/// The cell of a quarter of the sphere's eighths that one bright pixel of a face of 2 x 2 lights, as the
/// signs of its direction.
glm::dvec3 signs_of_texel(std::uint32_t face, std::uint32_t row, std::uint32_t column) {
  CubeSky cube{2, std::vector<glm::vec3>(24, glm::vec3(0.0f))};
  cube.radiance[(face * 2 + row) * 2 + column] = glm::vec3(1.0f);
  const std::vector<Rgb> radiosity = sky_radiosity(cube, all_cells(2), 2);
  const auto brightest = std::max_element(radiosity.begin(), radiosity.end(),
                                          [](const Rgb& a, const Rgb& b) { return a.x < b.x; });
  EXPECT_NEAR(brightest->x, kPi, 1e-12) << "a texel covers one cell exactly";
  return glm::sign(sky_cell_direction(static_cast<std::uint32_t>(brightest - radiosity.begin()), 2));
}

// Table "Cube map face and coordinate selection" of the Vulkan specification: the texel at s = 0, t = 0.
TEST(Sky, FacesOfACubeMapAreTheRightWayRound) {
  EXPECT_EQ(signs_of_texel(0, 0, 0), glm::dvec3(1, 1, 1));
  EXPECT_EQ(signs_of_texel(1, 0, 0), glm::dvec3(-1, 1, -1));
  EXPECT_EQ(signs_of_texel(2, 0, 0), glm::dvec3(-1, 1, -1));
  EXPECT_EQ(signs_of_texel(3, 0, 0), glm::dvec3(-1, -1, 1));
  EXPECT_EQ(signs_of_texel(4, 0, 0), glm::dvec3(-1, 1, 1));
  EXPECT_EQ(signs_of_texel(5, 0, 0), glm::dvec3(1, 1, -1));
  EXPECT_EQ(signs_of_texel(0, 1, 0), glm::dvec3(1, -1, 1)) << "rows go down";
  EXPECT_EQ(signs_of_texel(4, 0, 1), glm::dvec3(1, 1, 1)) << "+X is to the right on +Z";
}

TEST(Sky, AnEvenCubeMapIsAConstantSky) {
  const CubeSky cube{3, std::vector<glm::vec3>(54, glm::vec3(2.0f, 3.0f, 4.0f))};
  for (const Rgb& patch : sky_radiosity(cube, all_cells(5), 5)) {
    EXPECT_NEAR(patch.x, 2.0 * kPi, 1e-12);
    EXPECT_NEAR(patch.z, 4.0 * kPi, 1e-12);
  }
}

TEST(Sky, ABrightPixelKeepsItsFlux) {
  EquirectangularSky image = black_image(64, 32);
  image.radiance[5 * 64 + 20] = glm::vec3(1000.0f, 0.0f, 500.0f);
  constexpr std::uint32_t kResolution = 8;
  const std::vector<Rgb> radiosity = sky_radiosity(image, all_cells(kResolution), kResolution);
  Rgb flux(0.0);
  for (const std::uint32_t cell : all_cells(kResolution)) {
    flux += radiance_from_radiosity(radiosity[cell]) * sky_cell_solid_angle(cell, kResolution);
  }
  const double pixel = (std::cos(kPi * 5 / 32) - std::cos(kPi * 6 / 32)) * 2.0 * kPi / 64;
  // A cell is integrated over parts of which 16 make up its height, so its solid angle is met to about 1 %.
  EXPECT_NEAR(flux.x, 1000.0 * pixel, 0.01 * 1000.0 * pixel);
  EXPECT_EQ(flux.y, 0.0);
  EXPECT_NEAR(flux.z, flux.x / 2.0, 1e-9);
}

TEST(Sky, ConstantsStayExact) {
  const std::vector<Rgb> plain = sky_radiosity(Rgb(1.0, 2.0, 3.0), {0, 5}, 1);
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_NEAR(plain[1].z, 3.0 * kPi, 1e-15);
  EquirectangularSky image = black_image(16, 8);
  for (glm::vec3& radiance : image.radiance) radiance = glm::vec3(2.0f);
  for (const Rgb& radiosity : sky_radiosity(image, all_cells(4), 4))
    EXPECT_NEAR(radiosity.x, 2.0 * kPi, 1e-12);
}

TEST(Sky, MeanOfALinearGradient) {
  // L = 1 + y over the +Y face of the cube: the mean of y is (form factor of the face from its centre) * pi /
  // (4 pi / 6), with the form factor 4 / pi * sqrt(1/2) * atan(sqrt(1/2)) of a square seen from its axis
  // (Howell, B-3).
  EquirectangularSky image = black_image(256, 128);
  for (std::uint32_t y = 0; y < 128; ++y) {
    const double height = std::cos(kPi * (y + 0.5) / 128);
    for (std::uint32_t x = 0; x < 256; ++x)
      image.radiance[y * 256 + x] = glm::vec3(static_cast<float>(1.0 + height));
  }
  const double mean = 1.5 * 4.0 / kPi * std::sqrt(0.5) * std::atan(std::sqrt(0.5));
  const std::vector<Rgb> radiosity = sky_radiosity(image, all_cells(1), 1);
  // Pixels are 1.4 degrees high and constant inside: errors of second order, (0.0245)^2.
  EXPECT_NEAR(radiosity[2].x, kPi * (1.0 + mean), 1e-3 * kPi);
  EXPECT_NEAR(radiosity[3].x, kPi * (1.0 - mean), 1e-3 * kPi);
  EXPECT_NEAR(radiosity[0].x, kPi, 1e-3 * kPi);
}

TEST(Sky, NoCellsNoRadiosity) {
  EXPECT_TRUE(sky_radiosity(black_image(4, 2), {}, 0).empty());
}

}  // namespace
}  // namespace relume
