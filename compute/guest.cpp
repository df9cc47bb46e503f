// SPDX-License-Identifier: MIT
#include "compute/guest.h"

#include <algorithm>
#include <cstring>

#include "compute/device_requirements.h"
#include "compute/recording.h"

namespace relume {

Result<VkPhysicalDeviceLimits> device_limits(const HostDevice& host) {
  if (auto required = device_requirements(host.get_instance_proc_addr, host.instance, host.physical_device);
      !required) {
    return tl::unexpected<Error>(required.error());
  }
  const auto get_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(
      host.get_instance_proc_addr(host.instance, "vkGetPhysicalDeviceProperties"));
  VkPhysicalDeviceProperties properties{};
  get_properties(host.physical_device, &properties);
  return properties.limits;
}

Result<std::vector<BufferRange>> fit_ranges(std::span<const BufferRequirement> needed,
                                            std::span<const BufferRange> ranges) {
  if (ranges.size() != needed.size()) {
    return fail(ErrorCode::usage, "bind needs " + std::to_string(needed.size()) + " buffers, found " +
                                      std::to_string(ranges.size()));
  }
  std::vector<BufferRange> exact(ranges.begin(), ranges.end());
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (exact[i].byte_size < needed[i].byte_size || exact[i].offset % needed[i].alignment != 0) {
      return fail(ErrorCode::usage,
                  "the buffer '" + needed[i].name + "' needs " + std::to_string(needed[i].byte_size) +
                      " bytes at a multiple of " + std::to_string(needed[i].alignment) + ", found " +
                      std::to_string(exact[i].byte_size) + " at " + std::to_string(exact[i].offset));
    }
    exact[i].byte_size = needed[i].byte_size;
  }
  return exact;
}

bool record_upload_part(const DeviceFunctions& functions, VkCommandBuffer commands, const UploadData& data,
                        std::span<const BufferRange> targets, const Staging& staging, UploadCursor& cursor) {
  const ScopedLabel label(functions, commands, "relume upload");
  record_barrier(functions, commands, kComputeAndCopy, kTransferWrite);
  VkDeviceSize used = 0;
  while (cursor.piece < data.pieces.size()) {
    const UploadPiece& piece = data.pieces[cursor.piece];
    const VkDeviceSize bytes = std::min(piece.bytes.size() - cursor.byte, staging.range.byte_size - used);
    if (bytes == 0 && piece.bytes.size() > cursor.byte) break;
    if (bytes > 0) {
      std::memcpy(staging.mapped + used, piece.bytes.data() + cursor.byte, bytes);
      const BufferRange& target = targets[piece.buffer];
      const VkBufferCopy copy{staging.range.offset + used, target.offset + piece.offset + cursor.byte, bytes};
      functions.cmd_copy_buffer(commands, staging.range.buffer, target.buffer, 1, &copy);
    }
    used += bytes;
    cursor.byte += bytes;
    if (cursor.byte == piece.bytes.size()) cursor = {cursor.piece + 1, 0};
  }
  record_barrier(functions, commands, kTransferWrite, kComputeAndCopy);
  return cursor.piece == data.pieces.size();
}

}  // namespace relume
