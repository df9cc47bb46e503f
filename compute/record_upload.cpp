// SPDX-License-Identifier: MIT
#include "compute/record_upload.h"

#include <algorithm>
#include <cstring>

#include "compute/recording.h"

namespace relume {

bool record_upload(const DeviceFunctions& functions, VkCommandBuffer commands,
                   std::span<const BufferRange> buffers, const UploadData& data, const Staging& staging,
                   UploadCursor& cursor) {
  const ScopedLabel label(functions, commands, "relume upload");
  record_barrier(functions, commands, kComputeAndTransfer, kComputeAndTransfer);
  VkDeviceSize used = 0;
  while (cursor.piece < data.pieces.size()) {
    const UploadPiece& piece = data.pieces[cursor.piece];
    const VkDeviceSize bytes = std::min(piece.bytes.size() - cursor.byte, staging.range.byte_size - used);
    if (bytes == 0 && piece.bytes.size() > cursor.byte) break;
    if (bytes > 0) {
      std::memcpy(staging.mapped + used, piece.bytes.data() + cursor.byte, bytes);
      const BufferRange& target = buffers[piece.buffer];
      const VkBufferCopy copy{staging.range.offset + used, target.offset + piece.offset + cursor.byte, bytes};
      functions.cmd_copy_buffer(commands, staging.range.buffer, target.buffer, 1, &copy);
    }
    used += bytes;
    cursor.byte += bytes;
    if (cursor.byte == piece.bytes.size()) cursor = {cursor.piece + 1, 0};
  }
  record_barrier(functions, commands, kComputeAndTransfer, kComputeAndTransfer);
  return cursor.piece == data.pieces.size();
}

}  // namespace relume
