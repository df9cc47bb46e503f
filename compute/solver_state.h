// SPDX-License-Identifier: MIT
//
// What a GpuSolver holds.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "compute/descriptor_sets.h"
#include "compute/device_functions.h"
#include "compute/gpu_solver.h"
#include "compute/pass_plan.h"
#include "compute/pipelines.h"
#include "compute/room_tables.h"
#include "compute/sender_ranges.h"
#include "compute/solver_layout.h"

namespace relume {

struct LoadedSystem {
  SystemLayout layout;
  SystemDispatches dispatches;
  std::vector<BufferRange> ranges;  ///< per buffer of the layout
  SystemSets sets;
  std::uint32_t first_sender = 0;  ///< of half 0; half 1 follows it

  std::uint32_t first_of_half(std::uint32_t half) const { return first_sender + half * layout.senders(); }
};

struct SolverState {
  HostDevice host;
  DeviceFunctions functions;
  SolverOptions options;
  RowKernel row_kernel;
  LayoutLimits limits;
  VkDeviceSize max_texels;  ///< of a texel buffer
  SolverLayout layout;
  Pipelines pipelines;
  std::vector<DispatchStep> sky_small_nodes;
  std::vector<DispatchStep> sky_nodes;
  SenderRanges senders;
  std::vector<BufferRange> ranges;  ///< per buffer of the layout; empty until bound
  SolveSets sets;
  std::vector<std::unique_ptr<LoadedSystem>> systems;  ///< null: not loaded
  std::vector<SystemTraits> traits;                    ///< per system
  std::optional<Error> failure;                        ///< the device was lost
  std::optional<RoomSets> rooms;                       ///< the level above the bounces
};

/// Asks for one range after the other.
Result<std::vector<BufferRange>> allocate_ranges(std::span<const BufferRequirement> needed,
                                                 const BufferAllocator& allocate);

/// Keeps the first error of a call of Vulkan that was not about memory: the device is lost.
void latch_failure(SolverState& state, const Error& error);

/// See GpuSolver.
Result<SystemLayout> loadable_layout(const SolverState& state, const Model& model, std::uint32_t system);
Result<void> load_system(SolverState& state, const Model& model, std::uint32_t system,
                         std::span<const BufferRange> ranges, std::span<const Rgb> albedo);
void unload_system(SolverState& state, std::uint32_t system);
/// The pipelines of a system's dispatches.
Result<void> add_pipelines(Pipelines& pipelines, const SystemDispatches& dispatches, RowKernel row_kernel);
Result<void> load_rooms(SolverState& state, const RoomTables& tables, std::span<const BufferRange> ranges);
void unload_rooms(SolverState& state);
BufferRange input_range(const SolverState& state, std::uint32_t system, Quantity quantity,
                        std::uint32_t lighting);
Result<void> check_frame(const SolverState& state, const FrameInputs& inputs, const FrameOutputs& outputs);
void record_checked_frame(const SolverState& state, VkCommandBuffer commands, const FrameInputs& inputs,
                          const FrameOutputs& outputs);

}  // namespace relume
