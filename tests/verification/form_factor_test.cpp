// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/reference_solver.h"
#include "support/matrices.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

PrecomputeOptions options(double cluster_size, double texel_size, std::uint32_t quality,
                          ValueCodec codec = ValueCodec::f32) {
  PrecomputeOptions result;
  result.cluster_size = cluster_size;
  result.texel_size = texel_size;
  result.quality = quality;
  result.codec = codec;
  return result;
}

double row_sum(const CsrMatrix& matrix, std::uint32_t row) {
  return std::accumulate(matrix.values.begin() + std::ptrdiff_t(matrix.row_offsets[row]),
                         matrix.values.begin() + std::ptrdiff_t(matrix.row_offsets[row + 1]), 0.0);
}

TEST(CubeFormFactors, AreThoseOfTheCatalogue) {
  const Model model = precompute_or_throw(unit_cube(), options(0.25, 0.0625, 16384));
  const CsrMatrix bounce = reference_bounce_matrix(model).rows;
  std::vector<const Cluster*> clusters;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) clusters.push_back(&cluster);
  }
  DenseMatrix faces(6, std::vector<double>(6, 0.0));
  for (std::uint32_t i = 0; i < bounce.rows; ++i) {
    for (auto k = bounce.row_offsets[i]; k < bounce.row_offsets[i + 1]; ++k) {
      faces[clusters[i]->node][clusters[bounce.column_indices[k]]->node] +=
          clusters[i]->area * bounce.values[k];
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      const double expected = i == j ? 0.0 : (j == (i ^ 1u) ? kCubeOpposite : kCubeAdjacent);
      EXPECT_NEAR(faces[i][j], expected, 1e-4) << "from face " << i << " to face " << j;
    }
  }
}

struct RoomCase {
  const char* name;
  Scene scene;
  double cluster_size;
};

std::vector<RoomCase> closed_rooms() {
  return {{"box", box_room({}), 0.5},
          {"L", l_room({}), 0.5},
          {"sphere", sphere_room(16, 2.0, {}, {}), 0.3},
          {"sphere with a lamp", sphere_room(16, 0.9, {}, {0.5, 1.0}), 0.3}};
}

class RowSums : public testing::TestWithParam<ValueCodec> {};

TEST_P(RowSums, OfClosedRoomsAreOneAndNeverAbove) {
  for (const RoomCase& room : closed_rooms()) {
    const Model model =
        precompute_or_throw(room.scene, options(room.cluster_size, room.cluster_size / 2, 128, GetParam()));
    EXPECT_TRUE(model.sky_cells.empty()) << room.name;
    const ReferenceMatrices matrices = reference_matrices(model);
    for (const CsrMatrix* matrix : {&matrices.bounce.rows, &matrices.gather.rows}) {
      for (std::uint32_t row = 0; row < matrix->rows; ++row) {
        const double sum = row_sum(*matrix, row);
        ASSERT_LE(sum, 1.0) << room.name << " row " << row;
        // A row of n f32 shares of rays, each rounded by 2^-25 of itself at most, then scaled by an f32.
        ASSERT_GE(sum, 1.0 - 4.0 * 0x1p-24) << room.name << " row " << row;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, RowSums, testing::Values(ValueCodec::f32, ValueCodec::unorm16),
                         [](const auto& codec) {
                           return codec.param == ValueCodec::f32 ? "f32" : "unorm16";
                         });

/// Of one pair of clusters: A_i K_ij - A_j K_ji over its standard error, as if the rays were independent, and
/// how many hits were to be expected on the side that expects fewer.
struct ReciprocityError {
  double in_standard_errors = 0.0;
  double expected_hits = 0.0;
};

std::vector<ReciprocityError> reciprocity_errors(const Model& model, std::uint32_t quality) {
  std::vector<double> area, rays;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) {
      area.push_back(cluster.area);
      double squares = 0.0;
      for (std::uint32_t e = 0; e < cluster.element_count; ++e)
        squares += std::pow(double(system.elements[cluster.first_element + e].area), 2.0);
      // Elements have equally many rays: as many equal rays of the whole as give the same variance.
      rays.push_back(quality * double(cluster.area) * cluster.area / squares);
    }
  }
  const DenseMatrix k = to_dense(reference_bounce_matrix(model).rows);
  std::vector<ReciprocityError> errors;
  for (std::size_t i = 0; i < area.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double flux_ij = area[i] * k[i][j], flux_ji = area[j] * k[j][i];
      const double weight_i = rays[i] / (area[i] * area[i]), weight_j = rays[j] / (area[j] * area[j]);
      const double flux = (flux_ij * weight_i + flux_ji * weight_j) / (weight_i + weight_j);
      if (flux == 0.0) continue;
      const auto variance = [&](std::size_t from) {
        const double f = std::min(1.0, flux / area[from]);
        return area[from] * area[from] * f * (1.0 - f) / rays[from];
      };
      errors.push_back({(flux_ij - flux_ji) / std::sqrt(variance(i) + variance(j)),
                        flux * std::min(rays[i] / area[i], rays[j] / area[j])});
    }
  }
  return errors;
}

void expect_reciprocity(const Scene& scene, double cluster_size) {
  const Model model = precompute_or_throw(scene, options(cluster_size, cluster_size / 2, 1024));
  double squares = 0.0;
  std::size_t frequent = 0;
  const auto errors = reciprocity_errors(model, 1024);
  for (const ReciprocityError& error : errors) {
    squares += error.in_standard_errors * error.in_standard_errors;
    // Standard errors say nothing about events that are hardly ever seen.
    if (error.expected_hits < 5.0) continue;
    ++frequent;
    EXPECT_LE(std::abs(error.in_standard_errors), 4.0);
  }
  EXPECT_GT(frequent, 1000u);
  EXPECT_LE(std::sqrt(squares / double(errors.size())), 1.0);
}

TEST(Reciprocity, HoldsInACubeWithinTheNoiseOfTheRays) {
  expect_reciprocity(unit_cube(), 0.25);
}

TEST(Reciprocity, HoldsInAFurnishedRoomWithinTheNoiseOfTheRays) {
  expect_reciprocity(furnished_room({}), 0.5);
}

}  // namespace
}  // namespace relume::test
