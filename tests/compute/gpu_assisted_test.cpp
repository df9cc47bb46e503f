// SPDX-License-Identifier: MIT
//
// Whether the pass with GPU-assisted validation would notice.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "compute/device_fixture.h"
#include "compute/guest_solver.h"
#include "compute/test_models.h"

namespace relume::test {
namespace {

class GpuAssisted : public DeviceTest {};

TEST_F(GpuAssisted, CatchesAKernelOutsideOfItsBuffers) {
  static_assert(kGpuAssisted);
  expect_validation_messages();
  const Model model = random_model({}, 1);
  const Lighting lighting = random_lighting(model, 2);
  HostDevice host = device().host();
  host.get_instance_proc_addr = get_proc_addr_of_short_ranges;
  Guest guest(device(), host, model, lighting, {.fetch = MatrixFetch::storage});
  guest.together({.restart = true, .bounces = 1});
  const std::vector<std::string> messages = device().validation_messages();
  if (messages.empty()) {
    GTEST_SKIP()
        << "GPU-assisted validation does not see kernels leave their buffers with this layer and driver "
           "(1.3.239 on lavapipe does not): that the frames of this program are clean says little here";
  }
  EXPECT_THAT(messages, testing::Contains(testing::HasSubstr("out of bounds")));
}

}  // namespace
}  // namespace relume::test
