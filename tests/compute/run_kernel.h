// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "compute/host_device.h"
#include "compute/standalone/standalone_device.h"

namespace relume::test {

/// A kernel of a test's own: storage buffers at bindings 0, 1, ..., then a sampled image.
struct KernelRun {
  std::span<const std::uint32_t> spirv;
  std::vector<BufferRange> buffers;
  std::uint32_t groups = 1;
  std::optional<VkDescriptorImageInfo> sampled{};
  std::function<void(VkCommandBuffer)> record_before{};  ///< barriers
};

/// Dispatches and waits; what goes wrong fails the test.
void run_kernel(StandaloneDevice& device, const KernelRun& run);

}  // namespace relume::test
