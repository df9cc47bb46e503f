// SPDX-License-Identifier: MIT
//
// Form factors of one row as the codes of a ValueCodec (core/block_matrix.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block_matrix.h"

namespace relume {

struct EncodedRow {
  std::vector<std::uint32_t> codes;  ///< one per value; f32: the bits of the float
  std::vector<double> unscaled;      ///< what the codes stand for
  float scale = 1.0f;
};

/// Values as BlockMatrixBuilder::append_row takes them.
void encode_row(std::span<const double> values, ValueCodec codec, EncodedRow& row);

/// Encodes rows one by one; its memory serves again.
class RowEncoder {
 public:
  /// Values and directions as BlockMatrixBuilder::append_row takes them. Borrows what was given; valid until
  /// the next call.
  StoredRow encode(ValueCodec codec, std::span<const std::uint16_t> columns, std::span<const double> values,
                   std::span<const std::uint32_t> directions);
  StoredRow encode(ValueCodec codec, std::span<const std::uint16_t> columns, std::span<const float> values,
                   std::span<const std::uint32_t> directions);

 private:
  EncodedRow row_;
  std::vector<double> doubles_;
  std::vector<std::uint16_t> columns_;
  std::vector<std::byte> codes_;
  std::vector<std::uint32_t> directions_;
};

}  // namespace relume
