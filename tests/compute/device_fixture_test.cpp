// SPDX-License-Identifier: MIT
//
// Whether the fixture would notice: validation must complain about barriers that are missing.
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include "compute/device_fixture.h"
#include "compute/fake_host.h"
#include "compute/guest_solver.h"
#include "compute/standalone/standalone_memory.h"
#include "compute/test_models.h"

namespace relume::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

class DeviceFixture : public DeviceTest {
 protected:
  /// Two fills of the same buffer, with or without a barrier between them.
  void fill_twice(bool with_barrier) {
    auto buffer = make_device_buffer(device(), 1024, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device);
    ASSERT_TRUE(buffer) << buffer.error().message;
    const auto submitted = device().submit([&](VkCommandBuffer commands) {
      vkCmdFillBuffer(commands, buffer->buffer.get(), 0, 1024, 1);
      VkMemoryBarrier barrier{};
      barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
      barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
      barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
      if (with_barrier) {
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1,
                             &barrier, 0, nullptr, 0, nullptr);
      }
      vkCmdFillBuffer(commands, buffer->buffer.get(), 0, 1024, 2);
    });
    EXPECT_TRUE(submitted) << submitted.error().message;
  }
};

TEST_F(DeviceFixture, CatchesAMissingBarrier) {
  expect_validation_messages();
  fill_twice(false);
  EXPECT_THAT(device().validation_messages(), Contains(HasSubstr("SYNC-HAZARD-WRITE-AFTER-WRITE")));
}

TEST_F(DeviceFixture, AcceptsABarrier) {
  fill_twice(true);
}

TEST_F(DeviceFixture, CatchesMisuseOfTheApi) {
  expect_validation_messages();
  const VkBufferCreateInfo empty{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                 nullptr,
                                 0,
                                 0,
                                 VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                 VK_SHARING_MODE_EXCLUSIVE,
                                 0,
                                 nullptr};
  VkBuffer buffer = VK_NULL_HANDLE;
  vkCreateBuffer(device().host().device, &empty, nullptr, &buffer);
  EXPECT_THAT(device().validation_messages(), Contains(HasSubstr("VUID-VkBufferCreateInfo-size-00912")));
  vkDestroyBuffer(device().host().device, buffer, nullptr);
}

// The solver's own barriers are watched too: taken away, validation names hazards of copies and of kernels.
TEST_F(DeviceFixture, CatchesASolverWithoutItsBarriers) {
  expect_validation_messages();
  const Model model = random_model({}, 1);
  HostDevice host = device().host();
  host.get_instance_proc_addr = get_proc_addr_without_barriers;
  const Lighting lighting = random_lighting(model, 2);
  Guest guest(device(), host, model, lighting);
  guest.together({.restart = true, .bounces = 1});
  EXPECT_THAT(device().validation_messages(), Contains(HasSubstr("SYNC-HAZARD-READ-AFTER-WRITE")));
}

}  // namespace
}  // namespace relume::test
