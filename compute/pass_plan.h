// SPDX-License-Identifier: MIT
//
// The dispatches of a system, cut so that none takes long.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "compute/node_tables.h"
#include "compute/solver_layout.h"
#include "compute/solver_options.h"
#include "core/model.h"
#include "kernels/shared/records.h"

namespace relume {

/// What a dispatch does, in the order of a pass (compute/schedule.h).
enum class StepKernel : std::uint32_t {
  start,
  import_radiosity,
  bounce,
  small_nodes,
  nodes,
  residual,
  gather,
  directions,
  probes,
  restrict_rooms,
  solve_rooms,
  correct_rooms
};
inline constexpr std::size_t kStepKernels = 12;

/// What a row kernel is compiled for.
struct BlockFormat {
  ValueCodec codec = ValueCodec::f32;
  std::uint32_t tile_rows = 1;
  MatrixFetch fetch = MatrixFetch::storage;
  friend auto operator<=>(const BlockFormat&, const BlockFormat&) = default;
};

/// One dispatch. What depends on the half in range is filled in when it is recorded.
struct DispatchStep {
  BlockFormat format{};
  std::uint32_t block = 0;  ///< of the bounce or gather matrix, or of the probes
  kernels::Range range{};
  std::uint32_t workgroups = 0;
  std::uint32_t sweeps = 1;     ///< workgroups along y: see kernels::kSweeps
  std::uint32_t lightings = 1;  ///< workgroups along z, of a kernel that does one lighting each
  /// Of all lightings together: form factors, zeros of tiles included; of directions, three times as many; of
  /// probes, kProbeEntryCost for each entry of their lists; of other kernels, the vec4 that they read.
  std::uint64_t cost = 0;
};

/// A direction has three values.
inline constexpr std::uint64_t kDirectionCost = 3;

/// An entry of a probe has nine values.
inline constexpr std::uint64_t kProbeEntryCost = 9;

/// Per kernel. Dispatches of one kernel need no barriers between them.
using SystemDispatches = std::array<std::vector<DispatchStep>, kStepKernels>;

inline const std::vector<DispatchStep>& dispatches_of(const SystemDispatches& all, StepKernel kernel) {
  return all[static_cast<std::size_t>(kernel)];
}

/// The kernel that does blocks of tiles of `tile_rows` rows where `chosen` was chosen.
RowKernel row_kernel_for(RowKernel chosen, std::uint32_t tile_rows);

/// Workgroups that give `threads` invocations, at most kernels::kMaxWorkgroups.
std::uint32_t workgroup_count(std::uint64_t threads);

/// Rows are cut into dispatches of at most `max_form_factors` form factors, but at least one tile, or probe;
/// a kernel without elements has no dispatch.
SystemDispatches plan_dispatches(const System& system, const SystemLayout& layout, RowKernel row_kernel,
                                 MatrixFetch fetch, std::uint64_t max_form_factors);

/// The dispatches that bring the small nodes of a tree up to date, or, after them, the large ones.
std::vector<DispatchStep> plan_small_nodes(const NodeTables& tables, MatrixFetch fetch);
std::vector<DispatchStep> plan_nodes(const NodeTables& tables, RowKernel row_kernel, MatrixFetch fetch);

/// From one lighting to all, of a kernel that does them in a layer of workgroups each.
void spread_over_lightings(std::vector<DispatchStep>& steps, std::uint32_t lightings);

/// Sum of costs.
std::uint64_t dispatch_cost(const std::vector<DispatchStep>& dispatches);

}  // namespace relume
