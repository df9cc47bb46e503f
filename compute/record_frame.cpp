// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <string>

#include "compute/lightmap_pass.h"
#include "compute/material_pass.h"
#include "compute/recording.h"
#include "compute/screen_pass.h"
#include "compute/solver_state.h"
#include "kernels/shared/bindings.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

Result<void> check_active(const SolverState& state, const FramePlan& plan) {
  for (std::uint32_t s = 0; s < plan.halves.size(); ++s) {
    if (plan.halves[s] != kInactive && !state.systems[s]) {
      return fail(ErrorCode::usage,
                  "the schedule has system " + std::to_string(s) + " active, but it is not loaded");
    }
  }
  return {};
}

Result<void> check_lighting_number(const SolverState& state, std::uint32_t lighting) {
  if (lighting < state.layout.lightings) return {};
  return fail(ErrorCode::usage, "lighting " + std::to_string(lighting) + ": the solver was made for " +
                                    std::to_string(state.layout.lightings));
}

bool inside(const BufferRange& part, VkDeviceSize offset, const BufferRange& whole) {
  return part.buffer != VK_NULL_HANDLE && offset <= whole.byte_size &&
         part.byte_size <= whole.byte_size - offset;
}

/// Everything that a frame shares, and the recording of its parts.
class FrameRecorder {
 public:
  FrameRecorder(const SolverState& state, VkCommandBuffer commands, const FramePlan& plan)
      : state_(state), commands_(commands) {
    if (plan.next.largest_radiosity > 0.0) most_ = static_cast<float>(plan.next.largest_radiosity);
  }

  void barrier() { record_barrier(state_.functions, commands_, kComputeAndTransfer, kComputeAndTransfer); }

  void copy(const BufferRange& source, const BufferRange& target, VkDeviceSize target_offset) {
    if (source.byte_size == 0) return;
    const VkBufferCopy region{source.offset, target.offset + target_offset, source.byte_size};
    state_.functions.cmd_copy_buffer(commands_, source.buffer, target.buffer, 1, &region);
  }

  /// Where each system's radiosity is, and the sky's.
  void write_first_senders(const FramePlan& plan) {
    constexpr std::uint32_t kChunk = 1024;
    std::array<std::uint32_t, kChunk> entries{};
    const std::uint32_t count = state_.layout.systems + 1;
    for (std::uint32_t begin = 0; begin < count; begin += kChunk) {
      const std::uint32_t end = std::min(begin + kChunk, count);
      for (std::uint32_t s = begin; s < end; ++s) entries[s - begin] = first_sender(plan, s);
      write_table(begin, end - begin, entries.data());
    }
  }

  void nodes_of_sky() {
    for (const DispatchStep& step : state_.sky_small_nodes) dispatch_of_sky(KernelId::small_nodes, step);
    if (!state_.sky_small_nodes.empty() && !state_.sky_nodes.empty()) barrier();
    for (const DispatchStep& step : state_.sky_nodes) dispatch_of_sky(KernelId::nodes, step);
  }

  void step(const FrameStep& step) {
    const LoadedSystem& system = *state_.systems[step.system];
    if (step.kind == FrameStep::Kind::flip) {
      const std::uint32_t first = system.first_of_half(step.half);
      write_table(step.system, 1, &first);
      return;
    }
    const DispatchStep& planned = dispatches_of(system.dispatches, step.kernel)[step.dispatch];
    std::array<VkDescriptorSet, kernels::kSets> sets{state_.sets.solve, system.sets.system};
    std::uint32_t set_count = kernels::kBlockSet;
    if (step.kernel == StepKernel::bounce) sets[set_count++] = system.sets.bounce[planned.block];
    if (step.kernel == StepKernel::gather || step.kernel == StepKernel::directions)
      sets[set_count++] = system.sets.gather[planned.block];
    if (step.kernel == StepKernel::probes) sets[set_count++] = system.sets.probes[planned.block];
    if (of_rooms(step.kernel)) sets[set_count++] = state_.rooms->rooms;
    dispatch(step_kernel_id(step.kernel, state_.row_kernel, planned.format.tile_rows), planned,
             range_of(step, system, planned), sets, set_count);
  }

  /// Whether two steps may not run side by side, without a barrier of the plan: what the kernels of nodes
  /// bind of one system reaches into others where there are several lightings.
  bool overlap(const FrameStep& before, const FrameStep& step) const {
    return state_.layout.lightings > 1 && step.kind == FrameStep::Kind::dispatch && of_nodes(step.kernel) &&
           before.kind == FrameStep::Kind::dispatch && of_nodes(before.kernel) &&
           before.system != step.system;
  }

 private:
  static bool of_nodes(StepKernel kernel) {
    return kernel == StepKernel::small_nodes || kernel == StepKernel::nodes;
  }

  std::uint32_t senders_of_lighting() const {
    return static_cast<std::uint32_t>(state_.layout.radiosity_plane.step / kRgbBytes);
  }

  std::uint32_t first_sender(const FramePlan& plan, std::uint32_t system) const {
    if (system == state_.layout.systems) return 0;
    const bool active = system < plan.halves.size() && plan.halves[system] != kInactive;
    return active ? state_.systems[system]->first_of_half(plan.halves[system]) : kernels::kNotLoaded;
  }

  void write_table(std::uint32_t first, std::uint32_t count, const std::uint32_t* entries) {
    const BufferRange& table = state_.ranges[kFirstSender];
    constexpr VkDeviceSize kEntryBytes = sizeof(std::uint32_t);
    state_.functions.cmd_update_buffer(commands_, table.buffer, table.offset + first * kEntryBytes,
                                       count * kEntryBytes, entries);
  }

  static bool of_rooms(StepKernel kernel) {
    return kernel == StepKernel::restrict_rooms || kernel == StepKernel::solve_rooms ||
           kernel == StepKernel::correct_rooms;
  }

  kernels::Range range_of(const FrameStep& step, const LoadedSystem& system,
                          const DispatchStep& planned) const {
    kernels::Range range = planned.range;
    if (step.kernel == StepKernel::directions) return range;
    if (of_nodes(step.kernel)) {
      range.first_sender = step.half * system.layout.senders();
      range.block_row = senders_of_lighting();
      return range;
    }
    range.first_sender = system.first_of_half(step.half);
    if (step.kernel == StepKernel::start || step.kernel == StepKernel::residual ||
        step.kernel == StepKernel::restrict_rooms) {
      range.first_row = system.first_of_half(1 - step.half);
    }
    if (step.kernel == StepKernel::residual) range.block_row = step.system;
    if (step.kernel == StepKernel::correct_rooms) range.first_row = std::bit_cast<std::uint32_t>(most_);
    return range;
  }

  void dispatch_of_sky(KernelId kernel, const DispatchStep& step) {
    kernels::Range range = step.range;
    range.block_row = senders_of_lighting();
    dispatch(kernel, step, range, {state_.sets.solve, state_.sets.sky}, kernels::kBlockSet);
  }

  void dispatch(KernelId kernel, const DispatchStep& step, const kernels::Range& range,
                const std::array<VkDescriptorSet, kernels::kSets>& sets, std::uint32_t set_count) {
    const DeviceFunctions& functions = state_.functions;
    const VkPipelineLayout layout = state_.pipelines.layout();
    functions.cmd_bind_pipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE,
                                state_.pipelines.get(kernel, step.format));
    functions.cmd_bind_descriptor_sets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, set_count,
                                       sets.data(), 0, nullptr);
    functions.cmd_push_constants(commands_, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof range, &range);
    functions.cmd_dispatch(commands_, step.workgroups, step.sweeps, step.lightings);
  }

  const SolverState& state_;
  VkCommandBuffer commands_;
  float most_ = std::numeric_limits<float>::max();  ///< what no correction exceeds, lm/m2
};

/// Sets the residuals that the plan measures to zero: they are maxima.
void clear_residuals(const SolverState& state, VkCommandBuffer commands, const FramePlan& plan) {
  const BufferRange& residuals = state.ranges[kResiduals];
  constexpr VkDeviceSize kBytes = sizeof(kernels::ResidualRecord);
  for (const FrameStep& step : plan.steps) {
    if (step.kind != FrameStep::Kind::dispatch || step.kernel != StepKernel::residual) continue;
    for (std::uint32_t lighting = 0; lighting < state.layout.lightings; ++lighting) {
      const VkDeviceSize record = VkDeviceSize{lighting} * state.layout.systems + step.system;
      state.functions.cmd_fill_buffer(commands, residuals.buffer, residuals.offset + record * kBytes, kBytes,
                                      0);
    }
  }
}

/// Copies and tables, what depends on them, and passes that write inputs.
void record_inputs(const SolverState& state, VkCommandBuffer commands, FrameRecorder& record,
                   const FrameInputs& inputs) {
  for (const InputCopy& copy : inputs.copies) {
    record.copy(copy.source, input_range(state, copy.system, copy.quantity, copy.lighting),
                copy.first * kRgbBytes);
  }
  record.write_first_senders(*inputs.plan);
  clear_residuals(state, commands, *inputs.plan);
  record.barrier();
  record.nodes_of_sky();
  for (const MaterialPass* pass : inputs.materials) pass->record(commands);
  for (const ScreenFrame& screen : inputs.screens) screen.pass->record(commands, screen.image, screen.factor);
  for (std::uint32_t s = 0; inputs.write_inputs && s < inputs.plan->halves.size(); ++s) {
    if (inputs.plan->halves[s] != kInactive) inputs.write_inputs(commands, s);
  }
  record.barrier();
}

void record_publish(const SolverState& state, VkCommandBuffer commands, FrameRecorder& record,
                    std::uint32_t system, const FrameOutputs& outputs) {
  const LoadedSystem& loaded = *state.systems[system];
  for (const LightmapOutput& lightmap : outputs.lightmaps) {
    if (lightmap.system == system) lightmap.pass->record(commands);
  }
  for (const IrradianceTarget& target : outputs.irradiance) {
    if (target.system != system) continue;
    BufferRange source = loaded.ranges[kIrradiance];
    source.offset += target.lighting * loaded.layout.irradiance_plane.step;
    source.byte_size = std::min(target.target.byte_size, loaded.layout.gather_rows * kRgbBytes);
    record.copy(source, target.target, 0);
  }
  if (outputs.publish) outputs.publish(commands, system);
}

}  // namespace

BufferRange input_range(const SolverState& state, std::uint32_t system, Quantity quantity,
                        std::uint32_t lighting) {
  if (lighting >= state.layout.lightings) return {};
  if (quantity == Quantity::sky) {
    const BufferRange& senders = state.ranges[kRadiosity];
    return {senders.buffer, senders.offset + lighting * state.layout.radiosity_plane.step,
            state.layout.sky_patches * kRgbBytes};
  }
  if (system >= state.systems.size() || !state.systems[system]) return {};
  constexpr std::array<SystemBuffer, 4> kBuffers = {kAlbedo, kExitance, kDirect, kWeights};
  const LoadedSystem& loaded = *state.systems[system];
  const BufferRange& range = loaded.ranges[kBuffers[static_cast<std::size_t>(quantity)]];
  const bool of_lighting = quantity == Quantity::exitance || quantity == Quantity::direct;
  return {range.buffer, range.offset + (of_lighting ? lighting * loaded.layout.clusters_plane.step : 0),
          loaded.layout.clusters * kRgbBytes};
}

Result<void> check_frame(const SolverState& state, const FrameInputs& inputs, const FrameOutputs& outputs) {
  if (state.failure) return tl::unexpected<Error>(*state.failure);
  if (inputs.plan == nullptr) return fail(ErrorCode::usage, "record_frame needs a plan");
  if (auto checked = check_active(state, *inputs.plan); !checked) return checked;
  for (const InputCopy& copy : inputs.copies) {
    if (auto known = check_lighting_number(state, copy.lighting); !known) return known;
    const BufferRange target = input_range(state, copy.system, copy.quantity, copy.lighting);
    if (!inside(copy.source, copy.first * kRgbBytes, target)) {
      return fail(ErrorCode::usage, "an input copy of " + std::to_string(copy.source.byte_size) +
                                        " bytes from element " + std::to_string(copy.first) +
                                        " on does not fit system " + std::to_string(copy.system) +
                                        ", which has " + std::to_string(target.byte_size) + " bytes");
    }
  }
  for (const IrradianceTarget& target : outputs.irradiance) {
    if (auto known = check_lighting_number(state, target.lighting); !known) return known;
  }
  const VkDeviceSize report = state.layout.residual_bytes();
  if (outputs.report.buffer != VK_NULL_HANDLE && outputs.report.byte_size < report) {
    return fail(ErrorCode::usage, "the report needs " + std::to_string(report) + " bytes, found " +
                                      std::to_string(outputs.report.byte_size));
  }
  return {};
}

// 1 barrier   2 copies, table of halves, residuals to zero   3 barrier   4 nodes of the sky, passes of inputs
// 5 barrier   6 steps of the plan with their barriers, outputs among them   7 barrier   8 report   9 barrier
void record_checked_frame(const SolverState& state, VkCommandBuffer commands, const FrameInputs& inputs,
                          const FrameOutputs& outputs) {
  const ScopedLabel label(state.functions, commands, "relume frame");
  FrameRecorder record(state, commands, *inputs.plan);
  record.barrier();
  record_inputs(state, commands, record, inputs);
  const FrameStep* before = nullptr;
  for (const FrameStep& step : inputs.plan->steps) {
    if (step.barrier_before || (before != nullptr && record.overlap(*before, step))) record.barrier();
    before = &step;
    if (step.kind == FrameStep::Kind::publish) {
      record_publish(state, commands, record, step.system, outputs);
    } else {
      record.step(step);
    }
  }
  record.barrier();
  if (outputs.report.buffer == VK_NULL_HANDLE) return;
  BufferRange residuals = state.ranges[kResiduals];
  residuals.byte_size = state.layout.residual_bytes();
  record.copy(residuals, outputs.report, 0);
  record.barrier();
}

}  // namespace relume
