// SPDX-License-Identifier: MIT
#include "compute/guest.h"

#include "compute/device_requirements.h"

namespace relume {

Result<VkPhysicalDeviceLimits> device_limits(const HostDevice& host) {
  if (auto required = device_requirements(host.get_instance_proc_addr, host.instance, host.physical_device);
      !required) {
    return tl::unexpected<Error>(required.error());
  }
  const auto get_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(
      host.get_instance_proc_addr(host.instance, "vkGetPhysicalDeviceProperties"));
  VkPhysicalDeviceProperties properties{};
  get_properties(host.physical_device, &properties);
  return properties.limits;
}

}  // namespace relume
