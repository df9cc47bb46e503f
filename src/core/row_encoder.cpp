// SPDX-License-Identifier: MIT
#include "core/row_encoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

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
  const double units = kUnorm16Max / row_max;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto nearest = static_cast<std::int32_t>(values[i] * units + kHalf);
    const std::int32_t code = values[i] > 0.0 ? std::max(nearest, 1) : 0;
    codes[i] = static_cast<std::uint32_t>(code);
    unscaled[i] = code * kUnorm16Unit;
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

constexpr std::size_t kLanes = 8;
using Lanes = std::array<double, kLanes>;

double sum_of(const Lanes& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

/// The same from every machine: so many sums side by side, of every so many-th value.
[[gnu::target_clones("avx2", "default")]] double sum_of(const double* values, std::size_t count) {
  Lanes lanes{};
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] += values[i + lane];
  }
  for (; i < count; ++i) lanes[i % kLanes] += values[i];
  return sum_of(lanes);
}

/// The sum of a row decoded in f32, with as many terms side by side.
[[gnu::target_clones("avx2", "default")]] double decoded_in_float(const double* unscaled, std::size_t count,
                                                                  float scale) {
  Lanes lanes{};
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      lanes[lane] += double(static_cast<float>(unscaled[i + lane]) * scale);
  }
  for (; i < count; ++i) lanes[i % kLanes] += double(static_cast<float>(unscaled[i]) * scale);
  return sum_of(lanes);
}

/// The larger of the sums of a row decoded in double and in f32, term by term.
double decoded_sum(std::span<const double> unscaled, float scale) {
  double in_double = 0.0, in_float = 0.0;
  for (const double value : unscaled) {
    in_double += value * double(scale);
    in_float += double(static_cast<float>(value) * scale);
  }
  return std::max(in_double, in_float);
}

/// Whether the decoded sum stays at or below `target`, in the order of the terms. Where it is not close,
/// quicker sums tell: in whatever order, a sum of n positive terms is off by less than n units of rounding.
bool fits(std::span<const double> unscaled, double sum_of_codes, float scale, double target) {
  const double slack =
      4.0 * double(unscaled.size() + kLanes) * std::numeric_limits<double>::epsilon() * target;
  const double near =
      std::max(sum_of_codes * double(scale), decoded_in_float(unscaled.data(), unscaled.size(), scale));
  if (near + slack < target) return true;
  if (near - slack > target) return false;
  return decoded_sum(unscaled, scale) <= target;
}

/// The first scale, from `scale` down, whose decoded sum stays at or below `target`.
float fitting_scale(std::span<const double> unscaled, double sum_of_codes, float scale, double target) {
  while (scale > 0.0f && !fits(unscaled, sum_of_codes, scale, target)) scale = std::nextafter(scale, 0.0f);
  return scale;
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
  // Floats add up in double to the same number, decoded either way, if terms keep their order.
  const bool in_order = codec == ValueCodec::f32;
  const double sum = in_order ? std::accumulate(values.begin(), values.end(), 0.0)
                              : sum_of(values.data(), values.size()),
               sum_of_codes = in_order ? std::accumulate(row.unscaled.begin(), row.unscaled.end(), 0.0)
                                       : sum_of(row.unscaled.data(), row.unscaled.size());
  const double target = std::min(1.0, sum);
  row.scale = 1.0f;
  if (sum_of_codes <= 0.0 || (in_order && sum_of_codes <= target)) return;
  row.scale = fitting_scale(row.unscaled, sum_of_codes, round_down_to_float(target / sum_of_codes), target);
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
