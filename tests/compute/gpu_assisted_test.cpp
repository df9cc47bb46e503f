// SPDX-License-Identifier: MIT
//
// Whether the pass with GPU-assisted validation would notice.
#include <gtest/gtest.h>

#include <array>
#include <span>
#include <vector>

#include "compute/device_fixture.h"
#include "compute/guest_solver.h"
#include "compute/solver_layout.h"
#include "compute/test_models.h"

namespace relume::test {
namespace {

class GpuAssisted : public DeviceTest {};

// An import that is far outside of the radiosity that all senders have.
TEST_F(GpuAssisted, CatchesAKernelOutsideOfItsBuffers) {
  static_assert(kGpuAssisted);
  expect_validation_messages();
  const Model model = random_model({}, 1);
  const Lighting lighting = random_lighting(model, 2);
  Guest guest(device(), device().host(), model, lighting, {.fetch = MatrixFetch::storage});
  const std::vector<BufferRange> buffers = guest.solver().system_data(model, 2).targets;
  const std::array<std::uint32_t, 4> outside{2, 0x00ffffffu, 0, 0};
  const auto bytes = std::as_bytes(std::span(outside));
  UploadData data;
  data.add_owned(kImports, 0, {bytes.begin(), bytes.end()});
  guest.upload(buffers, std::move(data));
  EXPECT_THAT(device().validation_messages(), testing::IsEmpty());
  guest.together({.restart = true, .bounces = 1});
  EXPECT_THAT(device().validation_messages(), testing::Contains(testing::HasSubstr("out of bounds")));
}

}  // namespace
}  // namespace relume::test
