// SPDX-License-Identifier: MIT
//
// What all guests on a host's device do alike.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/upload.h"
#include "core/result.h"

namespace relume {

/// Limits of the device, if it meets device_requirements; else no_device.
Result<VkPhysicalDeviceLimits> device_limits(const HostDevice& host);

/// The ranges, cut to what is needed. Fails with usage when one is missing, too small or badly aligned.
Result<std::vector<BufferRange>> fit_ranges(std::span<const BufferRequirement> needed,
                                            std::span<const BufferRange> ranges);

/// Copies as much of `data` into `targets` as the staging memory (not empty) holds, from `cursor`, which
/// moves on; barriers as in GpuSolver::record_upload. True when all of it is recorded.
bool record_upload_part(const DeviceFunctions& functions, VkCommandBuffer commands, const UploadData& data,
                        std::span<const BufferRange> targets, const Staging& staging, UploadCursor& cursor);

}  // namespace relume
