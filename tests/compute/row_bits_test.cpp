// SPDX-License-Identifier: MIT
//
// The summation order that kernels/include/row_product.glsl promises, to the bit.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <array>
#include <bit>
#include <cstring>
#include <iostream>

#include "compute/device_fixture.h"
#include "compute/row_kernels.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/standalone/solver_session.h"
#include "compute/test_models.h"
#include "core/reference_solver.h"

namespace relume::test {
namespace {

float code_of(const MatrixBlock& block, std::uint32_t index) {
  if (block.codec == ValueCodec::f32) {
    float stored = 0.0f;
    std::memcpy(&stored, &block.values[index * 4], 4);
    return stored;
  }
  if (block.codec == ValueCodec::unorm16) {
    std::uint16_t stored = 0;
    std::memcpy(&stored, &block.values[index * 2], 2);
    return stored;
  }
  const auto root = static_cast<float>(block.values[index]);
  return root * root;
}

/// One channel of row `row` of the block, times `b`, of which what senders shine is `sender_scale` times as
/// much, in 32-bit arithmetic, as documented.
float row_in_documented_order(const MatrixBlock& block, std::uint32_t row, const std::vector<float>& b,
                              float sender_scale = 1.0f) {
  std::array<float, 8> lanes{};
  const std::uint32_t tile = row / block.tile_rows, first = block.tile_offsets[tile];
  for (std::uint32_t entry = first; entry < block.tile_offsets[tile + 1]; ++entry) {
    const float code = code_of(block, entry * block.tile_rows + row % block.tile_rows);
    const float term = code * b[block.columns[entry]];
    const std::uint32_t lane = (entry - first) % 8;
    lanes[lane] = lanes[lane] + term;
  }
  const float even = (lanes[0] + lanes[4]) + (lanes[2] + lanes[6]);
  const float odd = (lanes[1] + lanes[5]) + (lanes[3] + lanes[7]);
  float scale = block.row_scales[row];
  if (block.codec == ValueCodec::unorm16) scale = scale * (1.0f / 65535.0f);
  if (block.codec == ValueCodec::sqrt8) scale = scale * (1.0f / 65025.0f);
  scale = scale * (1.0f / sender_scale);
  return (even + odd) * scale;
}

/// A system whose gather matrix has `rows` rows of `length` form factors, and radiosities for them.
struct LongRows {
  DrawnSystem drawn;
  std::vector<float> b;
  Lighting lighting;
};

LongRows long_rows(std::uint32_t rows, std::uint32_t length) {
  Random random(length);
  LongRows made{{}, {}, uniform_lighting(length, Rgb(0.5), Rgb(0.0))};
  made.drawn.gather.assign(rows, {});
  for (std::uint32_t i = 0; i < length; ++i) {
    made.drawn.imports.push_back({0, i});
    made.drawn.bounce.emplace_back(length, 0.0);
    for (auto& row : made.drawn.gather) row.push_back((0.01 + random.unit()) / (1.01 * length));
    made.b.push_back(static_cast<float>(random.unit()));
    made.lighting.exitance[i] = Rgb(made.b.back());
  }
  return made;
}

class RowBits : public DeviceTest {};

enum class Senders { single_precision, half_precision };

/// For radiosities of up to 1: the largest power of two that is a half.
constexpr float kHalfScale = 32768.0f;

std::vector<float> as_halves(std::vector<float> b) {
  for (float& value : b) value = static_cast<float>(Eigen::half(value * kHalfScale));
  return b;
}

std::vector<Rgb> gathered(StandaloneDevice& device, const Model& model, const Lighting& lighting,
                          const SolverOptions& options) {
  auto session = SolverSession::create(device, model, options, {});
  EXPECT_TRUE(session && session->light(lighting, {}) && session->run({.restart = true, .gather = true}));
  const auto irradiance = session->read_irradiance();
  return irradiance ? *irradiance : std::vector<Rgb>();
}

/// A system for each length of rows, all solved at once, by every kernel and fetch; each row as documented.
void expect_documented_order(StandaloneDevice& device, const std::vector<LongRows>& all,
                             const Storage& storage, Senders senders = Senders::single_precision) {
  const bool halves = senders == Senders::half_precision;
  std::vector<DrawnSystem> systems;
  Lighting lighting;
  for (const LongRows& made : all) {
    systems.push_back(made.drawn);
    for (SenderRef& sender : systems.back().imports) sender.system = std::uint32_t(systems.size() - 1);
    const auto append = [](std::vector<Rgb>& to, const std::vector<Rgb>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(lighting.albedo, made.lighting.albedo);
    append(lighting.exitance, made.lighting.exitance);
    append(lighting.direct, made.lighting.direct);
  }
  const Model model = drawn_model(systems, 0, storage);
  const auto first_row = gather_offsets(model);
  for (const RowKernel kernel : kRowKernels) {
    if (!supports_row_kernel(device.host(), kernel)) continue;
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
      const SolverOptions options{.kernel = kernel, .fetch = fetch, .half_senders_up_to = halves ? 1.0 : 0.0};
      const auto irradiance = gathered(device, model, lighting, options);
      ASSERT_EQ(irradiance.size(), first_row.back());
      for (std::size_t s = 0; s < all.size(); ++s) {
        const MatrixBlock& block = model.systems[s].gather.blocks.at(0);
        ASSERT_EQ(block.tile_rows, storage.tile_rows);
        const std::vector<float> b = halves ? as_halves(all[s].b) : all[s].b;
        for (std::uint32_t row = 0; row < all[s].drawn.gather.size(); ++row) {
          EXPECT_EQ(irradiance[first_row[s] + row].x,
                    row_in_documented_order(block, row, b, halves ? kHalfScale : 1.0f))
              << all[s].b.size() << " entries, row " << row << ", " << row_kernel_name(kernel) << ", fetch "
              << static_cast<int>(fetch) << ", codec " << static_cast<int>(storage.codec);
        }
      }
    }
  }
}

TEST_F(RowBits, EveryRowLengthIsSummedInTheDocumentedOrder) {
  std::vector<LongRows> all;
  for (std::uint32_t length = 1; length <= 20; ++length) all.push_back(long_rows(1, length));
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16})
    expect_documented_order(device(), all, {codec});
}

// Lengths on both sides of every way in and out of the loops of the tile kernels, and tiles that are partly
// empty.
TEST_F(RowBits, RowsOfTilesAreSummedInTheDocumentedOrder) {
  std::vector<LongRows> all;
  for (const std::uint32_t length : {1u, 7u, 8u, 9u, 31u, 32u, 33u, 40u, 70u})
    all.push_back(long_rows(1 + length % 8, length));
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8})
    expect_documented_order(device(), all, {codec, kMaxBlockBytes, 8});
}

TEST_F(RowBits, HalfPrecisionSendersAreRoundedToNearestAndSummedInTheSameOrder) {
  const std::vector<LongRows> all{long_rows(3, 9), long_rows(8, 33)};
  for (const Storage& storage : {Storage{ValueCodec::unorm16}, Storage{ValueCodec::f32, kMaxBlockBytes, 8},
                                 Storage{ValueCodec::sqrt8, kMaxBlockBytes, 8}})
    expect_documented_order(device(), all, storage, Senders::half_precision);
}

/// Differences of 0, 1, 2, 3 and more units in the last place.
using LastPlaces = std::array<std::uint32_t, 5>;

void count(float a, float b, LastPlaces& places) {
  const auto difference = std::abs(std::bit_cast<std::int32_t>(a) - std::bit_cast<std::int32_t>(b));
  ++places[std::min<std::size_t>(std::size_t(difference), places.size() - 1)];
}

std::string text(const LastPlaces& places) {
  std::string line;
  for (const std::uint32_t number : places) line += " " + std::to_string(number);
  return line;
}

// Prints how many rows of the device differ by 0, 1, 2, 3 and more last places from the mirror, and from the
// reference in double precision.
TEST_F(RowBits, LastPlacesAreThoseOfTheMirror) {
  constexpr std::uint32_t kRows = 512, kLength = 300;
  const LongRows made = long_rows(kRows, kLength);
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    const Model model = drawn_model({made.drawn}, 0, {codec, kMaxBlockBytes, 8});
    const auto out = solve_on_device(device(), model, made.lighting, {0, 0.0}, {});
    ASSERT_TRUE(out) << out.error().message;
    const std::vector<Rgb> exact =
        gather(reference_matrices(model).gather, made.lighting, made.lighting.exitance);
    LastPlaces mirror{}, reference{};
    ASSERT_EQ(model.systems[0].gather.blocks.size(), 1u);
    for (std::uint32_t row = 0; row < kRows; ++row) {
      const auto found = static_cast<float>(out->irradiance[row].x);
      count(found, row_in_documented_order(model.systems[0].gather.blocks[0], row, made.b), mirror);
      count(found, static_cast<float>(exact[row].x), reference);
    }
    std::cout << "codec " << static_cast<int>(codec) << ", rows off by 0, 1, 2, 3 and more last places:"
              << " mirror" << text(mirror) << ", double precision" << text(reference) << "\n";
    EXPECT_EQ(mirror, (LastPlaces{kRows, 0, 0, 0, 0}));
    // Eight lanes of kLength / 8 additions, which err by at most half a place of what they have added up.
    EXPECT_LT(reference.back(), kRows / 10);
  }
}

}  // namespace
}  // namespace relume::test
