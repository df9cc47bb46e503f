// SPDX-License-Identifier: MIT
#include <utility>

#include "compute/pass_buffers.h"
#include "compute/solver_state.h"

namespace relume {
namespace {

DispatchStep step_of(std::uint32_t count, std::uint32_t block_row, std::uint32_t workgroups,
                     std::uint64_t cost) {
  DispatchStep step;
  step.range.count = count;
  step.range.block_row = block_row;
  step.workgroups = workgroups;
  step.cost = cost;
  return step;
}

/// What the rooms ask of system `s`; the equations are solved with the first.
SystemDispatches dispatches_of_rooms(const RoomTables& tables, std::uint32_t s, MatrixFetch fetch,
                                     std::uint32_t lightings, bool first) {
  SystemDispatches all;
  const auto add = [&all](StepKernel kernel, const DispatchStep& step) {
    all[static_cast<std::size_t>(kernel)].push_back(step);
  };
  const std::uint32_t segments = tables.first_segment[s + 1] - tables.first_segment[s];
  const std::uint32_t clusters = tables.first_cluster[s + 1] - tables.first_cluster[s];
  std::uint64_t entries = 0;
  for (std::uint32_t i = tables.first_segment[s]; i < tables.first_segment[s + 1]; ++i)
    entries += tables.segments[i].y;
  if (segments > 0) {
    DispatchStep step = step_of(s, tables.first_segment[s], segments, entries);
    step.format.fetch = fetch;
    add(StepKernel::restrict_rooms, step);
  }
  if (first) {
    const auto systems = static_cast<std::uint32_t>(tables.first_cluster.size() - 1);
    const std::uint64_t rooms = tables.rooms;
    add(StepKernel::solve_rooms, step_of(systems, tables.rooms, 1, rooms * rooms * (rooms + systems)));
  }
  if (clusters > 0) {
    add(StepKernel::correct_rooms,
        step_of(clusters, tables.first_cluster[s], workgroup_count(clusters), clusters));
  }
  for (std::vector<DispatchStep>& steps : all) spread_over_lightings(steps, lightings);
  return all;
}

/// As the rest of the system is read, if the entries fit as well.
MatrixFetch fetch_of(const SolverState& state, const RoomTables& tables, const LoadedSystem& system) {
  const auto& imports = dispatches_of(system.dispatches, StepKernel::import_radiosity);
  const bool fits = tables.entries.size() <= state.max_texels;
  return fits && !imports.empty() ? imports[0].format.fetch : MatrixFetch::storage;
}

void set_dispatches(LoadedSystem& system, SystemTraits& traits, SystemDispatches dispatches) {
  for (const StepKernel kernel :
       {StepKernel::restrict_rooms, StepKernel::solve_rooms, StepKernel::correct_rooms}) {
    const auto k = static_cast<std::size_t>(kernel);
    traits.costs[k].clear();
    for (const DispatchStep& step : dispatches[k]) traits.costs[k].push_back(step.cost);
    system.dispatches[k] = std::move(dispatches[k]);
  }
}

}  // namespace

Result<void> load_rooms(SolverState& state, const RoomTables& tables, std::span<const BufferRange> ranges) {
  for (std::uint32_t s = 0; s < state.systems.size(); ++s) {
    const std::uint32_t clusters = tables.first_cluster[s + 1] - tables.first_cluster[s];
    if (clusters != (state.systems[s] ? state.systems[s]->layout.clusters : 0)) {
      return fail(ErrorCode::usage, "the rooms are of other systems than those that are loaded");
    }
  }
  auto exact = fit_ranges(room_buffers(tables, state.layout.lightings), ranges);
  if (!exact) return tl::unexpected<Error>(exact.error());
  auto sets = make_room_sets(state.host, state.functions, state.pipelines, *exact, state.max_texels);
  if (!sets) return tl::unexpected<Error>(sets.error());
  bool first = true;
  for (std::uint32_t s = 0; s < state.systems.size(); ++s) {
    if (!state.systems[s]) continue;
    SystemDispatches dispatches = dispatches_of_rooms(tables, s, fetch_of(state, tables, *state.systems[s]),
                                                      state.layout.lightings, std::exchange(first, false));
    if (auto added = add_pipelines(state.pipelines, dispatches, state.row_kernel); !added) return added;
    set_dispatches(*state.systems[s], state.traits[s], std::move(dispatches));
  }
  state.rooms = std::move(*sets);
  return {};
}

void unload_rooms(SolverState& state) {
  state.rooms.reset();
  for (std::uint32_t s = 0; s < state.systems.size(); ++s) {
    if (state.systems[s]) set_dispatches(*state.systems[s], state.traits[s], {});
  }
}

}  // namespace relume
