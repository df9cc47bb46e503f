// SPDX-License-Identifier: MIT
//
// The dispatches of a pass, cut so that none takes long.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "compute/gpu_solver.h"
#include "compute/solver_layout.h"
#include "core/model.h"
#include "kernels/shared/records.h"

namespace relume {

enum class StepKernel : std::uint32_t { import_radiosity, bounce, gather };

/// What a row kernel is compiled for.
struct BlockFormat {
  ValueCodec codec = ValueCodec::f32;
  std::uint32_t tile_rows = 1;
  friend auto operator<=>(const BlockFormat&, const BlockFormat&) = default;
};

/// One dispatch.
struct DispatchStep {
  StepKernel kernel = StepKernel::import_radiosity;
  BlockFormat format{};
  std::uint32_t system = 0;
  std::uint32_t block = 0;  ///< of the system's bounce or gather matrix
  kernels::Range range{};
  std::uint32_t workgroups = 0;
  std::uint64_t cost = 0;       ///< form factors, zeros of tiles included (leaves for an import)
  bool barrier_before = false;  ///< it must see what earlier steps of the pass wrote
};

using Pass = std::vector<DispatchStep>;

/// Workgroups that give `threads` invocations, at most kernels::kMaxWorkgroups.
std::uint32_t workgroup_count(std::uint64_t threads);

/// A bounce (`kernel` bounce: rows of the bounce matrices) or a gather (rows of the gather matrices) of all
/// systems: imports first, then rows. Rows are cut into dispatches of at most `max_form_factors` form
/// factors, but at least one tile.
Pass plan_pass(const Model& model, const SolverLayout& layout, StepKernel kernel, RowKernel row_kernel,
               std::uint64_t max_form_factors);

/// Sum of the costs of a pass.
std::uint64_t pass_cost(const Pass& pass);

}  // namespace relume
