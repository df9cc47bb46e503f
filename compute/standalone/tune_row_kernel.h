// SPDX-License-Identifier: MIT
//
// The fastest row kernel of a StandaloneDevice, by KernelTrials.
#pragma once

#include <filesystem>
#include <vector>

#include "compute/solver_options.h"
#include "compute/standalone/standalone_device.h"
#include "core/block_matrix.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

struct RowKernelTime {
  RowKernelChoice choice;
  double seconds = 0.0;  ///< the least that its trial took
};

/// Times all trials, the fastest first. One that gives other bits than the first is left out. Submits and
/// waits, some tenths of a second in all. Fails as KernelTrials does.
Result<std::vector<RowKernelTime>> time_row_kernels(StandaloneDevice& device, ValueCodec codec);

/// The fastest for the rows of a model: measured, or as the file `cache` (compute/standalone/kernel_cache.h;
/// empty: none) has it from an earlier run on the same device and driver. A cache that cannot be used is done
/// without. Without rows in tiles: default_row_kernel, from texel buffers. Fails as time_row_kernels.
Result<RowKernelChoice> tuned_row_kernel(StandaloneDevice& device, const Model& model,
                                         const std::filesystem::path& cache);

}  // namespace relume
