// SPDX-License-Identifier: MIT
#include "measure/recoded.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "core/value_codec.h"

namespace relume {
namespace {

/// Values of `rows` rows of a tile from `row` on: entry c of row r at [r * length + c].
std::vector<double> tile_values(const MatrixBlock& block, std::uint32_t row, std::uint32_t rows) {
  const std::uint32_t tile = row / block.tile_rows, begin = block.tile_offsets[tile];
  const std::uint32_t length = block.tile_offsets[tile + 1] - begin;
  std::vector<double> values;
  values.reserve(std::size_t{rows} * length);
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < length; ++c) {
      const std::size_t index = std::size_t{begin + c} * block.tile_rows + r;
      values.push_back(unscaled_value(block.codec, block.values, index) * double(block.row_scales[row + r]));
    }
  }
  return values;
}

void append_recoded(const MatrixBlock& block, std::uint32_t row, std::uint32_t tile_rows,
                    BlockMatrixBuilder& builder) {
  const std::uint32_t tile = row / block.tile_rows, begin = block.tile_offsets[tile];
  const std::uint32_t length = block.tile_offsets[tile + 1] - begin;
  const std::uint32_t rows = std::min(block.tile_rows, block.row_count - row);
  const std::span columns(block.columns.data() + begin, length);
  const std::vector<double> values = tile_values(block, row, rows);
  if (tile_rows == 8 && block.tile_rows == 8) {
    builder.append_tile(columns, values, rows);
    return;
  }
  for (std::uint32_t r = 0; r < rows; ++r)
    builder.append_row(columns, std::span(values).subspan(std::size_t{r} * length, length));
}

BlockMatrix recoded(const BlockMatrix& matrix, ValueCodec codec, std::uint32_t tile_rows) {
  BlockMatrixBuilder builder(matrix.columns, codec);
  for (const MatrixBlock& block : matrix.blocks) {
    for (std::uint32_t row = 0; row < block.row_count; row += block.tile_rows)
      append_recoded(block, row, tile_rows, builder);
  }
  return std::move(builder).finish();
}

/// The rows before `count`, which is where a tile ends.
BlockMatrix first_rows(BlockMatrix matrix, std::uint32_t count) {
  std::erase_if(matrix.blocks, [count](const MatrixBlock& block) { return block.first_row >= count; });
  for (MatrixBlock& block : matrix.blocks) {
    if (block.first_row + block.row_count <= count) continue;
    block.row_count = count - block.first_row;
    block.tile_offsets.resize((block.row_count + block.tile_rows - 1) / block.tile_rows + 1);
    block.columns.resize(block.tile_offsets.back());
    block.values.resize(block.columns.size() * block.tile_rows * value_bytes(block.codec));
    block.row_scales.resize(block.row_count);
  }
  matrix.rows = std::min(matrix.rows, count);
  return matrix;
}

template <class Take>
void for_each_matrix(const Model& model, const Take& take) {
  for (const System& system : model.systems) {
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) take(summarise(*matrix));
  }
}

}  // namespace

Model recoded(Model model, ValueCodec codec, std::uint32_t tile_rows) {
  for (System& system : model.systems) {
    system.bounce = recoded(system.bounce, codec, tile_rows);
    system.gather = recoded(system.gather, codec, tile_rows);
  }
  return model;
}

Model without_sensors(Model model) {
  for (System& system : model.systems) {
    system.gather = first_rows(std::move(system.gather), std::uint32_t(system.lumels.size()));
    system.sensors.clear(), system.lifted_sensors.clear();
  }
  model.sensor_names.clear();
  return model;
}

std::uint64_t matrix_bytes(const Model& model) {
  std::uint64_t bytes = 0;
  for_each_matrix(model, [&](const MatrixSummary& summary) { bytes += summary.bytes; });
  return bytes;
}

std::uint64_t form_factors(const Model& model) {
  std::uint64_t count = 0;
  for_each_matrix(model, [&](const MatrixSummary& summary) { count += summary.nonzeros; });
  return count;
}

}  // namespace relume
