// SPDX-License-Identifier: MIT
#include "compute/c_api/handles.h"
#include "compute/device_requirements.h"
#include "core/model_file.h"

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

uint32_t relume_model_sky_patch_count(const relume_model* model) {
  return static_cast<uint32_t>(model->model.sky_cells.size());
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
