// SPDX-License-Identifier: MIT
#include "core/methods/transposed.h"

namespace relume {

CsrMatrix transposed(const CsrMatrix& matrix) {
  CsrMatrix result;
  result.rows = matrix.columns;
  result.columns = matrix.rows;
  result.row_offsets.assign(matrix.columns + 1, 0);
  for (const std::uint32_t column : matrix.column_indices) ++result.row_offsets[column + 1];
  for (std::uint32_t row = 0; row < result.rows; ++row)
    result.row_offsets[row + 1] += result.row_offsets[row];
  result.column_indices.resize(matrix.values.size());
  result.values.resize(matrix.values.size());
  std::vector<std::uint64_t> next = result.row_offsets;
  for (std::uint32_t row = 0; row < matrix.rows; ++row) {
    for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry) {
      const std::uint64_t place = next[matrix.column_indices[entry]]++;
      result.column_indices[place] = row;
      result.values[place] = matrix.values[entry];
    }
  }
  return result;
}

}  // namespace relume
