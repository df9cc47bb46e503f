// SPDX-License-Identifier: MIT
//
// Matrices as tests like to write them: dense, by hand.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block_matrix.h"
#include "core/solve.h"

namespace relume::test {

using DenseMatrix = std::vector<std::vector<double>>;

inline CsrMatrix to_csr(const DenseMatrix& dense, std::uint32_t columns) {
  CsrMatrix matrix;
  matrix.columns = columns;
  matrix.row_offsets.push_back(0);
  for (const std::vector<double>& row : dense) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      if (row[column] == 0.0) continue;
      matrix.column_indices.push_back(column);
      matrix.values.push_back(row[column]);
    }
    matrix.row_offsets.push_back(matrix.values.size());
    ++matrix.rows;
  }
  return matrix;
}

inline DenseMatrix to_dense(const CsrMatrix& matrix) {
  DenseMatrix dense(matrix.rows, std::vector<double>(matrix.columns, 0.0));
  for (std::uint32_t row = 0; row < matrix.rows; ++row) {
    for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry) {
      dense[row][matrix.column_indices[entry]] = matrix.values[entry];
    }
  }
  return dense;
}

/// Form factors between the faces of a unit cube (J. Howell, A Catalog of Radiation Heat Transfer
/// Configuration Factors, C-11 and C-14). Faces 0 and 1, 2 and 3, 4 and 5 are opposite.
inline constexpr double kCubeOpposite = 0.199824896;
inline constexpr double kCubeAdjacent = 0.200043776;

inline CsrMatrix cube_matrix() {
  DenseMatrix dense(6, std::vector<double>(6, kCubeAdjacent));
  for (std::size_t face = 0; face < 6; ++face) {
    dense[face][face] = 0.0;
    dense[face][face ^ 1u] = kCubeOpposite;
  }
  return to_csr(dense, 6);
}

/// The same albedo and exitance everywhere, no direct light, a black sky.
inline Lighting uniform_lighting(std::size_t clusters, const Rgb& albedo, const Rgb& exitance) {
  Lighting lighting;
  lighting.albedo.assign(clusters, albedo);
  lighting.exitance.assign(clusters, exitance);
  lighting.direct.assign(clusters, Rgb(0.0));
  return lighting;
}

}  // namespace relume::test
