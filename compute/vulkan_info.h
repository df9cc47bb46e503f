// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

namespace relume {

/// A Vulkan structure of this type, all else zero.
template <class Info>
Info vulkan_info(VkStructureType type) {
  Info info{};
  info.sType = type;
  return info;
}

}  // namespace relume
