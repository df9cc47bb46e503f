// SPDX-License-Identifier: MIT
#include "core/block_matrix.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "core/value_codec.h"

namespace relume {

struct BlockMatrixBuilder::EncodedRow {
  std::vector<std::uint32_t> codes;  ///< one per value; f32: the bits of the float
  std::vector<double> unscaled;      ///< what the codes stand for
  float scale = 1.0f;
};

/// The rows of a tile, encoded, and which of its columns any of them needs.
struct BlockMatrixBuilder::EncodedTile {
  std::vector<EncodedRow> rows;
  std::vector<std::uint32_t> entries;
};

namespace {

using EncodedRow = BlockMatrixBuilder::EncodedRow;
using EncodedTile = BlockMatrixBuilder::EncodedTile;

float round_down_to_float(double value) {
  const float rounded = static_cast<float>(value);
  return static_cast<double>(rounded) > value ? std::nextafter(rounded, 0.0f) : rounded;
}

struct Code {
  std::uint32_t code;
  double unscaled;
};

Code f32_code(double value) {
  const float stored = static_cast<float>(value);
  const float kept = stored >= std::numeric_limits<float>::min() ? stored : 0.0f;
  return {std::bit_cast<std::uint32_t>(kept), kept};
}

/// The nearest; but only zero becomes zero, so that every sender of a row can be told from its codes.
Code unorm16_code(double share) {
  const auto nearest = static_cast<std::uint32_t>(std::lround(share * kUnorm16Max));
  const std::uint32_t code = share > 0.0 ? std::max(nearest, 1u) : 0;
  return {code, code / kUnorm16Max};
}

double square(double value) {
  return value * value;
}

/// Of the two codes around `share`, the one that leaves the smaller error of the sum so far: neighbours in a
/// row make up for each other, where rounding each to the nearest would shift the balance of the row. Zero
/// stays zero, and nothing else becomes it.
Code sqrt8_code(double share, double& error) {
  if (share <= 0.0) return {0, 0.0};
  const double below = std::floor(std::sqrt(share) * kSqrt8Max);
  const double above = std::min(below + 1.0, kSqrt8Max);
  const double error_below = error + square(below / kSqrt8Max) - share;
  const double error_above = error + square(above / kSqrt8Max) - share;
  const bool up = below == 0.0 || std::abs(error_above) < std::abs(error_below);
  error = up ? error_above : error_below;
  const double code = up ? above : below;
  return {static_cast<std::uint32_t>(code), square(code / kSqrt8Max)};
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
  const double sum = std::accumulate(row.unscaled.begin(), row.unscaled.end(), 0.0);
  if (sum <= 0.0) return 1.0f;
  if (codec == ValueCodec::f32 && decoded_sum(row, 1.0f) <= target) return 1.0f;
  float scale = round_down_to_float(target / sum);
  while (scale > 0.0f && decoded_sum(row, scale) > target) scale = std::nextafter(scale, 0.0f);
  return scale;
}

void encode_row(std::span<const double> values, ValueCodec codec, EncodedRow& row) {
  row.codes.resize(values.size());
  row.unscaled.resize(values.size());
  const double row_max = values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  const bool dark = row_max < std::numeric_limits<float>::min();
  double error = 0.0, sum = 0.0, sum_of_codes = 0.0;
  const auto encode_all = [&](auto&& encode) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Code code = encode(values[i]);
      row.codes[i] = code.code;
      row.unscaled[i] = code.unscaled;
      sum += values[i], sum_of_codes += code.unscaled;
    }
  };
  if (dark || codec == ValueCodec::f32) {
    encode_all([&](double value) { return f32_code(dark ? 0.0 : value); });
  } else if (codec == ValueCodec::unorm16) {
    encode_all([&](double value) { return unorm16_code(value / row_max); });
  } else {
    encode_all([&](double value) { return sqrt8_code(value / row_max, error); });
  }
  const double target = std::min(1.0, sum);
  // Floats add up in double to the same number, decoded either way.
  const bool fits = codec == ValueCodec::f32 && sum_of_codes <= target;
  row.scale = fits ? 1.0f : repaired_scale(row, codec, target);
}

/// Whether a row of f32 is its own code: nothing vanishes, and its sum needs no repair.
bool stored_as_they_are(std::span<const float> values) {
  double sum = 0.0;
  bool normal = true;
  for (const float value : values) {
    sum += double(value);
    normal = normal && value >= std::numeric_limits<float>::min();
  }
  return normal && sum <= 1.0;
}

void encode_tile(std::size_t row_count, std::size_t column_count, std::span<const double> values,
                 ValueCodec codec, EncodedTile& tile) {
  tile.rows.resize(row_count);
  for (std::size_t row = 0; row < row_count; ++row)
    encode_row(values.subspan(row * column_count, column_count), codec, tile.rows[row]);
  tile.entries.clear();
  tile.entries.reserve(column_count);
  for (std::size_t entry = 0; entry < column_count; ++entry) {
    const auto uses = [entry](const EncodedRow& row) { return row.codes[entry] != 0; };
    if (std::any_of(tile.rows.begin(), tile.rows.end(), uses)) tile.entries.push_back(std::uint32_t(entry));
  }
}

std::size_t tile_bytes(const EncodedTile& tile, std::uint32_t tile_rows, std::size_t bytes_of_value) {
  return sizeof(std::uint32_t) + tile.entries.size() * (sizeof(std::uint16_t) + tile_rows * bytes_of_value) +
         tile.rows.size() * sizeof(float);
}

template <class Code>
void write_codes(const EncodedTile& tile, std::uint32_t tile_rows, std::byte* out) {
  static_assert(std::endian::native == std::endian::little);
  if (tile_rows == 1) {
    const std::vector<std::uint32_t>& codes = tile.rows[0].codes;
    for (std::size_t i = 0; i < tile.entries.size(); ++i) {
      const auto code = static_cast<Code>(codes[tile.entries[i]]);
      std::memcpy(out + i * sizeof code, &code, sizeof code);
    }
    return;
  }
  for (const std::uint32_t entry : tile.entries) {
    for (std::size_t lane = 0; lane < tile.rows.size(); ++lane) {
      const auto code = static_cast<Code>(tile.rows[lane].codes[entry]);
      std::memcpy(out + lane * sizeof code, &code, sizeof code);
    }
    out += tile_rows * sizeof(Code);
  }
}

/// Appends to the values of a block; the last tile is filled up with zeros.
void append_values(const EncodedTile& tile, MatrixBlock& block) {
  const std::size_t end = block.values.size();
  block.values.resize(end + tile.entries.size() * block.tile_rows * value_bytes(block.codec));
  std::byte* out = block.values.data() + end;
  if (block.codec == ValueCodec::f32) write_codes<std::uint32_t>(tile, block.tile_rows, out);
  if (block.codec == ValueCodec::unorm16) write_codes<std::uint16_t>(tile, block.tile_rows, out);
  if (block.codec == ValueCodec::sqrt8) write_codes<std::uint8_t>(tile, block.tile_rows, out);
}

/// Appends to the directions of a block, given per row and column; 0 where there is no value.
void append_directions(const EncodedTile& tile, std::span<const std::uint32_t> directions,
                       MatrixBlock& block) {
  if (directions.empty()) return;
  const std::size_t columns = directions.size() / tile.rows.size();
  std::size_t out = block.directions.size();
  block.directions.resize(out + tile.entries.size() * block.tile_rows);
  for (const std::uint32_t entry : tile.entries) {
    for (std::size_t lane = 0; lane < tile.rows.size(); ++lane) {
      if (tile.rows[lane].codes[entry] != 0)
        block.directions[out + lane] = directions[lane * columns + entry];
    }
    out += block.tile_rows;
  }
}

/// Calls visit(column, value) for the values of a row of a block that are not zero.
template <class Visit>
void visit_row(const MatrixBlock& block, std::uint32_t row, Visit&& visit) {
  visit_unscaled(block, row, [&](std::uint32_t column, double unscaled) {
    visit(column, unscaled * block.row_scales[row]);
  });
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
         block.values.size() + block.row_scales.size() * sizeof(float) +
         block.directions.size() * sizeof(std::uint32_t);
}

BlockMatrixBuilder::BlockMatrixBuilder(std::uint32_t columns, ValueCodec codec, std::size_t max_block_bytes,
                                       std::size_t entries)
    : codec_(codec),
      max_block_bytes_(max_block_bytes),
      entries_(entries),
      tile_(std::make_unique<EncodedTile>()) {
  matrix_.columns = columns;
}
BlockMatrixBuilder::BlockMatrixBuilder(BlockMatrixBuilder&&) noexcept = default;
BlockMatrixBuilder::~BlockMatrixBuilder() = default;

void BlockMatrixBuilder::append_row(std::span<const std::uint16_t> columns, std::span<const double> values,
                                    std::span<const std::uint32_t> directions) {
  append(columns, values, directions, 1, 1);
}

void BlockMatrixBuilder::append_row(std::span<const std::uint16_t> columns, std::span<const float> values,
                                    std::span<const std::uint32_t> directions) {
  if (codec_ != ValueCodec::f32 || !directions.empty() || !stored_as_they_are(values)) {
    values_.assign(values.begin(), values.end());
    append_row(columns, values_, directions);
    return;
  }
  const std::size_t bytes =
      sizeof(std::uint32_t) + sizeof(float) + values.size() * (sizeof(std::uint16_t) + value_bytes(codec_));
  MatrixBlock& block = block_for(1, bytes);
  const auto coded = std::as_bytes(values);
  block.columns.insert(block.columns.end(), columns.begin(), columns.end());
  block.values.insert(block.values.end(), coded.begin(), coded.end());
  block.tile_offsets.push_back(static_cast<std::uint32_t>(block.columns.size()));
  block.row_scales.push_back(1.0f);
  ++block.row_count, ++matrix_.rows;
}

void BlockMatrixBuilder::append_tile(std::span<const std::uint16_t> columns, std::span<const double> values,
                                     std::uint32_t row_count, std::span<const std::uint32_t> directions) {
  append(columns, values, directions, row_count, 8);
}

void BlockMatrixBuilder::append(std::span<const std::uint16_t> columns, std::span<const double> values,
                                std::span<const std::uint32_t> directions, std::uint32_t row_count,
                                std::uint32_t tile_rows) {
  assert(directions.empty() || directions.size() == values.size());
  assert(columns.size() * row_count == values.size() && row_count >= 1 && row_count <= tile_rows);
  EncodedTile& tile = *tile_;
  encode_tile(row_count, columns.size(), values, codec_, tile);
  const std::size_t bytes_of_direction = directions.empty() ? 0 : sizeof(std::uint32_t);
  MatrixBlock& block =
      block_for(tile_rows, tile_bytes(tile, tile_rows, value_bytes(codec_) + bytes_of_direction));
  const std::size_t end = block.columns.size();
  block.columns.resize(end + tile.entries.size());
  for (std::size_t i = 0; i < tile.entries.size(); ++i) block.columns[end + i] = columns[tile.entries[i]];
  append_values(tile, block);
  append_directions(tile, directions, block);
  block.tile_offsets.push_back(static_cast<std::uint32_t>(block.columns.size()));
  for (const EncodedRow& row : tile.rows) block.row_scales.push_back(row.scale);
  block.row_count += row_count;
  matrix_.rows += row_count;
}

MatrixBlock& BlockMatrixBuilder::block_for(std::uint32_t tile_rows, std::size_t bytes) {
  if (fits(tile_rows, bytes)) return matrix_.blocks.back();
  if (!matrix_.blocks.empty()) entries_ -= std::min(entries_, matrix_.blocks.back().columns.size());
  MatrixBlock& fresh = matrix_.blocks.emplace_back();
  fresh.first_row = matrix_.rows;
  fresh.tile_rows = tile_rows;
  fresh.codec = codec_;
  fresh.tile_offsets.push_back(0);
  const std::size_t bytes_of_entry = sizeof(std::uint16_t) + tile_rows * value_bytes(codec_),
                    entries = std::min(entries_, max_block_bytes_ / bytes_of_entry);
  fresh.columns.reserve(entries);
  fresh.values.reserve(entries * tile_rows * value_bytes(codec_));
  return fresh;
}

bool BlockMatrixBuilder::fits(std::uint32_t tile_rows, std::size_t bytes) const {
  if (matrix_.blocks.empty()) return false;
  const MatrixBlock& block = matrix_.blocks.back();
  return block.tile_rows == tile_rows && block.row_count % tile_rows == 0 &&
         block_bytes(block) + bytes <= max_block_bytes_;
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
      visit_row(block, row, [&](std::uint32_t column, double value) {
        csr.column_indices.push_back(column);
        csr.values.push_back(value);
      });
      csr.row_offsets.push_back(csr.values.size());
    }
  }
  return csr;
}

MatrixSummary summarise(const BlockMatrix& matrix) {
  MatrixSummary summary;
  summary.rows = matrix.rows;
  summary.columns = matrix.columns;
  for (const MatrixBlock& block : matrix.blocks) {
    summary.bytes += block_bytes(block);
    for (std::uint32_t row = 0; row < block.row_count; ++row) {
      double sum = 0.0;
      visit_row(block, row, [&](std::uint32_t, double value) {
        ++summary.nonzeros;
        sum += value;
      });
      summary.max_row_sum = std::max(summary.max_row_sum, sum);
    }
  }
  return summary;
}

}  // namespace relume
