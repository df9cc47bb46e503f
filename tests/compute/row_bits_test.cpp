// SPDX-License-Identifier: MIT
//
// The summation order that kernels/include/row_product.glsl promises, to the bit.
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "compute/device_fixture.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/test_models.h"

namespace relume::test {
namespace {

/// One channel of row 0 of the gather matrix times `b`, in 32-bit arithmetic, as documented.
float row_in_documented_order(const MatrixBlock& block, const std::vector<float>& b) {
  std::array<float, 8> lanes{};
  for (std::uint32_t entry = 0; entry < block.tile_offsets[1]; ++entry) {
    float code = 0.0f;
    if (block.codec == ValueCodec::f32) {
      std::memcpy(&code, &block.values[entry * 4], 4);
    } else {
      std::uint16_t stored = 0;
      std::memcpy(&stored, &block.values[entry * 2], 2);
      code = stored;
    }
    const float term = code * b[block.columns[entry]];
    lanes[entry % 8] = lanes[entry % 8] + term;
  }
  const float even = (lanes[0] + lanes[4]) + (lanes[2] + lanes[6]);
  const float odd = (lanes[1] + lanes[5]) + (lanes[3] + lanes[7]);
  const float scale =
      block.codec == ValueCodec::f32 ? block.row_scales[0] : block.row_scales[0] * (1.0f / 65535.0f);
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
      const float expected = row_in_documented_order(model.systems[0].gather.blocks[0], b);
      for (const RowKernel kernel : {RowKernel::row_per_thread, RowKernel::row_per_8_lanes}) {
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

}  // namespace
}  // namespace relume::test
