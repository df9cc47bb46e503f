// SPDX-License-Identifier: MIT
#include "core/block_matrix.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/row_encoder.h"
#include "core/value_codec.h"

namespace relume {

/// The rows of a tile, encoded, and which of its columns any of them needs.
struct BlockMatrixBuilder::EncodedTile {
  std::vector<EncodedRow> rows;
  std::vector<std::uint32_t> entries;
};

namespace {

using EncodedTile = BlockMatrixBuilder::EncodedTile;

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

/// Of a row.
struct RowSummary {
  std::uint64_t nonzeros = 0;
  double sum = 0.0;
};

RowSummary summarise_in_order(const MatrixBlock& block, std::uint32_t row) {
  RowSummary summary;
  visit_row(block, row, [&](std::uint32_t, double value) {
    ++summary.nonzeros;
    summary.sum += value;
  });
  return summary;
}

/// Of 16-bit codes that lie side by side: those that are not zero, and the sum.
[[gnu::target_clones("avx2", "default")]] RowSummary summarise_codes(const std::byte* codes,
                                                                     std::uint32_t count) {
  std::uint32_t nonzeros = 0, sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint16_t code = 0;
    std::memcpy(&code, codes + i * sizeof code, sizeof code);
    nonzeros += code != 0 ? 1u : 0u;
    sum += code;
  }
  return {nonzeros, double(sum)};
}

/// The same as summarise_in_order, but that sums which are certain to stay below `most` may be others.
RowSummary summarise_row(const MatrixBlock& block, std::uint32_t row, double most) {
  const std::uint32_t first = block.tile_offsets[row / block.tile_rows],
                      count = block.tile_offsets[row / block.tile_rows + 1] - first;
  constexpr std::uint32_t kMostEntries = 0xffffu;  // so that 32 bits hold the sum of their codes
  if (block.codec != ValueCodec::unorm16 || block.tile_rows != 1 || count > kMostEntries ||
      block.row_scales[row] == 0.0f)
    return summarise_in_order(block, row);
  RowSummary summary = summarise_codes(block.values.data() + first * sizeof(std::uint16_t), count);
  summary.sum *= double(block.row_scales[row]) * kUnorm16Unit;
  const double rounding = 4.0 * (count + 4.0) * std::numeric_limits<double>::epsilon();
  return summary.sum * (1.0 + rounding) < most ? summary : summarise_in_order(block, row);
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
      encoder_(std::make_unique<RowEncoder>()),
      tile_(std::make_unique<EncodedTile>()) {
  matrix_.columns = columns;
}
BlockMatrixBuilder::BlockMatrixBuilder(BlockMatrixBuilder&&) noexcept = default;
BlockMatrixBuilder::~BlockMatrixBuilder() = default;

void BlockMatrixBuilder::append_row(std::span<const std::uint16_t> columns, std::span<const double> values,
                                    std::span<const std::uint32_t> directions) {
  append_stored(encoder_->encode(codec_, columns, values, directions));
}

void BlockMatrixBuilder::append_row(std::span<const std::uint16_t> columns, std::span<const float> values,
                                    std::span<const std::uint32_t> directions) {
  append_stored(encoder_->encode(codec_, columns, values, directions));
}

void BlockMatrixBuilder::append_stored(const StoredRow& row, std::span<const std::uint16_t> column_of) {
  MatrixBlock& block = block_for(1, sizeof(std::uint32_t) + sizeof(float) + row.columns.size_bytes() +
                                        row.values.size_bytes() + row.directions.size_bytes());
  const std::size_t end = block.columns.size();
  block.columns.insert(block.columns.end(), row.columns.begin(), row.columns.end());
  if (!column_of.empty()) {
    for (std::size_t i = end; i < block.columns.size(); ++i) block.columns[i] = column_of[block.columns[i]];
  }
  block.values.insert(block.values.end(), row.values.begin(), row.values.end());
  block.directions.insert(block.directions.end(), row.directions.begin(), row.directions.end());
  block.tile_offsets.push_back(static_cast<std::uint32_t>(block.columns.size()));
  block.row_scales.push_back(row.scale);
  ++block.row_count, ++matrix_.rows;
}

void BlockMatrixBuilder::append_tile(std::span<const std::uint16_t> columns, std::span<const double> values,
                                     std::uint32_t row_count, std::span<const std::uint32_t> directions) {
  constexpr std::uint32_t kTileRows = 8;
  assert(directions.empty() || directions.size() == values.size());
  assert(columns.size() * row_count == values.size() && row_count >= 1 && row_count <= kTileRows);
  EncodedTile& tile = *tile_;
  encode_tile(row_count, columns.size(), values, codec_, tile);
  const std::size_t bytes_of_direction = directions.empty() ? 0 : sizeof(std::uint32_t);
  MatrixBlock& block =
      block_for(kTileRows, tile_bytes(tile, kTileRows, value_bytes(codec_) + bytes_of_direction));
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
      const RowSummary own = summarise_row(block, row, summary.max_row_sum);
      summary.nonzeros += own.nonzeros;
      summary.max_row_sum = std::max(summary.max_row_sum, own.sum);
    }
  }
  return summary;
}

}  // namespace relume
