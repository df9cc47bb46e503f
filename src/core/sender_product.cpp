// SPDX-License-Identifier: MIT
#include "core/sender_product.h"

#include <algorithm>
#include <glm/common.hpp>

namespace relume {

Rgb row_product(const CsrMatrix& matrix, std::uint32_t row, const std::vector<Rgb>& b) {
  Rgb sum(0.0);
  for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry)
    sum += matrix.values[entry] * b[matrix.column_indices[entry]];
  return sum;
}

std::vector<Rgb> cluster_product(const SenderMatrix& matrix, const std::vector<Rgb>& x) {
  std::vector<Rgb> b = x;
  b.resize(matrix.rows.columns - matrix.nodes.rows, Rgb(0.0));
  for (std::uint32_t node = 0; node < matrix.nodes.rows; ++node)
    b.push_back(row_product(matrix.nodes, node, b));
  std::vector<Rgb> product(matrix.rows.rows);
  for (std::uint32_t row = 0; row < product.size(); ++row) product[row] = row_product(matrix.rows, row, b);
  return product;
}

std::uint64_t longest_row(const CsrMatrix& matrix) {
  std::uint64_t longest = 0;
  for (std::uint32_t row = 0; row < matrix.rows; ++row)
    longest = std::max(longest, matrix.row_offsets[row + 1] - matrix.row_offsets[row]);
  return longest;
}

Rgb largest(const std::vector<Rgb>& values) {
  Rgb result(0.0);
  for (const Rgb& value : values) result = glm::max(result, value);
  return result;
}

}  // namespace relume
