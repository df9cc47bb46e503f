// SPDX-License-Identifier: MIT
#include "tool/direct_light.h"

#include <fmt/format.h>

#include "compute/standalone/light_session.h"

namespace relume {
namespace {

Result<DirectIrradiance> direct_on(StandaloneDevice& device, const Model& model,
                                   std::span<const Light> lights) {
  Result<DeviceDirectLight> direct = direct_light_on_device(device, model, lights);
  if (!direct) return tl::unexpected(direct.error());
  return DirectIrradiance{std::move(direct->clusters), std::move(direct->gather)};
}

}  // namespace

Result<DirectIrradiance> direct_by_vulkan(const Model& model, std::span<const Light> lights,
                                          const std::string& device_name) {
  Result<StandaloneDevice> device = StandaloneDevice::create({.device_name = device_name});
  if (!device) return tl::unexpected(device.error());
  return direct_on(*device, model, lights);
}

DirectLightSource direct_light_of_device(const std::string& device_name, Console& console,
                                         std::string& computed_by) {
  return [&, device_name](const Model& model, std::span<const Light> lights) -> Result<DirectIrradiance> {
    Result<StandaloneDevice> device = StandaloneDevice::create({.device_name = device_name});
    if (!device) return tl::unexpected(device.error());
    computed_by = device->name();
    return or_by_processor(direct_on(*device, model, lights), model, lights, console, computed_by);
  };
}

Result<DirectIrradiance> or_by_processor(Result<DirectIrradiance> by_device, const Model& model,
                                         std::span<const Light> lights, Console& console,
                                         std::string& computed_by) {
  if (by_device) return by_device;
  const Error& error = by_device.error();
  if (error.code != ErrorCode::no_device && error.code != ErrorCode::out_of_memory) return by_device;
  console.warn(fmt::format("Direct light is computed on the processor: {}.", error.message));
  computed_by = kProcessor;
  return direct_irradiance(model, lights);
}

}  // namespace relume
