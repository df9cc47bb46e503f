// SPDX-License-Identifier: MIT
//
// What a GpuSolver holds, and the recording of its kernels.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/descriptor_sets.h"
#include "compute/device_functions.h"
#include "compute/gpu_solver.h"
#include "compute/pass_plan.h"
#include "compute/pipelines.h"
#include "compute/solver_layout.h"

namespace relume {

struct SolverState {
  HostDevice host;
  DeviceFunctions functions;
  SolverOptions options;
  VkDeviceSize max_texels;  ///< of a texel buffer
  SolverLayout layout;
  Pipelines pipelines;
  Pass bounce;
  Pass gather;
  std::vector<BufferRange> ranges;  ///< per buffer of the layout; empty until bound
  DescriptorSets sets;
};

/// A kernel that works on all clusters and the set of the whole solve. No barriers.
void record_solve_kernel(const SolverState& state, VkCommandBuffer commands, KernelId kernel,
                         RadiosityHalf half_in);

/// Steps of a pass from the cursor on while their cost fits, at least one, with the barriers between them and
/// one after them. True when the pass is complete.
PassPart record_pass_part(const SolverState& state, VkCommandBuffer commands, const Pass& pass,
                          RadiosityHalf from, PassCursor& cursor, std::uint64_t max_cost);

}  // namespace relume
