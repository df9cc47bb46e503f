// SPDX-License-Identifier: MIT
#include "core/row_encoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/value_codec.h"

namespace relume {
namespace {

float round_down_to_float(double value) {
  const float rounded = static_cast<float>(value);
  return static_cast<double>(rounded) > value ? std::nextafter(rounded, 0.0f) : rounded;
}

/// What is added before digits are cut off, to round to the nearest: the largest number below a half, so that
/// no sum is rounded up to the next whole number.
constexpr double kHalf = 0x1.fffffffffffffp-2;

/// The nearest codes; but only zero becomes zero, so that every sender of a row can be told from its codes.
[[gnu::target_clones("avx2", "default")]] void encode_unorm16(std::span<const double> values, double row_max,
                                                              std::uint32_t* codes, double* unscaled) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = values[i] / row_max;
    const auto nearest = static_cast<std::int32_t>(share * kUnorm16Max + kHalf);
    const std::int32_t code = share > 0.0 ? std::max(nearest, 1) : 0;
    codes[i] = static_cast<std::uint32_t>(code);
    unscaled[i] = code / kUnorm16Max;
  }
}

void encode_f32(std::span<const double> values, std::uint32_t* codes, double* unscaled) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float stored = static_cast<float>(values[i]);
    const float kept = stored >= std::numeric_limits<float>::min() ? stored : 0.0f;
    codes[i] = std::bit_cast<std::uint32_t>(kept);
    unscaled[i] = kept;
  }
}

double square(double value) {
  return value * value;
}

/// Of the two codes around a share, the one that leaves the smaller error of the sum so far: neighbours in a
/// row make up for each other, where rounding each to the nearest would shift the balance of the row. Zero
/// stays zero, and nothing else becomes it.
void encode_sqrt8(std::span<const double> values, double row_max, std::uint32_t* codes, double* unscaled) {
  double error = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = values[i] / row_max;
    codes[i] = 0, unscaled[i] = 0.0;
    if (share <= 0.0) continue;
    const double below = std::floor(std::sqrt(share) * kSqrt8Max);
    const double above = std::min(below + 1.0, kSqrt8Max);
    const double error_below = error + square(below / kSqrt8Max) - share;
    const double error_above = error + square(above / kSqrt8Max) - share;
    const bool up = below == 0.0 || std::abs(error_above) < std::abs(error_below);
    error = up ? error_above : error_below;
    const double code = up ? above : below;
    codes[i] = static_cast<std::uint32_t>(code);
    unscaled[i] = square(code / kSqrt8Max);
  }
}

constexpr std::size_t kScales = 8;
using Scales = std::array<float, kScales>;

/// For each of some scales, the larger of the sums of the row decoded in double and in f32.
[[gnu::target_clones("avx2", "default")]] void decoded_sums(std::span<const double> unscaled,
                                                            const Scales& scales, double* sums) {
  std::array<double, kScales> in_double{}, in_float{};
  for (const double value : unscaled) {
    const auto rounded = static_cast<float>(value);
    for (std::size_t i = 0; i < kScales; ++i) {
      in_double[i] += value * double(scales[i]);
      in_float[i] += double(rounded * scales[i]);
    }
  }
  for (std::size_t i = 0; i < kScales; ++i) sums[i] = std::max(in_double[i], in_float[i]);
}

/// The first scale, from `scale` down, whose decoded sum stays at or below `target`.
float fitting_scale(std::span<const double> unscaled, float scale, double target) {
  for (;;) {
    Scales scales{};
    for (float& next : scales) {
      next = scale;
      scale = std::nextafter(scale, 0.0f);
    }
    std::array<double, kScales> sums{};
    decoded_sums(unscaled, scales, sums.data());
    for (std::size_t i = 0; i < kScales; ++i) {
      if (scales[i] <= 0.0f || sums[i] <= target) return scales[i];
    }
  }
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

template <class Code>
void pack(std::span<const std::uint32_t> codes, std::vector<std::byte>& packed) {
  static_assert(std::endian::native == std::endian::little);
  packed.resize(codes.size() * sizeof(Code));
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const auto code = static_cast<Code>(codes[i]);
    std::memcpy(packed.data() + i * sizeof code, &code, sizeof code);
  }
}

/// Those values of which `codes` are not zero.
template <class T>
std::span<const T> without_zeros(std::span<const std::uint32_t> codes, std::span<const T> values,
                                 std::vector<T>& kept) {
  kept.clear();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (codes[i] != 0) kept.push_back(values[i]);
  }
  return kept;
}

}  // namespace

void encode_row(std::span<const double> values, ValueCodec codec, EncodedRow& row) {
  row.codes.resize(values.size());
  row.unscaled.resize(values.size());
  const double row_max = values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  if (row_max < std::numeric_limits<float>::min()) {
    std::fill(row.codes.begin(), row.codes.end(), 0u);
    row.unscaled.assign(values.size(), 0.0);
  } else if (codec == ValueCodec::f32) {
    encode_f32(values, row.codes.data(), row.unscaled.data());
  } else if (codec == ValueCodec::unorm16) {
    encode_unorm16(values, row_max, row.codes.data(), row.unscaled.data());
  } else {
    encode_sqrt8(values, row_max, row.codes.data(), row.unscaled.data());
  }
  double sum = 0.0, sum_of_codes = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += values[i], sum_of_codes += row.unscaled[i];
  const double target = std::min(1.0, sum);
  row.scale = 1.0f;
  // Floats add up in double to the same number, decoded either way.
  if (sum_of_codes <= 0.0 || (codec == ValueCodec::f32 && sum_of_codes <= target)) return;
  row.scale = fitting_scale(row.unscaled, round_down_to_float(target / sum_of_codes), target);
}

StoredRow RowEncoder::encode(ValueCodec codec, std::span<const std::uint16_t> columns,
                             std::span<const double> values, std::span<const std::uint32_t> directions) {
  assert(columns.size() == values.size() && (directions.empty() || directions.size() == values.size()));
  encode_row(values, codec, row_);
  std::span<const std::uint32_t> codes = row_.codes;
  if (std::find(codes.begin(), codes.end(), 0u) != codes.end()) {
    columns = without_zeros(codes, columns, columns_);
    directions = without_zeros(codes, directions, directions_);
    std::erase(row_.codes, 0u);
    codes = row_.codes;
  }
  if (codec == ValueCodec::f32) pack<std::uint32_t>(codes, codes_);
  if (codec == ValueCodec::unorm16) pack<std::uint16_t>(codes, codes_);
  if (codec == ValueCodec::sqrt8) pack<std::uint8_t>(codes, codes_);
  return {columns, codes_, directions, row_.scale};
}

StoredRow RowEncoder::encode(ValueCodec codec, std::span<const std::uint16_t> columns,
                             std::span<const float> values, std::span<const std::uint32_t> directions) {
  if (codec == ValueCodec::f32 && stored_as_they_are(values))
    return {columns, std::as_bytes(values), directions, 1.0f};
  doubles_.assign(values.begin(), values.end());
  return encode(codec, columns, std::span<const double>(doubles_), directions);
}

}  // namespace relume
