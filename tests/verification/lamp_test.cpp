// SPDX-License-Identifier: MIT
//
// A lamp of 0.3 m on a ceiling 2.5 m high: hemisphere rays alone would meet it a few times in a thousand.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reference_solver.h"
#include "precompute/precompute.h"
#include "verification/closed_forms.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

constexpr double kSize = 0.3;
constexpr double kTexel = 0.125;  ///< divides the room
constexpr std::uint32_t kRays = 1024;

double to_lamp(const glm::dvec3& point, const glm::dvec3& normal) {
  const double low = 2.0 - kSize / 2, high = 2.0 + kSize / 2, y = 2.499;
  const std::array<glm::dvec3, 4> lamp{
      glm::dvec3{low, y, low}, {high, y, low}, {high, y, high}, {low, y, high}};
  return element_to_polygon(point, normal, lamp);
}

/// Floor and walls, on a grid of 0.35 m; the walls end below the lamp, so that all of it is above every
/// horizon.
std::vector<SensorPoint> sensors_on_floor_and_walls() {
  std::vector<SensorPoint> sensors;
  for (double a = 0.1; a < 3.95; a += 0.35) {
    for (double b = 0.1; b < 3.95; b += 0.35) sensors.push_back({"floor", {a, 0.001, b}, {0, 1, 0}});
    for (double b = 0.1; b < 2.35; b += 0.35) {
      sensors.push_back({"-x", {0.001, b, a}, {1, 0, 0}});
      sensors.push_back({"+z", {a, b, 3.999}, {0, 0, -1}});
    }
  }
  return sensors;
}

Model lamp_model() {
  PrecomputeOptions options;
  options.cluster_size = 0.25;
  options.texel_size = kTexel;
  options.quality = kRays;
  options.sensor_quality = kRays;
  options.sensors = sensors_on_floor_and_walls();
  return precompute_or_throw(lamp_room(kSize, 0.5), options);
}

/// Sum of each gather row over the clusters of the lamp.
std::vector<double> gathered_factors(const Model& model) {
  std::vector<bool> lamp;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters)
      lamp.push_back(model.materials[cluster.material].name == "lamp");
  }
  const CsrMatrix matrix = reference_matrices(model).gather.rows;
  std::vector<double> sums(matrix.rows, 0.0);
  for (std::uint32_t row = 0; row < matrix.rows; ++row) {
    for (auto k = matrix.row_offsets[row]; k < matrix.row_offsets[row + 1]; ++k) {
      const auto sender = matrix.column_indices[k];
      if (sender < lamp.size() && lamp[sender]) sums[row] += matrix.values[k];
    }
  }
  return sums;
}

TEST(SmallLamp, FormFactorsAtSensorsAreWithinOnePercent) {
  const Model model = lamp_model();
  const auto sums = gathered_factors(model);
  const auto sensors = sensors_on_floor_and_walls();
  const std::size_t first = sums.size() - sensors.size();
  double sum = 0.0, expected_sum = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const double expected = to_lamp(sensors[i].position, sensors[i].normal);
    sum += sums[first + i];
    expected_sum += expected;
    worst = std::max(worst, std::abs(sums[first + i] / expected - 1.0));
    EXPECT_NEAR(sums[first + i], expected, 0.01 * expected)
        << sensors[i].name << ' ' << sensors[i].position.x << ' ' << sensors[i].position.y << ' '
        << sensors[i].position.z;
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_NEAR(sum, expected_sum, 1e-3 * expected_sum);
}

/// Mean over a square of `size` about `p` by the product midpoint rule; exact to 1e-4 at these distances.
double mean_to_lamp(const glm::dvec3& p, const glm::dvec3& normal, double size) {
  const glm::dvec3 u = std::abs(normal.y) > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 v = glm::cross(normal, u);
  double sum = 0.0;
  for (int i = 0; i < 16; ++i)
    sum += to_lamp(p + size * ((i % 4 - 1.5) / 4.0 * u + (i / 4 - 1.5) / 4.0 * v), normal) / 16.0;
  return sum;
}

TEST(SmallLamp, FormFactorsOfLumelsAreWithinOnePercent) {
  const Model model = lamp_model();
  const auto sums = gathered_factors(model);
  const System& system = model.systems.at(0);
  double sum = 0.0, expected_sum = 0.0;
  std::size_t checked = 0;
  for (std::size_t i = 0; i < system.lumels.size(); ++i) {
    const SurfaceElement& element = system.elements[system.lumels[i].element];
    const bool whole = element.area > 0.999 * kTexel * kTexel;
    if (!whole || element.position.y > 2.3f) continue;
    glm::dvec3 centre(0.0);
    for (std::uint32_t p = 0; p < element.piece_count; ++p) {
      const SurfacePiece& piece = system.pieces[element.first_piece + p];
      const glm::vec2 at = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3.0f;
      const glm::vec2 e1 = piece.corners[1] - piece.corners[0], e2 = piece.corners[2] - piece.corners[0];
      const auto& corners = model.occluders.triangles[piece.triangle];
      const glm::dvec3 a(model.occluders.positions[corners[0]]), b(model.occluders.positions[corners[1]]),
          c(model.occluders.positions[corners[2]]);
      const double area =
          0.5 * glm::length(glm::cross(b - a, c - a)) * std::abs(double(e1.x) * e2.y - double(e1.y) * e2.x);
      centre += area * (a * (1.0 - at.x - at.y) + b * double(at.x) + c * double(at.y));
    }
    centre /= element.area;
    const double expected = mean_to_lamp(centre, element.normal, kTexel);
    ++checked;
    sum += sums[i];
    expected_sum += expected;
    EXPECT_NEAR(sums[i], expected, 0.01 * expected) << centre.x << ' ' << centre.y << ' ' << centre.z;
  }
  EXPECT_GT(checked, 1000u);
  EXPECT_NEAR(sum, expected_sum, 1e-3 * expected_sum);
}

}  // namespace
}  // namespace relume::test
