// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "compute/device_functions.h"
#include "compute/upload.h"

namespace relume {

/// Copies as much of `data` as the staging memory (not empty) holds, from `cursor`, which moves on, into
/// `buffers`, by which the pieces are numbered. True when all of it is recorded. Barriers before and after:
/// after, and before, all COMPUTE_SHADER and TRANSFER work on the queue.
bool record_upload(const DeviceFunctions& functions, VkCommandBuffer commands,
                   std::span<const BufferRange> buffers, const UploadData& data, const Staging& staging,
                   UploadCursor& cursor);

}  // namespace relume
