// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <utility>

#include "compute/pass_buffers.h"
#include "compute/solver_state.h"

namespace relume {
namespace {

std::string name_of(std::uint32_t system) {
  return "system " + std::to_string(system);
}

Result<MatrixFetch> choose_fetch(const SolverState& state, const SystemLayout& layout) {
  const VkDeviceSize needed = largest_texel_buffer(state.layout, layout);
  const bool fits = needed <= state.max_texels;
  if (state.options.fetch == MatrixFetch::texels && !fits) {
    return fail(ErrorCode::no_device, "the matrices or senders need texel buffers of " +
                                          std::to_string(needed) + " elements, but the device has at most " +
                                          std::to_string(state.max_texels));
  }
  return state.options.fetch.value_or(fits ? MatrixFetch::texels : MatrixFetch::storage);
}

/// Places for both halves, where no more senders than the capacity are loaded with them.
std::optional<std::uint32_t> take_places(SolverState& state, std::uint32_t senders) {
  std::uint64_t loaded = senders;
  for (const auto& system : state.systems) loaded += system ? system->layout.senders() : 0;
  if (loaded > state.layout.sender_capacity) return std::nullopt;
  return state.senders.take(2 * senders);
}

void give_back_places(SolverState& state, std::uint32_t first_sender, std::uint32_t senders) {
  if (senders > 0) state.senders.give_back(first_sender - state.layout.sky_places());
}

}  // namespace

Result<void> add_pipelines(Pipelines& pipelines, const SystemDispatches& dispatches, RowKernel row_kernel) {
  for (std::size_t kernel = 0; kernel < kStepKernels; ++kernel) {
    for (const DispatchStep& step : dispatches[kernel]) {
      const KernelId id = step_kernel_id(static_cast<StepKernel>(kernel), row_kernel, step.format.tile_rows);
      if (auto added = pipelines.add(id, step.format); !added) return added;
    }
  }
  return {};
}

Result<std::vector<BufferRange>> allocate_ranges(std::span<const BufferRequirement> needed,
                                                 const BufferAllocator& allocate) {
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : needed) {
    auto range = allocate(buffer);
    if (!range) return tl::unexpected<Error>(range.error());
    ranges.push_back(*range);
  }
  return ranges;
}

void latch_failure(SolverState& state, const Error& error) {
  if (error.code != ErrorCode::out_of_memory && !state.failure) state.failure = error;
}

Result<SystemLayout> loadable_layout(const SolverState& state, const Model& model, std::uint32_t system) {
  if (state.failure) return tl::unexpected<Error>(*state.failure);
  if (model.systems.size() != state.layout.systems || model.sky_cells.size() != state.layout.sky_patches ||
      model.probe_names.size() != state.layout.probes ||
      model.sky_tree.nodes.size() != state.layout.sky_nodes) {
    return fail(ErrorCode::usage, "the model has " + std::to_string(model.systems.size()) + " systems and " +
                                      std::to_string(model.sky_cells.size()) +
                                      " sky patches; the solver was made for one with " +
                                      std::to_string(state.layout.systems) + " and " +
                                      std::to_string(state.layout.sky_patches));
  }
  if (system >= model.systems.size() || !model.systems[system].loaded) {
    return fail(ErrorCode::usage, "the model has no data of " + name_of(system));
  }
  if (state.systems[system]) return fail(ErrorCode::usage, name_of(system) + " is loaded already");
  return system_layout(model, system, state.limits);
}

Result<void> load_system(SolverState& state, const Model& model, std::uint32_t index,
                         std::span<const BufferRange> ranges, std::span<const Rgb> albedo) {
  auto layout = loadable_layout(state, model, index);
  if (!layout) return tl::unexpected<Error>(layout.error());
  auto exact = fit_ranges(layout->buffers, ranges);
  if (!exact) return tl::unexpected<Error>(exact.error());
  const auto fetch = choose_fetch(state, *layout);
  if (!fetch) return tl::unexpected<Error>(fetch.error());

  auto loaded = std::make_unique<LoadedSystem>();
  loaded->dispatches = plan_dispatches(model.systems[index], *layout, state.row_kernel, *fetch,
                                       std::max<std::uint64_t>(state.options.max_dispatch_form_factors, 1));
  if (auto added = add_pipelines(state.pipelines, loaded->dispatches, state.row_kernel); !added) {
    latch_failure(state, added.error());
    return added;
  }
  if (state.ranges.empty()) return fail(ErrorCode::usage, "buffers are bound before systems are loaded");
  const auto first = take_places(state, layout->senders());
  if (!first) {
    return fail(ErrorCode::out_of_memory,
                name_of(index) + " has " + std::to_string(layout->senders()) +
                    " senders, for which there is no room beside those that are loaded: sender_capacity is " +
                    std::to_string(state.layout.sender_capacity));
  }
  loaded->first_sender = state.layout.sky_places() + *first;
  auto sets = make_system_sets(
      state.host, state.functions, state.pipelines, *layout, *exact,
      radiosity_part(state.layout, state.ranges[kRadiosity], loaded->first_sender, 2 * layout->senders()),
      state.ranges[kProbeCoefficients], state.max_texels);
  if (!sets) {
    give_back_places(state, loaded->first_sender, layout->senders());
    latch_failure(state, sets.error());
    return tl::unexpected<Error>(sets.error());
  }
  loaded->sets = std::move(*sets);
  loaded->layout = std::move(*layout);
  loaded->ranges = std::move(*exact);
  state.traits[index] = system_traits(model, index, loaded->dispatches, albedo);
  state.systems[index] = std::move(loaded);
  return {};
}

void unload_system(SolverState& state, std::uint32_t index) {
  if (index >= state.systems.size() || !state.systems[index]) return;
  unload_rooms(state);
  const LoadedSystem& system = *state.systems[index];
  give_back_places(state, system.first_sender, system.layout.senders());
  state.systems[index].reset();
  state.traits[index] = {};
}

}  // namespace relume
