// SPDX-License-Identifier: MIT
#include "compute/pass_plan.h"

#include <algorithm>
#include <utility>

#include "kernels/shared/limits.h"

namespace relume {
namespace {

std::uint32_t rows_per_workgroup(RowKernel kernel) {
  return kernel == RowKernel::row_per_8_lanes ? kernels::kRowsPerWorkgroup : kernels::kWorkgroupSize;
}

std::uint32_t sweeps_of(RowKernel kernel) {
  return kernel == RowKernel::tile_shared || kernel == RowKernel::tile_shuffle ? kernels::kSweeps : 1;
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
void append_block(std::vector<DispatchStep>& steps, const MatrixBlock& block, DispatchStep step,
                  RowKernel row_kernel, std::uint64_t max_form_factors) {
  const RowKernel kernel = row_kernel_for(row_kernel, block.tile_rows);
  step.sweeps = sweeps_of(kernel);
  const std::uint32_t rows = rows_per_workgroup(kernel) * step.sweeps;
  const std::uint32_t max_tiles = kernels::kMaxWorkgroups * (rows / block.tile_rows);
  for (std::uint32_t tile = 0; tile + 1 < block.tile_offsets.size();) {
    const std::uint32_t end = slice_end(block, tile, max_form_factors, max_tiles);
    step.range.first_row = tile * block.tile_rows;
    step.range.count = std::min(end * block.tile_rows, block.row_count) - step.range.first_row;
    step.workgroups = (step.range.count + rows - 1) / rows;
    step.cost = std::uint64_t{block.tile_offsets[end] - block.tile_offsets[tile]} * block.tile_rows;
    steps.push_back(step);
    tile = end;
  }
}

std::vector<DispatchStep> plan_rows(const BlockMatrix& matrix, RowKernel row_kernel, MatrixFetch fetch,
                                    std::uint64_t max_form_factors) {
  std::vector<DispatchStep> steps;
  DispatchStep step;
  for (step.block = 0; step.block < matrix.blocks.size(); ++step.block) {
    const MatrixBlock& block = matrix.blocks[step.block];
    step.format = {block.codec, block.tile_rows, fetch};
    step.range.block_row = block.first_row;
    append_block(steps, block, step, row_kernel, max_form_factors);
  }
  return steps;
}

/// Of the blocks that have directions.
std::vector<DispatchStep> plan_directions(const BlockMatrix& gather, std::uint32_t gather_rows,
                                          MatrixFetch fetch, std::uint64_t max_form_factors) {
  std::vector<DispatchStep> steps;
  for (DispatchStep step : plan_rows(gather, RowKernel::row_per_8_lanes, fetch,
                                     std::max<std::uint64_t>(max_form_factors / kDirectionCost, 1))) {
    if (gather.blocks[step.block].directions.empty()) continue;
    step.range.first_sender = gather.blocks[step.block].row_count;
    step.range.block_row =
        gather_rows + static_cast<std::uint32_t>(kMomentBytes / kRgbBytes) * step.range.block_row;
    step.cost *= kDirectionCost;
    steps.push_back(step);
  }
  return steps;
}

std::vector<DispatchStep> plan_probes(const System& system, const std::vector<ProbeBlockLayout>& blocks,
                                      std::uint64_t max_form_factors) {
  constexpr std::uint32_t kMost = kernels::kMaxWorkgroups * kernels::kProbesPerWorkgroup;
  std::vector<DispatchStep> steps;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    for (std::uint32_t p = 0; p < blocks[b].probe_count; ++p) {
      const std::uint64_t cost = system.probes[blocks[b].first_probe + p].sender_count * kProbeEntryCost;
      const bool full =
          p == 0 || steps.back().cost + cost > max_form_factors || steps.back().range.count == kMost;
      if (full) {
        steps.emplace_back().range.first_row = p;
        steps.back().block = b;
      }
      DispatchStep& step = steps.back();
      step.cost += cost;
      ++step.range.count;
      step.workgroups = (step.range.count + kernels::kProbesPerWorkgroup - 1) / kernels::kProbesPerWorkgroup;
    }
  }
  return steps;
}

/// Clusters whose maxima an invocation finds, before it raises those of its workgroup.
constexpr std::uint32_t kClustersOfMaxima = 8;

/// One dispatch over elements, each read once, so many by an invocation; its kernel strides when they are
/// more than the workgroups.
std::vector<DispatchStep> plan_elements(std::uint32_t count, std::uint64_t cost, MatrixFetch fetch,
                                        std::uint32_t each = 1) {
  if (count == 0) return {};
  DispatchStep step;
  step.format.fetch = fetch;
  step.range.count = count;
  step.workgroups = workgroup_count((count + each - 1) / each);
  step.cost = cost;
  return {step};
}

std::vector<DispatchStep> plan_node_range(const NodeTables& tables, std::uint32_t begin, std::uint32_t end,
                                          std::uint32_t nodes_of_group, MatrixFetch fetch) {
  const std::uint32_t most = kernels::kMaxWorkgroups * nodes_of_group;
  std::vector<DispatchStep> steps;
  for (std::uint32_t first = begin; first < end; first += most) {
    DispatchStep step;
    step.format.fetch = fetch;
    step.range = {first, std::min(most, end - first), 0, 0};
    step.workgroups = (step.range.count + nodes_of_group - 1) / nodes_of_group;
    for (std::uint32_t i = first; i < first + step.range.count; ++i) step.cost += tables.records[i].y;
    steps.push_back(step);
  }
  return steps;
}

}  // namespace

RowKernel row_kernel_for(RowKernel chosen, std::uint32_t tile_rows) {
  const bool of_tiles = chosen == RowKernel::tile_shared || chosen == RowKernel::tile_shuffle;
  return of_tiles && tile_rows != kernels::kTileOfRows ? RowKernel::row_per_8_lanes : chosen;
}

std::uint32_t workgroup_count(std::uint64_t threads) {
  const std::uint64_t groups = (threads + kernels::kWorkgroupSize - 1) / kernels::kWorkgroupSize;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(groups, kernels::kMaxWorkgroups));
}

void spread_over_lightings(std::vector<DispatchStep>& steps, std::uint32_t lightings) {
  for (DispatchStep& step : steps) {
    step.lightings = lightings;
    step.cost *= lightings;
  }
}

std::vector<DispatchStep> plan_small_nodes(const NodeTables& tables, MatrixFetch fetch) {
  return plan_node_range(tables, 0, tables.small, kernels::kWorkgroupSize, fetch);
}

std::vector<DispatchStep> plan_nodes(const NodeTables& tables, RowKernel row_kernel, MatrixFetch fetch) {
  const bool shuffles = row_kernel == RowKernel::tile_shuffle;
  return plan_node_range(tables, tables.small, static_cast<std::uint32_t>(tables.records.size()),
                         shuffles ? kernels::kWorkgroupSize : kernels::kRowsPerWorkgroup, fetch);
}

SystemDispatches plan_dispatches(const System& system, const SystemLayout& layout, RowKernel row_kernel,
                                 MatrixFetch fetch, std::uint64_t max_form_factors) {
  SystemDispatches all;
  const std::uint64_t most = std::max<std::uint64_t>(max_form_factors / layout.lightings, 1);
  // Kernels of layers do a lighting in each; the others do all in an invocation.
  const auto set_layers = [&](StepKernel kernel, std::vector<DispatchStep> steps) {
    spread_over_lightings(steps, layout.lightings);
    all[static_cast<std::size_t>(kernel)] = std::move(steps);
  };
  const auto set = [&](StepKernel kernel, std::vector<DispatchStep> steps) {
    for (DispatchStep& step : steps) step.cost *= layout.lightings;
    all[static_cast<std::size_t>(kernel)] = std::move(steps);
  };
  set_layers(StepKernel::start, plan_elements(layout.clusters, layout.clusters, fetch));
  set(StepKernel::import_radiosity,
      plan_elements(layout.imports, layout.imports + layout.import_parts, fetch));
  set(StepKernel::bounce, plan_rows(system.bounce, row_kernel, fetch, most));
  const NodeTables nodes = node_tables(system.tree, layout.clusters);
  set(StepKernel::small_nodes, plan_small_nodes(nodes, fetch));
  set(StepKernel::nodes, plan_nodes(nodes, row_kernel, fetch));
  set_layers(StepKernel::residual, plan_elements(layout.clusters, layout.clusters, fetch, kClustersOfMaxima));
  set(StepKernel::gather, plan_rows(system.gather, row_kernel, fetch, most));
  set_layers(StepKernel::directions, plan_directions(system.gather, layout.gather_rows, fetch, most));
  set_layers(StepKernel::probes, plan_probes(system, layout.probes, most));
  return all;
}

std::uint64_t dispatch_cost(const std::vector<DispatchStep>& dispatches) {
  std::uint64_t cost = 0;
  for (const DispatchStep& step : dispatches) cost += step.cost;
  return cost;
}

}  // namespace relume
