// SPDX-License-Identifier: MIT
//
// Bytes on their way into the buffers of a solver, in as many portions as the host's staging memory makes of
// them.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_device.h"

namespace relume {

struct UploadPiece {
  std::uint32_t buffer = 0;  ///< number among those of whoever it goes to
  VkDeviceSize offset = 0;   ///< in it
  std::span<const std::byte> bytes;
};

/// Pieces refer to `owned` or to what the data was made from (see who made it).
struct UploadData {
  UploadData() = default;
  UploadData(UploadData&&) = default;
  UploadData& operator=(UploadData&&) = default;

  /// Adds a piece of bytes that the data keeps.
  void add_owned(std::uint32_t buffer, VkDeviceSize offset, std::vector<std::byte> bytes);
  /// Adds the pieces and targets of `other`, which has targets.
  void append(UploadData other);

  std::vector<UploadPiece> pieces;
  std::vector<BufferRange> targets;  ///< by number; empty: whoever records knows them
  std::vector<std::vector<std::byte>> owned;
};

/// How far an upload got. A value of the host's: a dropped command buffer is recorded again from the cursor
/// before it.
struct UploadCursor {
  std::size_t piece = 0;
  VkDeviceSize byte = 0;  ///< of that piece
};

/// Memory of the host that the processor writes and the device reads. It belongs to the upload until the
/// command buffer has run.
struct Staging {
  BufferRange range;  ///< usage TRANSFER_SRC
  std::byte* mapped =
      nullptr;  ///< address of the range; the host flushes it before it submits, unless it is coherent
};

}  // namespace relume
