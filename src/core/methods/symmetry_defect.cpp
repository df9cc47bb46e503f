// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/methods/methods.h"

namespace relume {
namespace {

/// Value of a column of one row, 0 where it is not stored.
double value_at(const CsrMatrix& rows, std::uint32_t row, std::uint32_t column) {
  const auto first = rows.column_indices.begin() + static_cast<std::ptrdiff_t>(rows.row_offsets[row]);
  const auto last = rows.column_indices.begin() + static_cast<std::ptrdiff_t>(rows.row_offsets[row + 1]);
  const auto found = std::lower_bound(first, last, column);
  if (found == last || *found != column) return 0.0;
  return rows.values[static_cast<std::size_t>(found - rows.column_indices.begin())];
}

}  // namespace

double symmetry_defect(const CsrMatrix& rows, const std::vector<double>& areas) {
  double apart = 0.0, all = 0.0;
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    for (std::uint64_t entry = rows.row_offsets[row]; entry < rows.row_offsets[row + 1]; ++entry) {
      const std::uint32_t column = rows.column_indices[entry];
      if (column >= rows.rows) continue;
      const double there = areas[row] * rows.values[entry];
      const double back = areas[column] * value_at(rows, column, row);
      // A pair of which one side is not stored is met once only.
      apart += std::abs(there - back) * (back == 0.0 ? 2.0 : 1.0);
      all += there;
    }
  }
  return all > 0.0 ? apart / all : 0.0;
}

}  // namespace relume
