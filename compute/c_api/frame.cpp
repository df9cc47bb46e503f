// SPDX-License-Identifier: MIT
#include <glm/geometric.hpp>
#include <span>

#include "compute/c_api/handles.h"
#include "kernels/shared/records.h"

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

/// What goes before any plan.
void settle_changes(relume_solver& solver) {
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
}

FramePlan plan_frame(const relume_solver& solver, const relume_frame_wishes& wishes) {
  FrameWishes wanted{.bounces = wishes.bounces, .display_step = wishes.display_step};
  if (wishes.max_form_factors > 0) wanted.max_form_factors = wishes.max_form_factors;
  return solver.solver.plan(solver.schedule, wanted);
}

FramePlan plan_together(const relume_solver& solver, const relume_pass_wishes& wishes) {
  PassWishes wanted;
  wanted.restart = wishes.restart != 0;
  wanted.bounces = wishes.bounces;
  wanted.residual = wishes.residual != 0;
  wanted.gather = wishes.gather != 0;
  wanted.tolerance = wishes.tolerance;
  if (wishes.max_form_factors > 0) wanted.max_form_factors = wishes.max_form_factors;
  return solver.solver.plan(solver.schedule, wanted);
}

/// Takes the plan of either kind of wishes.
template <class Plan, class Wishes>
relume_status take_plan(relume_solver& solver, const Plan& plan, const Wishes& wishes,
                        relume_frame_report* report, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    settle_changes(solver);
    solver.plan = plan(solver, wishes);
    const FramePlan& made = *solver.plan;
    if (report != nullptr)
      *report = {made.cost, made.radiosity_error, made.output_error, made.skipped,
                 made.pass_complete ? 1 : 0};
    return {};
  });
}

/// Fails when what a pass reads is not on the device.
Result<void> check_uploaded(bool uploaded, const char* what, std::uint32_t system) {
  if (uploaded) return {};
  return fail(ErrorCode::usage, std::string("record_frame: the ") + what + " of system " +
                                    std::to_string(system) +
                                    " must be bound, and relume_record_upload must have finished");
}

Result<void> check_passes(const relume_frame& frame) {
  for (const relume_lightmap* pass : std::span(frame.lightmaps, frame.lightmap_count)) {
    if (auto there = check_uploaded(pass->uploaded, "lightmap", pass->system); !there) return there;
  }
  for (const relume_materials* pass : std::span(frame.materials, frame.material_count)) {
    if (auto there = check_uploaded(pass->uploaded, "materials", pass->system); !there) return there;
  }
  for (const relume_screen_frame& shown : std::span(frame.screens, frame.screen_count)) {
    const relume_screen& pass = *shown.screen;
    if (auto there = check_uploaded(pass.uploaded, "screen", pass.system); !there) return there;
    if (shown.image < pass.images) continue;
    return fail(ErrorCode::usage, "record_frame: image " + std::to_string(shown.image) +
                                      " of a screen that has " + std::to_string(pass.images));
  }
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
  return check_passes(frame);
}

Result<void> record_frame(relume_solver& solver, VkCommandBuffer commands, const relume_frame& frame) {
  if (auto checked = check_frame(solver, frame); !checked) return checked;
  std::vector<InputCopy> copies;
  for (const relume_input_copy& copy : std::span(frame.copies, frame.copy_count))
    copies.push_back(
        {static_cast<Quantity>(copy.quantity), copy.system, copy.first, from_c(copy.source), copy.lighting});
  std::vector<IrradianceTarget> irradiance;
  for (const relume_irradiance_target& target : std::span(frame.irradiance, frame.irradiance_count))
    irradiance.push_back({target.system, from_c(target.target), target.lighting});
  std::vector<LightmapOutput> lightmaps;
  for (const relume_lightmap* lightmap : std::span(frame.lightmaps, frame.lightmap_count))
    lightmaps.push_back({lightmap->system, &lightmap->pass});
  std::vector<const MaterialPass*> materials;
  for (const relume_materials* pass : std::span(frame.materials, frame.material_count))
    materials.push_back(&pass->pass);
  std::vector<ScreenFrame> screens;
  for (const auto& [screen, image, factor] : std::span(frame.screens, frame.screen_count))
    screens.push_back({&screen->pass, image, Rgb(factor[0], factor[1], factor[2])});
  const std::map<std::uint32_t, Staging> staging = share_staging(solver, from_c(frame.staging));
  const std::uint64_t rays = frame.max_rays > 0 ? frame.max_rays : ~std::uint64_t{0};
  const auto write_inputs = [&](VkCommandBuffer into, std::uint32_t system) {
    const auto part = staging.find(system);
    if (part == staging.end()) return;
    SystemLights& lights = *solver.system_lights.at(system);
    lights.light.record(into, lights.schedule, part->second, rays);
  };
  auto recorded = solver.solver.record_frame(
      commands,
      {.plan = &*solver.plan,
       .copies = copies,
       .materials = materials,
       .screens = screens,
       .write_inputs = write_inputs},
      {.lightmaps = lightmaps, .irradiance = irradiance, .report = from_c(frame.residuals)});
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
  return relume_input_of(solver, system, quantity, 0);
}

relume_buffer_range relume_radiosity(const relume_solver* solver, uint32_t system) {
  return relume_radiosity_of(solver, system, 0);
}

relume_buffer_range relume_irradiance(const relume_solver* solver, uint32_t system) {
  return relume_irradiance_of(solver, system, 0);
}

relume_buffer_range relume_directional_irradiance(const relume_solver* solver, uint32_t system) {
  return relume_directional_irradiance_of(solver, system, 0);
}

relume_buffer_range relume_probe_coefficients(const relume_solver* solver) {
  return relume_probe_coefficients_of(solver, 0);
}

relume_buffer_range relume_input_of(const relume_solver* solver, uint32_t system, relume_quantity quantity,
                                    uint32_t lighting) {
  const bool sky = quantity == RELUME_SKY && system == solver->model->systems.size();
  if (!sky && !c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.input(system, static_cast<Quantity>(quantity), lighting));
}

relume_buffer_range relume_radiosity_of(const relume_solver* solver, uint32_t system, uint32_t lighting) {
  if (!c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.radiosity(system, solver->schedule.systems[system].half, lighting));
}

relume_buffer_range relume_irradiance_of(const relume_solver* solver, uint32_t system, uint32_t lighting) {
  if (!c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.irradiance(system, lighting));
}

relume_buffer_range relume_directional_irradiance_of(const relume_solver* solver, uint32_t system,
                                                     uint32_t lighting) {
  if (!c_api::check_loaded(*solver, system)) return {};
  return to_c(solver->solver.directional_irradiance(system, lighting));
}

relume_buffer_range relume_probe_coefficients_of(const relume_solver* solver, uint32_t lighting) {
  return to_c(solver->solver.probe_coefficients(lighting));
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
  return c_api::take_plan(*solver, c_api::plan_frame, *wishes, report, error);
}

relume_status relume_plan_together(relume_solver* solver, const relume_pass_wishes* wishes,
                                   relume_frame_report* report, relume_error* error) {
  return c_api::take_plan(*solver, c_api::plan_together, *wishes, report, error);
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

VkDeviceSize relume_residual_bytes(const relume_solver* solver) {
  return solver->solver.residuals().byte_size;
}

relume_residual relume_read_residual(const void* bytes, uint32_t system) {
  const std::byte* at = static_cast<const std::byte*>(bytes) + system * sizeof(kernels::ResidualRecord);
  const Residual residual = read_residuals(std::span(at, sizeof(kernels::ResidualRecord)))[0];
  relume_residual out{};
  for (int c = 0; c < 3; ++c) {
    out.weighted_change[c] = residual.weighted_change[c];
    out.change[c] = residual.change[c];
    out.weighted_radiosity[c] = residual.weighted_radiosity[c];
    out.radiosity[c] = residual.radiosity[c];
  }
  return out;
}
