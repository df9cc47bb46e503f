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

/// tile_shuffle where the device can, else tile_shared.
RowKernel default_tile_kernel(const HostDevice& host);

}  // namespace relume
