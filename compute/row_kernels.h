// SPDX-License-Identifier: MIT
//
// Which row kernels a device can run.
#pragma once

#include "compute/host_device.h"
#include "compute/solver_options.h"

namespace relume {

/// Whether a device that meets device_requirements can run a row kernel. All run everywhere but tile_shuffle:
/// it needs subgroups of 8 or more that shuffle in compute.
bool supports_row_kernel(const HostDevice& host, RowKernel kernel);

/// tile_shuffle where the device can and its subgroups are no wider than 16 (on lavapipe, of 8, it is quicker
/// by a tenth to a quarter), else tile_shared (on an NVIDIA H200, of 32, as quick or quicker, up to twice).
RowKernel default_tile_kernel(const HostDevice& host);

}  // namespace relume
