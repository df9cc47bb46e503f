// SPDX-License-Identifier: MIT
#include "core/value_slack.h"

#include <cmath>
#include <vector>

#include "core/value_codec.h"

namespace relume {
namespace {

constexpr double kFloatRounding = 0x1p-24;

struct Entry {
  std::uint32_t column;
  double unscaled;
};

/// How far the share of the row's largest value that was encoded can be from the one that its code stands
/// for.
double code_slack(ValueCodec codec, double unscaled) {
  if (codec == ValueCodec::f32) return 0.0;
  if (codec == ValueCodec::unorm16) return (unscaled <= 1.0 / kUnorm16Max ? 1.0 : 0.5) / kUnorm16Max;
  const double code = std::sqrt(unscaled) * kSqrt8Max;
  return (2.0 * code + 1.0) / (kSqrt8Max * kSqrt8Max);
}

/// How far the sum of the codes can be from that of the encoded shares.
double sum_slack(ValueCodec codec, const std::vector<Entry>& row) {
  constexpr double kSmallest = 1.0 / (kSqrt8Max * kSqrt8Max);
  double sum = codec == ValueCodec::sqrt8 ? (kSqrt8Max - 0.5) * kSmallest : 0.0;
  for (const Entry& entry : row) {
    if (codec == ValueCodec::unorm16) sum += code_slack(codec, entry.unscaled);
    if (codec == ValueCodec::sqrt8 && entry.unscaled < 1.5 * kSmallest) sum += kSmallest;
  }
  return sum;
}

void append_slack(const MatrixBlock& block, const std::vector<Entry>& row, double scale, CsrMatrix& slack) {
  double sum = 0.0;
  for (const Entry& entry : row) sum += entry.unscaled;
  const double off = sum_slack(block.codec, row);
  const double repair = off < sum ? off / (sum - off) : 1.0;
  const double rounding = (double(row.size()) + 4.0) * kFloatRounding;
  for (const Entry& entry : row) {
    const double codes = code_slack(block.codec, entry.unscaled);
    slack.column_indices.push_back(entry.column);
    slack.values.push_back(scale * (codes + (entry.unscaled + codes) * (repair + rounding)));
  }
  slack.row_offsets.push_back(slack.values.size());
}

}  // namespace

CsrMatrix decode_slack(const BlockMatrix& matrix) {
  CsrMatrix slack;
  slack.rows = matrix.rows;
  slack.columns = matrix.columns;
  slack.row_offsets.push_back(0);
  std::vector<Entry> row;
  for (const MatrixBlock& block : matrix.blocks) {
    for (std::uint32_t r = 0; r < block.row_count; ++r) {
      row.clear();
      visit_unscaled(block, r, [&](std::uint32_t column, double unscaled) {
        row.push_back({column, unscaled});
      });
      append_slack(block, row, block.row_scales[r], slack);
    }
  }
  return slack;
}

}  // namespace relume
