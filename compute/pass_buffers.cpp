// SPDX-License-Identifier: MIT
#include "compute/pass_buffers.h"

#include <array>
#include <utility>

#include "kernels/shared/glsl_types.h"

namespace relume {

BufferRequirement storage_requirement(std::string name, VkDeviceSize byte_size) {
  return {std::move(name), byte_size, kStorageAlignment,
          VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
}

Result<void> check_storage_sizes(std::span<const BufferRequirement> needed) {
  for (const BufferRequirement& buffer : needed) {
    if (buffer.byte_size <= kMaxStorageBytes) continue;
    return fail(ErrorCode::no_device, "the buffer '" + buffer.name + "' has " +
                                          std::to_string(buffer.byte_size) + " bytes, expected at most " +
                                          std::to_string(kMaxStorageBytes));
  }
  return {};
}

Result<std::vector<BufferRange>> fit_ranges(std::span<const BufferRequirement> needed,
                                            std::span<const BufferRange> ranges) {
  if (ranges.size() != needed.size()) {
    return fail(ErrorCode::usage, "bind needs " + std::to_string(needed.size()) + " buffers, found " +
                                      std::to_string(ranges.size()));
  }
  std::vector<BufferRange> fitted(ranges.begin(), ranges.end());
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (fitted[i].byte_size < needed[i].byte_size || fitted[i].offset % needed[i].alignment != 0) {
      return fail(ErrorCode::usage,
                  "the buffer '" + needed[i].name + "' needs " + std::to_string(needed[i].byte_size) +
                      " bytes at a multiple of " + std::to_string(needed[i].alignment) + ", found " +
                      std::to_string(fitted[i].byte_size) + " at " + std::to_string(fitted[i].offset));
    }
    fitted[i].byte_size = needed[i].byte_size;
  }
  return fitted;
}

Result<std::vector<BufferRange>> fit_color_ranges(std::uint32_t clusters, const BufferRange& albedo,
                                                  const BufferRange& exitance) {
  const VkDeviceSize bytes = clusters * sizeof(kernels::vec4);
  const std::array<BufferRequirement, 2> needed{
      {{"albedo", bytes, sizeof(kernels::vec4), 0}, {"exitance", bytes, sizeof(kernels::vec4), 0}}};
  return fit_ranges(needed, std::array{albedo, exitance});
}

}  // namespace relume
