// SPDX-License-Identifier: MIT
#include "compute/c_api/handles.h"

using namespace relume;
using c_api::guarded;

relume_status relume_lightmap_create(relume_solver* solver, uint32_t system, relume_lightmap_format format,
                                     relume_lightmap** lightmap, relume_lightmap_image* image,
                                     relume_error* error) {
  *lightmap = nullptr;
  *image = {};
  return guarded(error, [&]() -> Result<void> {
    if (auto loaded = c_api::check_loaded(*solver, system); !loaded) return loaded;
    const System& of = solver->model->systems[system];
    LightmapTexels texels = lightmap_texels(of);
    const auto stored = static_cast<LightmapFormat>(format);
    auto pass = LightmapPass::create(solver->host, of, texels, stored);
    if (!pass) return tl::unexpected<Error>(pass.error());
    const LightmapImage& made = pass->image();
    *image = {made.format, made.storage_view_format, made.extent, made.usage, made.flags};
    *lightmap = new relume_lightmap{solver, system, stored, std::move(texels), std::move(*pass)};
    return {};
  });
}

void relume_lightmap_destroy(relume_lightmap* lightmap) {
  c_api::destroy_pass(lightmap);
}

relume_status relume_lightmap_bind(relume_lightmap* lightmap, relume_allocate allocate, void* user,
                                   int add_direct, VkImageView storage_view, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    relume_solver& solver = *lightmap->solver;
    LightmapInputs inputs{solver.solver.irradiance(lightmap->system)};
    if (lightmap->format == LightmapFormat::direction_rgba16f)
      inputs.moments = solver.solver.directional_irradiance(lightmap->system);
    if (add_direct != 0) {
      const auto lights = solver.system_lights.find(lightmap->system);
      if (lights == solver.system_lights.end())
        return fail(ErrorCode::usage, "a lightmap with direct light: relume_add_lights comes first");
      inputs.direct = lights->second->light.gather_light();
    }
    auto ranges = c_api::allocate_all(lightmap->pass.buffers(), c_api::allocator(allocate, user));
    if (!ranges) return tl::unexpected<Error>(ranges.error());
    if (auto bound = lightmap->pass.bind(*ranges, inputs, storage_view); !bound) return bound;
    c_api::upload_pass(*lightmap, lightmap_data(lightmap->texels), std::move(*ranges));
    return {};
  });
}

relume_status relume_lightmap_record(const relume_lightmap* lightmap, VkCommandBuffer commands,
                                     relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!lightmap->uploaded)
      return fail(ErrorCode::usage,
                  "relume_lightmap_record: relume_lightmap_bind comes first, and "
                  "relume_record_upload until nothing is pending");
    lightmap->pass.record(commands);
    return {};
  });
}
