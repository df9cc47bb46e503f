// SPDX-License-Identifier: MIT
#include <glm/geometric.hpp>
#include <span>

#include "compute/c_api/handles.h"

using namespace relume;
using c_api::from_c;
using c_api::guarded;
using c_api::to_c;

namespace relume::c_api {
namespace {

Light light_from_c(const relume_light& light) {
  Light out;
  out.type = static_cast<LightType>(light.type);
  out.intensity = Rgb(light.intensity[0], light.intensity[1], light.intensity[2]);
  out.position = {light.position[0], light.position[1], light.position[2]};
  out.direction = {light.direction[0], light.direction[1], light.direction[2]};
  out.range = light.range;
  out.inner_cone_angle = light.inner_cone_angle;
  out.outer_cone_angle = light.outer_cone_angle;
  return out;
}

/// Staging memory is a multiple of this, so that parts stay aligned.
constexpr VkDeviceSize kStagingAlignment = 16;

VkDeviceSize staging_of(const SystemLights& lights) {
  const VkDeviceSize bytes = lights.light.staging_bytes(lights.schedule.lights().size());
  return (bytes + kStagingAlignment - 1) / kStagingAlignment * kStagingAlignment;
}

bool has_work(const SystemLights& lights) {
  return lights.uploaded && !lights.schedule.complete();
}

/// Where each system's lights find their staging memory: what they need, and an equal share of the rest.
std::map<std::uint32_t, Staging> share_staging(const relume_solver& solver, const Staging& whole) {
  VkDeviceSize needed = 0, count = 0;
  for (const auto& [system, lights] : solver.system_lights) {
    if (!has_work(*lights)) continue;
    needed += staging_of(*lights);
    ++count;
  }
  std::map<std::uint32_t, Staging> parts;
  if (count == 0 || needed > whole.range.byte_size) return parts;
  const VkDeviceSize more = (whole.range.byte_size - needed) / count / kStagingAlignment * kStagingAlignment;
  VkDeviceSize at = 0;
  for (const auto& [system, lights] : solver.system_lights) {
    if (!has_work(*lights)) continue;
    const VkDeviceSize bytes = staging_of(*lights) + more;
    parts[system] = {{whole.range.buffer, whole.range.offset + at, bytes}, whole.mapped + at};
    at += bytes;
  }
  return parts;
}

Result<void> plan_frame(relume_solver& solver, const relume_frame_wishes& wishes) {
  if (solver.recorded) {
    // The last frame was dropped: what it traced is not there.
    for (const auto& [system, lights] : solver.system_lights) lights->schedule.retrace();
    solver.recorded = false;
  }
  for (const auto& change : solver.before_plan) change();
  solver.before_plan.clear();
  const double most = solver.schedule.largest_radiosity;
  for (const auto& [system, lights] : solver.system_lights)
    note_change(solver.solver.traits(), solver.schedule, system, lights->schedule.pending_change(most));
  FrameWishes wanted{.bounces = wishes.bounces, .display_step = wishes.display_step};
  if (wishes.max_form_factors > 0) wanted.max_form_factors = wishes.max_form_factors;
  solver.plan = solver.solver.plan(solver.schedule, wanted);
  return {};
}

Result<void> check_frame(const relume_solver& solver, const relume_frame& frame) {
  if (!solver.plan)
    return fail(ErrorCode::usage, "record_frame: there is no plan; relume_plan_frame makes one");
  if (solver.recorded) return fail(ErrorCode::usage, "record_frame: the plan was recorded already");
  for (const auto& [system, lights] : solver.system_lights) {
    if (!has_work(*lights)) continue;
    const VkDeviceSize needed = relume_light_staging_bytes(&solver);
    if (frame.staging.range.byte_size >= needed) continue;
    return fail(ErrorCode::usage, "record_frame: lights need " + std::to_string(needed) +
                                      " bytes of staging memory, found " +
                                      std::to_string(frame.staging.range.byte_size));
  }
  return {};
}

Result<void> record_frame(relume_solver& solver, VkCommandBuffer commands, const relume_frame& frame) {
  if (auto checked = check_frame(solver, frame); !checked) return checked;
  std::vector<InputCopy> copies;
  for (const relume_input_copy& copy : std::span(frame.copies, frame.copy_count))
    copies.push_back({static_cast<Quantity>(copy.quantity), copy.system, copy.first, from_c(copy.source)});
  std::vector<IrradianceTarget> irradiance;
  for (const relume_irradiance_target& target : std::span(frame.irradiance, frame.irradiance_count))
    irradiance.push_back({target.system, from_c(target.target)});
  std::vector<LightmapOutput> lightmaps;
  for (const relume_lightmap* lightmap : std::span(frame.lightmaps, frame.lightmap_count))
    lightmaps.push_back({lightmap->system, &lightmap->pass});
  const std::map<std::uint32_t, Staging> staging = share_staging(solver, from_c(frame.staging));
  const std::uint64_t rays = frame.max_rays > 0 ? frame.max_rays : ~std::uint64_t{0};
  const auto write_inputs = [&](VkCommandBuffer into, std::uint32_t system) {
    const auto part = staging.find(system);
    if (part == staging.end()) return;
    SystemLights& lights = *solver.system_lights.at(system);
    lights.light.record(into, lights.schedule, part->second, rays);
  };
  auto recorded = solver.solver.record_frame(
      commands, {.plan = &*solver.plan, .copies = copies, .write_inputs = write_inputs},
      {.lightmaps = lightmaps, .irradiance = irradiance});
  solver.recorded = recorded.has_value();
  return recorded;
}

}  // namespace
}  // namespace relume::c_api

relume_status relume_set_lights(relume_solver* solver, const relume_light* lights, uint32_t count,
                                relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    std::vector<Light> wanted;
    for (const relume_light& light : std::span(lights, count)) wanted.push_back(c_api::light_from_c(light));
    for (const auto& [system, of_system] : solver->system_lights) {
      if (auto set = of_system->schedule.set_lights(wanted); !set) return set;
    }
    solver->lights = std::move(wanted);
    return {};
  });
}

void relume_note_change(relume_solver* solver, uint32_t system, double change) {
  solver->before_plan.push_back(
      [solver, system, change] { note_change(solver->solver.traits(), solver->schedule, system, change); });
}

relume_buffer_range relume_input(const relume_solver* solver, uint32_t system, relume_quantity quantity) {
  const bool sky = quantity == RELUME_SKY && system == solver->model->systems.size();
  if (!sky && !c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.input(system, static_cast<Quantity>(quantity)));
}

relume_buffer_range relume_radiosity(const relume_solver* solver, uint32_t system) {
  if (!c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.radiosity(system, solver->schedule.systems[system].half));
}

relume_buffer_range relume_irradiance(const relume_solver* solver, uint32_t system) {
  if (!c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.irradiance(system));
}

relume_buffer_range relume_direct_irradiance(const relume_solver* solver, uint32_t system) {
  const auto lights = solver->system_lights.find(system);
  if (lights == solver->system_lights.end()) return {};
  return to_c(lights->second->light.gather_light());
}

VkDeviceSize relume_light_staging_bytes(const relume_solver* solver) {
  VkDeviceSize bytes = 0;
  for (const auto& [system, lights] : solver->system_lights) bytes += c_api::staging_of(*lights);
  return bytes;
}

relume_status relume_plan_frame(relume_solver* solver, const relume_frame_wishes* wishes,
                                relume_frame_report* report, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto planned = c_api::plan_frame(*solver, *wishes); !planned) return planned;
    const FramePlan& plan = *solver->plan;
    if (report != nullptr)
      *report = {plan.cost, plan.radiosity_error, plan.output_error, plan.skipped,
                 plan.pass_complete ? 1 : 0};
    return {};
  });
}

relume_status relume_record_frame(relume_solver* solver, VkCommandBuffer commands, const relume_frame* frame,
                                  relume_error* error) {
  return guarded(error, [&] { return c_api::record_frame(*solver, commands, *frame); });
}

void relume_frame_submitted(relume_solver* solver) {
  if (!solver->recorded) return;
  solver->schedule = std::move(solver->plan->next);
  solver->plan.reset();
  solver->recorded = false;
}

int relume_frame_publishes(const relume_solver* solver, uint32_t system) {
  return solver->plan && publishes(*solver->plan, system) ? 1 : 0;
}

int relume_lights_pending(const relume_solver* solver) {
  for (const auto& [system, lights] : solver->system_lights) {
    if (!lights->schedule.complete()) return 1;
  }
  return 0;
}
