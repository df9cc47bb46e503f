// SPDX-License-Identifier: MIT
//
// What the codes of a ValueCodec stand for, before they are multiplied by the scale of their row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/block_matrix.h"

namespace relume {

/// Largest code of a quantised codec.
inline constexpr double kUnorm16Max = 65535.0;
inline constexpr double kSqrt8Max = 255.0;
/// What a unit of a unorm16 code stands for: 65535 of them are 1, to the bit.
inline constexpr double kUnorm16Unit = 1.0 / kUnorm16Max;

/// Stored value number `index` of `values`, without the scale of its row.
inline double unscaled_value(ValueCodec codec, std::span<const std::byte> values, std::size_t index) {
  if (codec == ValueCodec::f32) {
    float value = 0.0f;
    std::memcpy(&value, values.data() + index * sizeof value, sizeof value);
    return value;
  }
  if (codec == ValueCodec::unorm16) {
    std::uint16_t code = 0;
    std::memcpy(&code, values.data() + index * sizeof code, sizeof code);
    return code * kUnorm16Unit;
  }
  const double root = std::to_integer<int>(values[index]) / kSqrt8Max;
  return root * root;
}

/// Calls visit(column, unscaled value) for the values of a row of a block that are not zero.
template <class Visit>
void visit_unscaled(const MatrixBlock& block, std::uint32_t row, Visit&& visit) {
  const std::uint32_t tile = row / block.tile_rows;
  const std::uint32_t lane = row % block.tile_rows;
  if (block.row_scales[row] == 0.0f) return;
  for (std::uint32_t entry = block.tile_offsets[tile]; entry < block.tile_offsets[tile + 1]; ++entry) {
    const double value =
        unscaled_value(block.codec, block.values, std::size_t{entry} * block.tile_rows + lane);
    if (value != 0.0) visit(block.columns[entry], value);
  }
}

}  // namespace relume
