// SPDX-License-Identifier: MIT
#include "compute/standalone/standalone_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cctype>

#include "compute/device_fixture.h"
#include "compute/standalone/standalone_memory.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

class StandaloneDeviceTest : public DeviceTest {};

TEST_F(StandaloneDeviceTest, IsFoundByAPartOfItsNameInAnyCase) {
  std::string part = device().name().substr(1, 4);
  std::transform(part.begin(), part.end(), part.begin(), [](unsigned char c) { return std::toupper(c); });
  const auto found = StandaloneDevice::create({.device_name = part});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->name(), device().name());
}

TEST_F(StandaloneDeviceTest, AnUnknownNameListsWhatIsThere) {
  const auto found = StandaloneDevice::create({.device_name = "no such device"});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::no_device);
  EXPECT_THAT(found.error().message, HasSubstr("named 'no such device'"));
  EXPECT_THAT(found.error().message, HasSubstr(device().name()));
}

TEST_F(StandaloneDeviceTest, WithoutValidationNothingIsCollected) {
  const auto quiet = StandaloneDevice::create({});
  ASSERT_TRUE(quiet) << quiet.error().message;
  EXPECT_FALSE(quiet->validating());
  EXPECT_TRUE(quiet->validation_messages().empty());
}

TEST_F(StandaloneDeviceTest, AWaitThatRunsOutEndsAllSubmissions) {
  constexpr VkDeviceSize kBytes = VkDeviceSize{64} << 20;
  const auto buffer =
      make_device_buffer(device(), kBytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::device);
  ASSERT_TRUE(buffer) << buffer.error().message;
  const auto late = device().submit(
      [&](VkCommandBuffer commands) { vkCmdFillBuffer(commands, buffer->buffer.get(), 0, kBytes, 1); }, 1e-9);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::no_device);
  EXPECT_THAT(late.error().message, HasSubstr("did not finish in time"));
  const auto next = device().submit([](VkCommandBuffer) {});
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::no_device);
}

TEST_F(StandaloneDeviceTest, TooMuchMemoryIsAnErrorOfItsOwn) {
  const auto buffer = make_device_buffer(device(), VkDeviceSize{1} << 50, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                         MemoryKind::device);
  // Validation objects to the size before the driver does.
  expect_validation_messages();
  ASSERT_FALSE(buffer);
  EXPECT_EQ(buffer.error().code, ErrorCode::out_of_memory);
  EXPECT_THAT(buffer.error().message, HasSubstr("1125899906842624 bytes"));
}

TEST_F(StandaloneDeviceTest, AnArenaKeepsAlignmentsAndGrows) {
  DeviceArena arena(device());
  const BufferRequirement small{"small", 100, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
  const BufferRequirement large{"large", VkDeviceSize{100} << 20, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
  const auto first = arena.allocate(small);
  const auto second = arena.allocate(small);
  const auto third = arena.allocate(large);
  const auto fourth = arena.allocate(small);
  ASSERT_TRUE(first && second && third && fourth);
  EXPECT_EQ(first->offset, 0u);
  EXPECT_EQ(second->offset, 256u);
  EXPECT_EQ(second->buffer, first->buffer);
  EXPECT_NE(third->buffer, first->buffer);
  EXPECT_EQ(third->byte_size, VkDeviceSize{100} << 20);
  EXPECT_NE(fourth->buffer, third->buffer);
}

}  // namespace
}  // namespace relume::test
