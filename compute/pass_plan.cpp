// SPDX-License-Identifier: MIT
#include "compute/pass_plan.h"

#include <algorithm>

#include "kernels/shared/limits.h"

namespace relume {
namespace {

std::uint32_t rows_per_workgroup(RowKernel kernel) {
  return kernel == RowKernel::row_per_thread ? kernels::kWorkgroupSize : kernels::kRowsPerWorkgroup;
}

/// The row after the last of a dispatch that starts at `first`.
std::uint32_t slice_end(const MatrixBlock& block, std::uint32_t first, std::uint64_t max_form_factors,
                        std::uint32_t max_rows) {
  const std::uint32_t last = first + std::min(block.row_count - first, max_rows);
  const auto begin = block.tile_offsets.begin();
  const std::uint64_t limit = block.tile_offsets[first] + max_form_factors;
  const auto above = std::upper_bound(begin + first + 1, begin + last + 1, limit);
  return std::max(static_cast<std::uint32_t>(above - begin) - 1, first + 1);
}

/// Cuts one block; `step` carries what all its dispatches share.
void append_block(Pass& pass, const MatrixBlock& block, DispatchStep step, RowKernel row_kernel,
                  std::uint64_t max_form_factors) {
  const std::uint32_t rows = rows_per_workgroup(row_kernel);
  for (std::uint32_t first = 0; first < block.row_count;) {
    const std::uint32_t end = slice_end(block, first, max_form_factors, kernels::kMaxWorkgroups * rows);
    step.range.first_row = first;
    step.range.count = end - first;
    step.workgroups = (end - first + rows - 1) / rows;
    step.cost = block.tile_offsets[end] - block.tile_offsets[first];
    // Rows read what imports wrote, and each writes a place of its own.
    step.barrier_before = !pass.empty() && pass.back().kernel == StepKernel::import_radiosity;
    pass.push_back(step);
    first = end;
  }
}

void append_imports(Pass& pass, const SolverLayout& layout) {
  for (std::uint32_t system = 0; system < layout.systems.size(); ++system) {
    DispatchStep step;
    step.system = system;
    step.range.count = layout.systems[system].imports;
    step.workgroups = workgroup_count(step.range.count);
    step.cost = step.range.count;
    if (step.workgroups > 0) pass.push_back(step);
  }
}

}  // namespace

std::uint32_t workgroup_count(std::uint64_t threads) {
  const std::uint64_t groups = (threads + kernels::kWorkgroupSize - 1) / kernels::kWorkgroupSize;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(groups, kernels::kMaxWorkgroups));
}

Pass plan_pass(const Model& model, const SolverLayout& layout, StepKernel kernel, RowKernel row_kernel,
               std::uint64_t max_form_factors) {
  Pass pass;
  append_imports(pass, layout);
  for (std::uint32_t system = 0; system < layout.systems.size(); ++system) {
    const BlockMatrix& matrix =
        kernel == StepKernel::bounce ? model.systems[system].bounce : model.systems[system].gather;
    DispatchStep step;
    step.kernel = kernel;
    step.system = system;
    step.range.first_cluster = layout.systems[system].first_cluster;
    for (step.block = 0; step.block < matrix.blocks.size(); ++step.block) {
      const MatrixBlock& block = matrix.blocks[step.block];
      step.codec = block.codec;
      step.range.block_row = block.first_row;
      append_block(pass, block, step, row_kernel, max_form_factors);
    }
  }
  return pass;
}

std::uint64_t pass_cost(const Pass& pass) {
  std::uint64_t cost = 0;
  for (const DispatchStep& step : pass) cost += step.cost;
  return cost;
}

}  // namespace relume
