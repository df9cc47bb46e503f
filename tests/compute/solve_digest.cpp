// SPDX-License-Identifier: MIT
//
// Prints the subgroup size of the device and, of solves by each kernel that the device can run, the value
// format and all bits as one number: in one format by every fetch, in the others, which differ in how single
// values are decoded, by one. A program of its own, because a driver reads its environment once.
#include <vulkan/vulkan.h>

#include <bit>
#include <cstdint>
#include <cstdio>

#include "compute/row_kernels.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/test_models.h"
#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

/// FNV-1a over the bits of all values, which the device stores in 32.
void digest(const std::vector<Rgb>& values, std::uint64_t& hash) {
  for (const Rgb& value : values) {
    for (int channel = 0; channel < 3; ++channel) {
      hash = (hash ^ std::bit_cast<std::uint32_t>(static_cast<float>(value[channel]))) * 0x100000001b3u;
    }
  }
}

std::uint32_t subgroup_size(const StandaloneDevice& device) {
  auto subgroups =
      vulkan_info<VkPhysicalDeviceSubgroupProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES);
  auto properties = vulkan_info<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &subgroups;
  vkGetPhysicalDeviceProperties2(device.host().physical_device, &properties);
  return subgroups.subgroupSize;
}

int run() {
  auto device = StandaloneDevice::create({});
  if (!device) return static_cast<int>(device.error().code);
  std::printf("%u", subgroup_size(*device));
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    const Model model = random_model({.nodes = 25, .spanning_nodes = 30}, 7, {codec, 24000, 8});
    const Lighting lighting = random_lighting(model, 8);
    const bool all = codec == ValueCodec::unorm16;
    for (const RowKernel kernel : kRowKernels) {
      if (!supports_row_kernel(device->host(), kernel) || (!all && kernel != RowKernel::tile_shared))
        continue;
      for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
        if (!all && fetch == MatrixFetch::storage) continue;
        const auto out =
            solve_on_device(*device, model, lighting, {20, 0.0}, {.kernel = kernel, .fetch = fetch});
        if (!out) return static_cast<int>(out.error().code);
        std::uint64_t hash = 0xcbf29ce484222325u;
        digest(out->solution.radiosity, hash);
        digest(out->irradiance, hash);
        std::printf(" %u:%016llx", static_cast<unsigned>(codec), static_cast<unsigned long long>(hash));
      }
    }
  }
  return 0;
}

}  // namespace
}  // namespace relume::test

int main() {
  return relume::test::run();
}
