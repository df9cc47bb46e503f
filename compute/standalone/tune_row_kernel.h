// SPDX-License-Identifier: MIT
//
// Which row kernel is the fastest on a device: measured, because no driver's name says it.
#pragma once

#include <vector>

#include "compute/solver_options.h"
#include "compute/standalone/standalone_device.h"
#include "core/block_matrix.h"
#include "core/result.h"

namespace relume {

struct RowKernelTime {
  RowKernel kernel = RowKernel::row_per_thread;
  MatrixFetch fetch = MatrixFetch::storage;
  double seconds = 0.0;  ///< the least that a product took
};

/// Times every row kernel that the device can run, from storage and from texel buffers, on a made-up matrix
/// of a million form factors in tiles of 8 rows, and gives them with the fastest first: values for
/// SolverOptions. A kernel that gives other bits than the first is left out, so that a choice among the rest
/// changes no result. Submits and waits, about a second in all: for the start of a program. What it gives
/// depends on the device, its driver and `codec` alone, and may be kept for them. Fails as SolverSession
/// does.
Result<std::vector<RowKernelTime>> time_row_kernels(StandaloneDevice& device, ValueCodec codec);

}  // namespace relume
