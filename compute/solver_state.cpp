// SPDX-License-Identifier: MIT
#include "compute/solver_state.h"

#include <array>
#include <cstddef>

#include "compute/recording.h"
#include "kernels/shared/bindings.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

std::size_t index_of(RadiosityHalf half) {
  return static_cast<std::size_t>(half);
}

void record_step(const SolverState& state, VkCommandBuffer commands, const DispatchStep& step,
                 RadiosityHalf from) {
  const DeviceFunctions& functions = state.functions;
  const SystemSets& system = state.sets.systems[step.system];
  std::array<VkDescriptorSet, kernels::kSets> sets{};
  sets[kernels::kSolveSet] = state.sets.solve[index_of(from)];
  sets[kernels::kSystemSet] = system.system;
  std::uint32_t set_count = kernels::kBlockSet;
  if (step.kernel != StepKernel::import_radiosity) {
    sets[kernels::kBlockSet] =
        (step.kernel == StepKernel::bounce ? system.bounce : system.gather)[step.block];
    set_count = kernels::kSets;
  }
  const KernelId kernel = step_kernel_id(step.kernel, state.options.kernel);
  functions.cmd_bind_pipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                              state.pipelines.get(kernel, step.format));
  functions.cmd_bind_descriptor_sets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, state.pipelines.layout(), 0,
                                     set_count, sets.data(), 0, nullptr);
  functions.cmd_push_constants(commands, state.pipelines.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                               sizeof step.range, &step.range);
  functions.cmd_dispatch(commands, step.workgroups, 1, 1);
}

}  // namespace

void record_solve_kernel(const SolverState& state, VkCommandBuffer commands, KernelId kernel,
                         RadiosityHalf half_in) {
  const DeviceFunctions& functions = state.functions;
  functions.cmd_bind_pipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, state.pipelines.get(kernel, {}));
  functions.cmd_bind_descriptor_sets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, state.pipelines.layout(),
                                     kernels::kSolveSet, 1, &state.sets.solve[index_of(half_in)], 0, nullptr);
  const kernels::Range range{0, state.layout.clusters, 0, 0};
  functions.cmd_push_constants(commands, state.pipelines.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                               sizeof range, &range);
  functions.cmd_dispatch(commands, workgroup_count(range.count), 1, 1);
}

PassPart record_pass_part(const SolverState& state, VkCommandBuffer commands, const Pass& pass,
                          RadiosityHalf from, PassCursor& cursor, std::uint64_t max_cost) {
  PassPart part;
  const std::uint32_t first = cursor.next_dispatch;
  for (; cursor.next_dispatch < pass.size(); ++cursor.next_dispatch) {
    const DispatchStep& step = pass[cursor.next_dispatch];
    if (part.cost + step.cost > max_cost && cursor.next_dispatch > first) break;
    part.cost += step.cost;
    if (step.barrier_before) record_barrier(state.functions, commands, kComputeWrite, kComputeReadWrite);
    record_step(state, commands, step, from);
  }
  record_barrier(state.functions, commands, kComputeWrite, kComputeAndCopy);
  part.complete = cursor.next_dispatch == pass.size();
  return part;
}

}  // namespace relume
