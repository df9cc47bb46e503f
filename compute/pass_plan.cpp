// SPDX-License-Identifier: MIT
#include "compute/pass_plan.h"

#include <algorithm>

#include "core/sender_leaves.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

std::uint32_t rows_per_workgroup(RowKernel kernel) {
  return kernel == RowKernel::row_per_thread ? kernels::kWorkgroupSize : kernels::kRowsPerWorkgroup;
}

/// The tile after the last of a dispatch that starts at tile `first`.
std::uint32_t slice_end(const MatrixBlock& block, std::uint32_t first, std::uint64_t max_form_factors,
                        std::uint32_t max_tiles) {
  const auto tiles = static_cast<std::uint32_t>(block.tile_offsets.size() - 1);
  const std::uint32_t last = first + std::min(tiles - first, max_tiles);
  const auto begin = block.tile_offsets.begin();
  const std::uint64_t limit = block.tile_offsets[first] + max_form_factors / block.tile_rows;
  const auto above = std::upper_bound(begin + first + 1, begin + last + 1, limit);
  return std::max(static_cast<std::uint32_t>(above - begin) - 1, first + 1);
}

/// Cuts one block between tiles; `step` carries what all its dispatches share.
void append_block(Pass& pass, const MatrixBlock& block, DispatchStep step, RowKernel row_kernel,
                  std::uint64_t max_form_factors) {
  const std::uint32_t rows = rows_per_workgroup(row_kernel);
  const std::uint32_t max_tiles = kernels::kMaxWorkgroups * rows / block.tile_rows;
  for (std::uint32_t tile = 0; tile + 1 < block.tile_offsets.size();) {
    const std::uint32_t end = slice_end(block, tile, max_form_factors, max_tiles);
    step.range.first_row = tile * block.tile_rows;
    step.range.count = std::min(end * block.tile_rows, block.row_count) - step.range.first_row;
    step.workgroups = (step.range.count + rows - 1) / rows;
    step.cost = std::uint64_t{block.tile_offsets[end] - block.tile_offsets[tile]} * block.tile_rows;
    // Rows read what imports wrote, and each writes a place of its own.
    step.barrier_before = !pass.empty() && pass.back().kernel == StepKernel::import_radiosity;
    pass.push_back(step);
    tile = end;
  }
}

void append_imports(Pass& pass, const Model& model, const SolverLayout& layout) {
  const LeafNumbers numbers(model);
  for (std::uint32_t system = 0; system < layout.systems.size(); ++system) {
    DispatchStep step;
    step.system = system;
    step.range.count = layout.systems[system].imports;
    step.workgroups = (step.range.count + kernels::kRowsPerWorkgroup - 1) / kernels::kRowsPerWorkgroup;
    for (const SenderRef& sender : model.systems[system].imports) {
      for (const LeafRange& range : numbers.leaves_of(sender).ranges) step.cost += range.count;
    }
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
  append_imports(pass, model, layout);
  for (std::uint32_t system = 0; system < layout.systems.size(); ++system) {
    const BlockMatrix& matrix =
        kernel == StepKernel::bounce ? model.systems[system].bounce : model.systems[system].gather;
    DispatchStep step;
    step.kernel = kernel;
    step.system = system;
    step.range.first_cluster = layout.systems[system].first_cluster;
    for (step.block = 0; step.block < matrix.blocks.size(); ++step.block) {
      const MatrixBlock& block = matrix.blocks[step.block];
      step.format = {block.codec, block.tile_rows};
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
