// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstring>
#include <span>

#include "compute/standalone/standalone_memory.h"
#include "compute/upload.h"

namespace relume {

/// Hands out the parts of the staging memory of a frame, one behind the other; whoever made it knows their
/// sum.
class StagingParts {
 public:
  static constexpr VkDeviceSize kAlignment = 16;

  explicit StagingParts(const DeviceBuffer& buffer) : buffer_(buffer) {}

  Staging take(VkDeviceSize byte_size) {
    const Staging part{{buffer_.buffer.get(), used_, byte_size}, buffer_.mapped + used_};
    used_ += (byte_size + kAlignment - 1) / kAlignment * kAlignment;
    return part;
  }

  BufferRange copy_of(std::span<const std::byte> bytes) {
    const Staging part = take(bytes.size());
    std::memcpy(part.mapped, bytes.data(), bytes.size());
    return part.range;
  }

 private:
  const DeviceBuffer& buffer_;
  VkDeviceSize used_ = 0;
};

}  // namespace relume
