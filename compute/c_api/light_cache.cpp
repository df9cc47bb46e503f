// SPDX-License-Identifier: MIT
#include <string>

#include "compute/c_api/handles.h"

using namespace relume;
using c_api::guarded;

namespace relume::c_api {
namespace {

Result<void> check_bound(const relume_light_cache& cache, const char* function) {
  if (cache.bound) return {};
  return fail(ErrorCode::usage, std::string(function) + ": relume_light_cache_bind comes first");
}

/// One of the lights, or a number of them.
Result<void> check_lights(const relume_light_cache& cache, const char* function, std::uint32_t found,
                          std::uint32_t most) {
  if (found <= most) return {};
  return fail(ErrorCode::usage, std::string(function) + ": the cache of system " +
                                    std::to_string(cache.system) + " is for " + std::to_string(cache.lights) +
                                    " lights, expected at most " + std::to_string(most) + ", found " +
                                    std::to_string(found));
}

}  // namespace
}  // namespace relume::c_api

relume_status relume_light_cache_create(relume_solver* solver, uint32_t system, uint32_t lights,
                                        relume_light_cache** cache, relume_error* error) {
  *cache = nullptr;
  return guarded(error, [&]() -> Result<void> {
    if (auto loaded = c_api::check_loaded(*solver, system); !loaded) return loaded;
    auto made = LightCache::create(solver->host, solver->model->systems[system].gather.rows, lights);
    if (!made) return tl::unexpected<Error>(made.error());
    *cache = new relume_light_cache{solver, system, lights, std::move(*made)};
    return {};
  });
}

void relume_light_cache_destroy(relume_light_cache* cache) {
  delete cache;
}

relume_status relume_light_cache_bind(relume_light_cache* cache, relume_allocate allocate, void* user,
                                      relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    const auto ranges = c_api::allocate_all(cache->cache.buffers(), c_api::allocator(allocate, user));
    if (!ranges) return tl::unexpected<Error>(ranges.error());
    auto bound = cache->cache.bind(*ranges, cache->solver->solver.irradiance(cache->system));
    cache->bound = bound.has_value();
    return bound;
  });
}

relume_status relume_light_cache_keep(const relume_light_cache* cache, VkCommandBuffer commands,
                                      uint32_t light, relume_error* error) {
  return relume_light_cache_keep_of(cache, commands, light, 0, error);
}

relume_status relume_light_cache_keep_of(const relume_light_cache* cache, VkCommandBuffer commands,
                                         uint32_t light, uint32_t lighting, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto bound = c_api::check_bound(*cache, "relume_light_cache_keep"); !bound) return bound;
    if (auto ok = c_api::check_lights(*cache, "relume_light_cache_keep", light, cache->lights - 1); !ok)
      return ok;
    const BufferRange irradiance = cache->solver->solver.irradiance(cache->system, lighting);
    if (irradiance.buffer == VK_NULL_HANDLE)
      return fail(ErrorCode::usage,
                  "relume_light_cache_keep_of: the solver has no lighting " + std::to_string(lighting));
    cache->cache.record_keep(commands, light, irradiance);
    return {};
  });
}

relume_status relume_light_cache_combine(const relume_light_cache* cache, VkCommandBuffer commands,
                                         const float* colors, uint32_t count, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto bound = c_api::check_bound(*cache, "relume_light_cache_combine"); !bound) return bound;
    if (auto ok = c_api::check_lights(*cache, "relume_light_cache_combine", count, cache->lights); !ok)
      return ok;
    std::vector<Rgb> lights;
    for (const float* c = colors; c != colors + 3 * std::size_t{count}; c += 3)
      lights.emplace_back(c[0], c[1], c[2]);
    cache->cache.record(commands, lights);
    return {};
  });
}
