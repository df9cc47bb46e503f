// SPDX-License-Identifier: MIT
#include "core/block_matrix.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/value_codec.h"

namespace relume {
namespace {

struct EncodedRow {
  std::vector<std::uint16_t> columns;
  std::vector<std::byte> values;
  std::vector<double> unscaled;  ///< what the stored codes stand for
  float scale = 1.0f;
};

float round_down_to_float(double value) {
  const float rounded = static_cast<float>(value);
  return static_cast<double>(rounded) > value ? std::nextafter(rounded, 0.0f) : rounded;
}

template <class Code>
void push_code(EncodedRow& row, std::uint16_t column, Code code, double unscaled) {
  const std::size_t offset = row.values.size();
  row.columns.push_back(column);
  row.values.resize(offset + sizeof code);
  std::memcpy(row.values.data() + offset, &code, sizeof code);
  row.unscaled.push_back(unscaled);
}

void push_value(EncodedRow& row, ValueCodec codec, std::uint16_t column, double value, double row_max) {
  if (codec == ValueCodec::f32) {
    const float stored = static_cast<float>(value);
    if (stored >= std::numeric_limits<float>::min()) push_code(row, column, stored, stored);
  } else if (codec == ValueCodec::unorm16) {
    const auto code = static_cast<std::uint16_t>(std::lround(value / row_max * kUnorm16Max));
    if (code > 0) push_code(row, column, code, code / kUnorm16Max);
  } else {
    const auto code = static_cast<std::uint8_t>(std::lround(std::sqrt(value / row_max) * kSqrt8Max));
    const double root = code / kSqrt8Max;
    if (code > 0) push_code(row, column, code, root * root);
  }
}

/// The larger of the sums of the row decoded in double and in f32.
double decoded_sum(const EncodedRow& row, float scale) {
  double in_double = 0.0;
  double in_float = 0.0;
  for (const double value : row.unscaled) {
    in_double += value * scale;
    in_float += static_cast<float>(value) * scale;
  }
  return std::max(in_double, in_float);
}

/// The largest scale (for f32: at most 1) whose decoded sum stays at or below `target`.
float repaired_scale(const EncodedRow& row, ValueCodec codec, double target) {
  if (row.columns.empty()) return 1.0f;
  if (codec == ValueCodec::f32 && decoded_sum(row, 1.0f) <= target) return 1.0f;
  float scale = round_down_to_float(target / std::accumulate(row.unscaled.begin(), row.unscaled.end(), 0.0));
  while (scale > 0.0f && decoded_sum(row, scale) > target) scale = std::nextafter(scale, 0.0f);
  return scale;
}

EncodedRow encode_row(std::span<const std::uint16_t> columns, std::span<const double> values,
                      ValueCodec codec) {
  EncodedRow row;
  const double row_max = values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  if (row_max < std::numeric_limits<float>::min()) return row;
  for (std::size_t k = 0; k < columns.size(); ++k) push_value(row, codec, columns[k], values[k], row_max);
  const double target = std::min(1.0, std::accumulate(values.begin(), values.end(), 0.0));
  row.scale = repaired_scale(row, codec, target);
  return row;
}

std::size_t row_bytes(const EncodedRow& row) {
  return sizeof(std::uint32_t) + row.columns.size() * sizeof(std::uint16_t) + row.values.size() +
         sizeof(float);
}

}  // namespace

std::size_t value_bytes(ValueCodec codec) {
  switch (codec) {
    case ValueCodec::f32:
      return 4;
    case ValueCodec::unorm16:
      return 2;
    case ValueCodec::sqrt8:
      return 1;
  }
  return 0;
}

std::size_t block_bytes(const MatrixBlock& block) {
  return block.tile_offsets.size() * sizeof(std::uint32_t) + block.columns.size() * sizeof(std::uint16_t) +
         block.values.size() + block.row_scales.size() * sizeof(float);
}

BlockMatrixBuilder::BlockMatrixBuilder(std::uint32_t columns, ValueCodec codec, std::size_t max_block_bytes)
    : codec_(codec), max_block_bytes_(max_block_bytes) {
  matrix_.columns = columns;
}

void BlockMatrixBuilder::append_row(std::span<const std::uint16_t> columns, std::span<const double> values) {
  assert(columns.size() == values.size());
  const EncodedRow row = encode_row(columns, values, codec_);
  const bool full =
      matrix_.blocks.empty() || block_bytes(matrix_.blocks.back()) + row_bytes(row) > max_block_bytes_;
  if (full) {
    MatrixBlock& fresh = matrix_.blocks.emplace_back();
    fresh.first_row = matrix_.rows;
    fresh.codec = codec_;
    fresh.tile_offsets.push_back(0);
  }
  MatrixBlock& block = matrix_.blocks.back();
  block.columns.insert(block.columns.end(), row.columns.begin(), row.columns.end());
  block.values.insert(block.values.end(), row.values.begin(), row.values.end());
  block.tile_offsets.push_back(static_cast<std::uint32_t>(block.columns.size()));
  block.row_scales.push_back(row.scale);
  ++block.row_count;
  ++matrix_.rows;
}

BlockMatrix BlockMatrixBuilder::finish() && {
  return std::move(matrix_);
}

CsrMatrix decode(const BlockMatrix& matrix) {
  CsrMatrix csr;
  csr.rows = matrix.rows;
  csr.columns = matrix.columns;
  csr.row_offsets.push_back(0);
  for (const MatrixBlock& block : matrix.blocks) {
    for (std::uint32_t row = 0; row < block.row_count; ++row) {
      const std::uint32_t tile = row / block.tile_rows;
      const std::uint32_t lane = row % block.tile_rows;
      for (std::uint32_t entry = block.tile_offsets[tile]; entry < block.tile_offsets[tile + 1]; ++entry) {
        const std::size_t index = std::size_t{entry} * block.tile_rows + lane;
        const double value = unscaled_value(block.codec, block.values, index) * block.row_scales[row];
        if (value == 0.0) continue;
        csr.column_indices.push_back(block.columns[entry]);
        csr.values.push_back(value);
      }
      csr.row_offsets.push_back(csr.values.size());
    }
  }
  return csr;
}

MatrixSummary summarise(const BlockMatrix& matrix) {
  MatrixSummary summary;
  summary.rows = matrix.rows;
  summary.columns = matrix.columns;
  for (const MatrixBlock& block : matrix.blocks) summary.bytes += block_bytes(block);
  const CsrMatrix csr = decode(matrix);
  summary.nonzeros = csr.values.size();
  for (std::uint32_t row = 0; row < csr.rows; ++row) {
    const auto begin = csr.values.begin() + static_cast<std::ptrdiff_t>(csr.row_offsets[row]);
    const auto end = csr.values.begin() + static_cast<std::ptrdiff_t>(csr.row_offsets[row + 1]);
    summary.max_row_sum = std::max(summary.max_row_sum, std::accumulate(begin, end, 0.0));
  }
  return summary;
}

}  // namespace relume
