// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/device_fixture.h"
#include "compute/fake_host.h"
#include "compute/record_upload.h"

namespace relume::test {

/// A device and a host's memory, for passes that are bound to buffers.
class PassTest : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    if (testing::Test::IsSkipped() || testing::Test::HasFatalFailure()) return;
    memory_.emplace(device(), kHostBytes,
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                        VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
  }

  void TearDown() override {
    EXPECT_EQ(memory_ ? memory_->damaged_bytes() : 0u, 0u);
    memory_.reset();
    DeviceTest::TearDown();
  }

  BufferRange allocate(const std::string& name, VkDeviceSize byte_size) {
    return *memory_->allocate({name, byte_size, 256, 0});
  }

  std::vector<BufferRange> allocate(std::span<const BufferRequirement> needed) {
    std::vector<BufferRange> ranges;
    for (const BufferRequirement& buffer : needed) ranges.push_back(*memory_->allocate(buffer));
    return ranges;
  }

  std::vector<Rgb> read_rgb(const BufferRange& range) const { return memory_->read_rgb(range); }

  void upload(std::span<const BufferRange> ranges, const UploadData& data) {
    const auto functions = load_device_functions(device().host());
    ASSERT_TRUE(functions);
    auto staging =
        make_device_buffer(device(), kStagingBytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
    ASSERT_TRUE(staging) << staging.error().message;
    UploadCursor cursor;
    for (bool done = false; !done;) {
      ASSERT_TRUE(device().submit([&](VkCommandBuffer commands) {
        done = record_upload(*functions, commands, ranges, data, {staging->range(), staging->mapped}, cursor);
      }));
    }
  }

  /// `elements` from the beginning of the range on.
  template <class Element>
  void upload(const BufferRange& range, const std::vector<Element>& elements) {
    const auto bytes = std::as_bytes(std::span(elements));
    UploadData data;
    data.add_owned(0, 0, {bytes.begin(), bytes.end()});
    upload(std::span(&range, 1), data);
  }

 private:
  static constexpr VkDeviceSize kHostBytes = VkDeviceSize{16} << 20;
  static constexpr VkDeviceSize kStagingBytes = VkDeviceSize{1} << 20;

  std::optional<GuardedMemory> memory_;
};

}  // namespace relume::test
