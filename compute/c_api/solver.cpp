// SPDX-License-Identifier: MIT
#include <string>

#include "compute/c_api/handles.h"

using namespace relume;
using c_api::guarded;

namespace relume::c_api {

BufferAllocator allocator(relume_allocate allocate, void* user) {
  return [allocate, user](const BufferRequirement& wanted) -> Result<BufferRange> {
    const relume_buffer_requirement requirement{wanted.name.c_str(), wanted.byte_size, wanted.alignment,
                                                wanted.usage};
    relume_buffer_range range{};
    if (allocate(user, &requirement, &range) == 0) return from_c(range);
    return fail(ErrorCode::out_of_memory, "the host has no " + std::to_string(wanted.byte_size) +
                                              " bytes for the buffer '" + wanted.name + "'");
  };
}

Result<std::vector<BufferRange>> allocate_all(std::span<const BufferRequirement> requirements,
                                              const BufferAllocator& allocate) {
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& requirement : requirements) {
    auto range = allocate(requirement);
    if (!range) return tl::unexpected<Error>(range.error());
    ranges.push_back(*range);
  }
  return ranges;
}

Result<void> check_loaded(const relume_solver& solver, std::uint32_t system) {
  const std::size_t count = solver.model->systems.size();
  if (system < count && solver.solver.loaded(system)) return {};
  return fail(ErrorCode::usage, "system " + std::to_string(system) + " of " + std::to_string(count) +
                                    " is not loaded in the solver");
}

namespace {

HostDevice host_from_c(const relume_host& host) {
  return {host.instance,       host.physical_device,     host.device, host.get_instance_proc_addr,
          host.pipeline_cache, host.allocation_callbacks};
}

SolverOptions options_from_c(const relume_solver_options& options) {
  SolverOptions out;
  if (options.kernel != RELUME_KERNEL_DEFAULT)
    out.kernel = static_cast<RowKernel>(options.kernel - RELUME_ROW_PER_THREAD);
  if (options.fetch != RELUME_FETCH_DEFAULT)
    out.fetch = static_cast<MatrixFetch>(options.fetch - RELUME_FETCH_STORAGE);
  if (options.max_dispatch_form_factors > 0)
    out.max_dispatch_form_factors = options.max_dispatch_form_factors;
  out.sender_capacity = options.sender_capacity;
  out.half_senders_up_to = options.half_senders_up_to;
  if (options.lightings > 0) out.lightings = options.lightings;
  return out;
}

/// Buffers of the lights; those of the occluders are shared with the first.
Result<std::vector<BufferRange>> light_ranges(relume_solver& solver, const DirectLight& light,
                                              std::uint32_t system, const BufferAllocator& allocate) {
  std::vector<BufferRange> ranges = solver.occluders;
  for (std::size_t i = ranges.size(); i < light.buffers().size(); ++i) {
    if (i == kClusterLight) {
      ranges.push_back(solver.solver.input(system, Quantity::direct));
      continue;
    }
    auto range = allocate(light.buffers()[i]);
    if (!range) return tl::unexpected<Error>(range.error());
    ranges.push_back(*range);
  }
  return ranges;
}

DirectLightOptions light_options(std::uint32_t system, const relume_light_options* wanted) {
  DirectLightOptions options;
  options.systems = {system};
  if (wanted == nullptr) return options;
  if (wanted->max_lights > 0) options.max_lights = wanted->max_lights;
  options.max_pairs = wanted->max_pairs;
  if (wanted->patches_per_element > 0.0) options.patches_per_element = wanted->patches_per_element;
  if (wanted->by_mask != 0) options.visibility = LightVisibility::mask;
  return options;
}

Result<void> add_lights(relume_solver& solver, std::uint32_t system, const DirectLightOptions& options,
                        const BufferAllocator& allocate) {
  if (auto loaded = check_loaded(solver, system); !loaded) return loaded;
  if (solver.system_lights.count(system) > 0)
    return fail(ErrorCode::usage, "system " + std::to_string(system) + " has lights already");
  auto light = DirectLight::create(solver.host, *solver.model, options);
  if (!light) return tl::unexpected<Error>(light.error());
  auto ranges = light_ranges(solver, *light, system, allocate);
  if (!ranges) return tl::unexpected<Error>(ranges.error());
  if (auto bound = light->bind(*ranges); !bound) return bound;
  const bool first = solver.occluders.empty();
  LightSchedule schedule = light->make_schedule();
  if (auto set = schedule.set_lights(solver.lights); !set) return set;
  UploadData data = light->model_data(*solver.model, first);
  data.targets = *ranges;
  if (first) solver.occluders.assign(ranges->begin(), ranges->begin() + kLightPieces);
  auto lights = std::make_unique<SystemLights>(
      SystemLights{std::move(*light), std::move(schedule), options.visibility == LightVisibility::mask});
  SystemLights* at = lights.get();
  solver.system_lights.emplace(system, std::move(lights));
  solver.uploads.push_back({std::move(data), system, [at] { at->uploaded = true; }});
  return {};
}

Result<void> load(relume_solver& solver, std::uint32_t system, double max_albedo,
                  const BufferAllocator& allocate) {
  if (system >= solver.model->systems.size()) return check_loaded(solver, system);
  std::vector<Rgb> albedo;
  if (max_albedo > 0.0) albedo.assign(solver.model->systems[system].clusters.size(), Rgb(max_albedo));
  if (auto loaded = solver.solver.load(*solver.model, system, allocate, albedo); !loaded) return loaded;
  solver.uploads.push_back({solver.solver.system_data(*solver.model, system), system, [&solver, system] {
                              solver.before_plan.push_back([&solver, system] {
                                activate(solver.solver.traits(), solver.schedule, system);
                              });
                            }});
  return {};
}

}  // namespace
}  // namespace relume::c_api

relume_status relume_solver_create(const relume_host* host, const relume_model* model,
                                   const relume_solver_options* options, double largest_radiosity,
                                   relume_solver** solver, relume_error* error) {
  *solver = nullptr;
  return guarded(error, [&]() -> Result<void> {
    const HostDevice device = c_api::host_from_c(*host);
    auto made = GpuSolver::create(device, model->model,
                                  options != nullptr ? c_api::options_from_c(*options) : SolverOptions{});
    if (!made) return tl::unexpected<Error>(made.error());
    *solver = new relume_solver{device, &model->model, std::move(*made),
                                make_schedule(model->model.systems.size(), largest_radiosity)};
    return {};
  });
}

void relume_solver_destroy(relume_solver* solver) {
  delete solver;
}

relume_status relume_solver_bind(relume_solver* solver, relume_allocate allocate, void* user,
                                 relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto bound = solver->solver.bind(c_api::allocator(allocate, user)); !bound) return bound;
    solver->uploads.push_back({solver->solver.model_data(*solver->model)});
    return {};
  });
}

relume_status relume_load_system(relume_solver* solver, uint32_t system, double max_albedo,
                                 relume_allocate allocate, void* user, relume_error* error) {
  return guarded(error,
                 [&] { return c_api::load(*solver, system, max_albedo, c_api::allocator(allocate, user)); });
}

relume_status relume_add_lights(relume_solver* solver, uint32_t system, const relume_light_options* options,
                                relume_allocate allocate, void* user, relume_error* error) {
  return guarded(error, [&] {
    return c_api::add_lights(*solver, system, c_api::light_options(system, options),
                             c_api::allocator(allocate, user));
  });
}

relume_buffer_range relume_light_mask(const relume_solver* solver, uint32_t system) {
  const auto lights = solver->system_lights.find(system);
  if (lights == solver->system_lights.end() || !lights->second->by_mask) return {};
  return c_api::to_c(lights->second->light.buffer(kLightMask));
}

void relume_retrace_lights(relume_solver* solver, uint32_t system) {
  const auto lights = solver->system_lights.find(system);
  if (lights != solver->system_lights.end()) lights->second->schedule.retrace();
}

void relume_use_model(relume_solver* solver, const relume_model* model) {
  solver->model = &model->model;
}

void relume_device_lost(relume_solver* solver) {
  solver->solver.latch({ErrorCode::no_device, "the device was lost"});
}

void relume_deactivate_system(relume_solver* solver, uint32_t system) {
  solver->before_plan.push_back(
      [solver, system] { deactivate(solver->solver.traits(), solver->schedule, system); });
}

void relume_unload_system(relume_solver* solver, uint32_t system) {
  std::erase_if(solver->uploads, [system](const PendingUpload& upload) { return upload.system == system; });
  solver->system_lights.erase(system);
  solver->solver.unload(system);
}

relume_status relume_record_upload(relume_solver* solver, VkCommandBuffer commands,
                                   const relume_staging* staging, int* pending, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    *pending = 0;
    if (solver->uploads.empty()) return {};
    PendingUpload& upload = solver->uploads.front();
    if (solver->solver.record_upload(commands, upload.data, c_api::from_c(*staging), upload.cursor)) {
      if (upload.then) upload.then();
      solver->uploads.pop_front();
    }
    *pending = solver->uploads.empty() ? 0 : 1;
    return {};
  });
}
