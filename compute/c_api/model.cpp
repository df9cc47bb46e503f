// SPDX-License-Identifier: MIT
#include "compute/c_api/handles.h"
#include "compute/device_requirements.h"
#include "core/model_file.h"
#include "core/sky.h"

using namespace relume;
using c_api::guarded;

relume_status relume_model_read(const char* file, relume_model** model, relume_error* error) {
  *model = nullptr;
  return guarded(error, [&]() -> Result<void> {
    auto read = read_model(file);
    if (!read) return tl::unexpected<Error>(read.error());
    *model = new relume_model{std::move(*read)};
    return {};
  });
}

relume_status relume_model_read_systems(const char* file, const char* const* names, uint32_t count,
                                        relume_model** model, relume_error* error) {
  *model = nullptr;
  return guarded(error, [&]() -> Result<void> {
    auto read = read_systems(file, std::vector<std::string>(names, names + count));
    if (!read) return tl::unexpected<Error>(read.error());
    *model = new relume_model{std::move(*read)};
    return {};
  });
}

void relume_model_destroy(relume_model* model) {
  delete model;
}

uint32_t relume_model_system_count(const relume_model* model) {
  return static_cast<uint32_t>(model->model.systems.size());
}

const char* relume_model_system_name(const relume_model* model, uint32_t system) {
  return model->model.systems[system].name.c_str();
}

uint32_t relume_model_cluster_count(const relume_model* model, uint32_t system) {
  return static_cast<uint32_t>(model->model.systems[system].clusters.size());
}

uint32_t relume_model_gather_row_count(const relume_model* model, uint32_t system) {
  const System& from = model->model.systems[system];
  return static_cast<uint32_t>(from.lumels.size() + from.sensors.size());
}

uint32_t relume_model_probe_count(const relume_model* model) {
  return static_cast<uint32_t>(model->model.probe_names.size());
}

uint32_t relume_model_sky_patch_count(const relume_model* model) {
  return static_cast<uint32_t>(model->model.sky_cells.size());
}

namespace {

std::vector<glm::vec3> pixels_of(const float* image, std::size_t count) {
  std::vector<glm::vec3> pixels;
  for (std::size_t i = 0; i < count; ++i)
    pixels.emplace_back(image[3 * i], image[3 * i + 1], image[3 * i + 2]);
  return pixels;
}

void write_patches(const std::vector<Rgb>& radiosity, float* patches) {
  for (const Rgb& patch : radiosity) {
    for (int c = 0; c < 3; ++c) *patches++ = static_cast<float>(patch[c]);
    *patches++ = 0.0f;
  }
}

}  // namespace

relume_status relume_model_sky(const relume_model* model, const float* image, uint32_t width, uint32_t height,
                               float* patches, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (width == 0 || height == 0) return fail(ErrorCode::usage, "a sky image without pixels");
    const EquirectangularSky sky{width, height, pixels_of(image, std::size_t{width} * height)};
    write_patches(sky_radiosity(Sky(sky), model->model.sky_cells, model->model.sky_resolution), patches);
    return {};
  });
}

relume_status relume_model_sky_faces(const relume_model* model, const float* faces, uint32_t size,
                                     float* patches, relume_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (size == 0) return fail(ErrorCode::usage, "sky faces without pixels");
    const CubeSky sky{size, pixels_of(faces, std::size_t{6} * size * size)};
    write_patches(sky_radiosity(sky, model->model.sky_cells, model->model.sky_resolution), patches);
    return {};
  });
}

uint32_t relume_model_material_count(const relume_model* model) {
  return static_cast<uint32_t>(model->model.materials.size());
}

const char* relume_model_material_name(const relume_model* model, uint32_t material) {
  return model->model.materials[material].name.c_str();
}

relume_status relume_device_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                         VkInstance instance, VkPhysicalDevice physical_device,
                                         relume_requirements* requirements, relume_error* error) {
  *requirements = {};
  return guarded(error, [&]() -> Result<void> {
    const auto found = device_requirements(get_instance_proc_addr, instance, physical_device);
    if (!found) return tl::unexpected<Error>(found.error());
    requirements->api_version = found->api_version;
    requirements->features = found->features;
    requirements->queue_flags = found->queue_flags;
    static_assert(sizeof requirements->extensions / sizeof(const char*) == 16);
    if (found->device_extensions.size() > 16) return fail(ErrorCode::usage, "more than 16 extensions");
    requirements->extension_count = static_cast<uint32_t>(found->device_extensions.size());
    std::copy(found->device_extensions.begin(), found->device_extensions.end(), requirements->extensions);
    return {};
  });
}
