// SPDX-License-Identifier: MIT
#include <cstddef>
#include <string>

#include "compute/c_api/handles.h"

using namespace relume;
using c_api::guarded;

static_assert(sizeof(relume_material_state) == sizeof(kernels::MaterialState));
static_assert(offsetof(relume_material_state, exitance) == offsetof(kernels::MaterialState, exitance));

namespace relume::c_api {

ClusterColorRanges color_ranges(const relume_solver& solver, std::uint32_t system) {
  return {solver.solver.input(system, Quantity::albedo), solver.solver.input(system, Quantity::exitance)};
}

namespace {

Result<void> check_material(const relume_solver& solver, std::uint32_t material) {
  const std::size_t count = solver.model->materials.size();
  if (material < count) return {};
  return fail(ErrorCode::usage, "material " + std::to_string(material) + ": the model has " +
                                    std::to_string(count) + " materials");
}

Result<relume_screen*> make_screen(relume_solver& solver, const relume_screen_info& info) {
  if (auto loaded = check_loaded(solver, info.system); !loaded) return tl::unexpected<Error>(loaded.error());
  if (auto known = check_material(solver, info.material); !known) return tl::unexpected<Error>(known.error());
  TextureFootprint footprint =
      texture_footprint(*solver.model, info.system, info.material, info.width, info.height);
  ScreenPassOptions options;
  options.target = info.sets_albedo != 0 ? ScreenTarget::albedo : ScreenTarget::exitance;
  options.max_albedo = info.max_albedo;
  options.max_images = info.max_images;
  auto pass = ScreenPass::create(solver.host, solver.model->systems[info.system], footprint, options);
  if (!pass) return tl::unexpected<Error>(pass.error());
  return new relume_screen{&solver, info.system, std::move(footprint), info.max_images, std::move(*pass)};
}

}  // namespace
}  // namespace relume::c_api

relume_status relume_materials_create(relume_solver* solver, uint32_t system, int per_cluster,
                                      double max_albedo, relume_materials** materials, relume_error* error) {
  *materials = nullptr;
  return guarded(error, [&]() -> Result<void> {
    if (auto loaded = c_api::check_loaded(*solver, system); !loaded) return loaded;
    const StatePer per = per_cluster != 0 ? StatePer::cluster : StatePer::material;
    auto pass = MaterialPass::create(solver->host, *solver->model, system, {per, max_albedo});
    if (!pass) return tl::unexpected<Error>(pass.error());
    *materials = new relume_materials{solver, system, per, std::move(*pass)};
    return {};
  });
}

void relume_materials_destroy(relume_materials* materials) {
  c_api::destroy_pass(materials);
}

relume_status relume_materials_bind(relume_materials* materials, relume_allocate allocate, void* user,
                                    relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    const relume_solver& solver = *materials->solver;
    auto ranges = c_api::allocate_all(materials->pass.buffers(), c_api::allocator(allocate, user));
    if (!ranges) return tl::unexpected<Error>(ranges.error());
    const ClusterColorRanges colors = c_api::color_ranges(solver, materials->system);
    if (auto bound = materials->pass.bind(*ranges, colors); !bound) return bound;
    materials->states = ranges->back();
    c_api::upload_pass(*materials, material_data(*solver.model, materials->system, materials->per),
                       std::move(*ranges));
    return {};
  });
}

relume_buffer_range relume_materials_states(const relume_materials* materials) {
  return c_api::to_c(materials->states);
}

relume_status relume_screen_create(relume_solver* solver, const relume_screen_info* info,
                                   relume_screen** screen, relume_error* error) {
  *screen = nullptr;
  return guarded(error, [&]() -> Result<void> {
    const auto made = c_api::make_screen(*solver, *info);
    if (!made) return tl::unexpected<Error>(made.error());
    *screen = *made;
    return {};
  });
}

void relume_screen_destroy(relume_screen* screen) {
  c_api::destroy_pass(screen);
}

relume_status relume_screen_bind(relume_screen* screen, relume_allocate allocate, void* user,
                                 relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    auto ranges = c_api::allocate_all(screen->pass.buffers(), c_api::allocator(allocate, user));
    if (!ranges) return tl::unexpected<Error>(ranges.error());
    const ClusterColorRanges colors = c_api::color_ranges(*screen->solver, screen->system);
    if (auto bound = screen->pass.bind(*ranges, colors); !bound) return bound;
    screen->bound = true;
    c_api::upload_pass(*screen, screen_data(screen->footprint), std::move(*ranges));
    return {};
  });
}

relume_status relume_screen_add_image(relume_screen* screen, VkSampler sampler, VkImageView view,
                                      VkImageLayout layout, uint32_t* image, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!screen->bound) return fail(ErrorCode::usage, "a screen's image: relume_screen_bind comes first");
    if (screen->images == screen->max_images)
      return fail(ErrorCode::usage, "a screen's image: it was made for " +
                                        std::to_string(screen->max_images) + " and has them");
    const auto added = screen->pass.add_image({view, sampler, layout});
    if (!added) return tl::unexpected<Error>(added.error());
    *image = *added;
    screen->images = *added + 1;
    return {};
  });
}
