// SPDX-License-Identifier: MIT
//
// The summation order that kernels/include/row_product.glsl promises, to the bit.
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "compute/device_fixture.h"
#include "compute/row_kernels.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/test_models.h"

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

/// One channel of row `row` of the gather matrix, in its first tile, times `b`, in 32-bit arithmetic, as
/// documented.
float row_in_documented_order(const MatrixBlock& block, std::uint32_t row, const std::vector<float>& b) {
  std::array<float, 8> lanes{};
  for (std::uint32_t entry = 0; entry < block.tile_offsets[1]; ++entry) {
    const float code = code_of(block, entry * block.tile_rows + row);
    const float term = code * b[block.columns[entry]];
    lanes[entry % 8] = lanes[entry % 8] + term;
  }
  const float even = (lanes[0] + lanes[4]) + (lanes[2] + lanes[6]);
  const float odd = (lanes[1] + lanes[5]) + (lanes[3] + lanes[7]);
  float scale = block.row_scales[row];
  if (block.codec == ValueCodec::unorm16) scale = scale * (1.0f / 65535.0f);
  if (block.codec == ValueCodec::sqrt8) scale = scale * (1.0f / 65025.0f);
  return (even + odd) * scale;
}

class RowBits : public DeviceTest {};

TEST_F(RowBits, EveryRowLengthIsSummedInTheDocumentedOrder) {
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16}) {
    for (std::uint32_t length = 1; length <= 20; ++length) {
      Random random(length);
      DrawnSystem drawn;
      std::vector<float> b;
      Lighting lighting = uniform_lighting(length, Rgb(0.5), Rgb(0.0));
      drawn.gather.assign(1, {});
      double sum = 0.0;
      for (std::uint32_t i = 0; i < length; ++i) {
        drawn.imports.push_back({0, i});
        drawn.bounce.emplace_back(length, 0.0);
        drawn.gather[0].push_back(0.01 + random.unit());
        sum += drawn.gather[0].back();
        b.push_back(static_cast<float>(random.unit()));
        lighting.exitance[i] = Rgb(b.back());
      }
      for (double& value : drawn.gather[0]) value /= sum;
      const Model model = drawn_model({drawn}, 0, {codec});
      const float expected = row_in_documented_order(model.systems[0].gather.blocks[0], 0, b);
      for (const RowKernel kernel : kRowKernels) {
        if (!supports_row_kernel(device().host(), kernel)) continue;
        for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
          const auto out =
              solve_on_device(device(), model, lighting, {0, 0.0}, {.kernel = kernel, .fetch = fetch});
          ASSERT_TRUE(out) << out.error().message;
          EXPECT_EQ(out->irradiance[0].x, expected)
              << length << " entries, " << row_kernel_name(kernel) << ", fetch " << static_cast<int>(fetch);
        }
      }
    }
  }
}

// Lengths on both sides of every way in and out of the loops of the tile kernels, and tiles that are partly
// empty.
TEST_F(RowBits, RowsOfTilesAreSummedInTheDocumentedOrder) {
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    for (const std::uint32_t length : {1u, 7u, 8u, 9u, 31u, 32u, 33u, 40u, 70u}) {
      const std::uint32_t rows = 1 + length % 8;
      Random random(length);
      DrawnSystem drawn;
      std::vector<float> b;
      Lighting lighting = uniform_lighting(length, Rgb(0.5), Rgb(0.0));
      drawn.gather.assign(rows, {});
      for (std::uint32_t i = 0; i < length; ++i) {
        drawn.imports.push_back({0, i});
        drawn.bounce.emplace_back(length, 0.0);
        for (auto& row : drawn.gather) row.push_back((0.01 + random.unit()) / (1.01 * length));
        b.push_back(static_cast<float>(random.unit()));
        lighting.exitance[i] = Rgb(b.back());
      }
      const Model model = drawn_model({drawn}, 0, {codec, kMaxBlockBytes, 8});
      const MatrixBlock& block = model.systems[0].gather.blocks[0];
      ASSERT_EQ(block.tile_rows, 8u);
      for (const RowKernel kernel : kRowKernels) {
        if (!supports_row_kernel(device().host(), kernel)) continue;
        for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
          const auto out =
              solve_on_device(device(), model, lighting, {0, 0.0}, {.kernel = kernel, .fetch = fetch});
          ASSERT_TRUE(out) << out.error().message;
          for (std::uint32_t row = 0; row < rows; ++row) {
            EXPECT_EQ(out->irradiance[row].x, row_in_documented_order(block, row, b))
                << length << " entries, row " << row << ", " << row_kernel_name(kernel) << ", fetch "
                << static_cast<int>(fetch) << ", codec " << static_cast<int>(codec);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace relume::test
