// SPDX-License-Identifier: MIT
#include "core/value_slack.h"

#include <algorithm>
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

/// How far the sum of codes so far can be from that of the encoded shares.
class RunningSlack {
 public:
  explicit RunningSlack(ValueCodec codec) : codec_(codec) {}

  double after(double unscaled) {
    if (codec_ == ValueCodec::unorm16) most_ += code_slack(codec_, unscaled);
    if (codec_ != ValueCodec::sqrt8) return most_;
    // The code above was taken because that left no more than half of a step too much, or since nothing but
    // zero becomes zero; the code below, because the one above it would have left more.
    constexpr double kSmallest = 1.0 / (kSqrt8Max * kSqrt8Max);
    const double code = std::sqrt(unscaled) * kSqrt8Max;
    most_ = code < 1.5 ? most_ + kSmallest : std::max(most_, (code - 0.5) * kSmallest);
    least_ = std::max(least_, (code + 0.5) * kSmallest);
    return std::max(most_, least_);
  }

 private:
  ValueCodec codec_;
  double most_ = 0.0, least_ = 0.0;  ///< too much, too little
};

void append_slack(const MatrixBlock& block, const std::vector<Entry>& row, double scale, ValueSlack& slack) {
  double sum = 0.0;
  for (const Entry& entry : row) sum += entry.unscaled;
  const double off = sum_slack(block.codec, row);
  const double repair = off < sum ? off / (sum - off) : 1.0;
  const double rounding = (double(row.size()) + 4.0) * kFloatRounding;
  RunningSlack running(block.codec);
  for (const Entry& entry : row) {
    const double codes = code_slack(block.codec, entry.unscaled);
    slack.each.column_indices.push_back(entry.column);
    slack.each.values.push_back(scale * (codes + (entry.unscaled + codes) * (repair + rounding)));
    slack.running.push_back(scale * (1.0 + repair) * (running.after(entry.unscaled) + sum * rounding));
  }
  slack.each.row_offsets.push_back(slack.each.values.size());
}

}  // namespace

ValueSlack decode_slack(const BlockMatrix& matrix) {
  ValueSlack slack;
  slack.each.rows = matrix.rows;
  slack.each.columns = matrix.columns;
  slack.each.row_offsets.push_back(0);
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
