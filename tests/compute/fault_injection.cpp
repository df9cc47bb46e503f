// SPDX-License-Identifier: MIT
//
// Calls of a device that fail when a test says so.
#include <cstring>

#include "compute/fake_host.h"

namespace relume::test {
namespace {

struct Faults {
  int failing = -1;
  VkResult result = VK_SUCCESS;
  int calls = 0;
  std::string failed;
};

// Vulkan's entry points carry no pointer of the caller's.
Faults faults;

/// Whether the next fallible call fails.
bool fails(const char* name) {
  const bool now = faults.calls++ == faults.failing;
  if (now) faults.failed = name;
  return now;
}

/// An entry point in front of the loader's: a type of its own for each name, because it has no data.
template <class Tag, class Function>
struct Fallible;

template <class Tag, class... Arguments>
struct Fallible<Tag, VkResult(VKAPI_PTR*)(VkDevice, Arguments...)> {
  static VkResult VKAPI_PTR call(VkDevice device, Arguments... arguments) {
    if (fails(Tag::name)) return faults.result;
    const auto real = reinterpret_cast<VkResult(VKAPI_PTR*)(VkDevice, Arguments...)>(
        vkGetDeviceProcAddr(device, Tag::name));
    return real(device, arguments...);
  }
};

struct ShaderModule {
  static constexpr const char* name = "vkCreateShaderModule";
};
struct SetLayout {
  static constexpr const char* name = "vkCreateDescriptorSetLayout";
};
struct PipelineLayout {
  static constexpr const char* name = "vkCreatePipelineLayout";
};
struct ComputePipelines {
  static constexpr const char* name = "vkCreateComputePipelines";
};
struct BufferView {
  static constexpr const char* name = "vkCreateBufferView";
};
struct DescriptorPool {
  static constexpr const char* name = "vkCreateDescriptorPool";
};
struct DescriptorSets {
  static constexpr const char* name = "vkAllocateDescriptorSets";
};

struct EntryPoint {
  const char* name;
  PFN_vkVoidFunction function;
};

template <class Tag, class Function>
EntryPoint entry_point() {
  return {Tag::name, reinterpret_cast<PFN_vkVoidFunction>(&Fallible<Tag, Function>::call)};
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_with_faults(VkDevice device, const char* name) {
  static const EntryPoint kFallible[] = {
      entry_point<ShaderModule, PFN_vkCreateShaderModule>(),
      entry_point<SetLayout, PFN_vkCreateDescriptorSetLayout>(),
      entry_point<PipelineLayout, PFN_vkCreatePipelineLayout>(),
      entry_point<ComputePipelines, PFN_vkCreateComputePipelines>(),
      entry_point<BufferView, PFN_vkCreateBufferView>(),
      entry_point<DescriptorPool, PFN_vkCreateDescriptorPool>(),
      entry_point<DescriptorSets, PFN_vkAllocateDescriptorSets>(),
  };
  for (const EntryPoint& entry : kFallible) {
    if (std::strcmp(name, entry.name) == 0) return entry.function;
  }
  return vkGetDeviceProcAddr(device, name);
}

}  // namespace

PFN_vkVoidFunction get_proc_addr_with_faults(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) {
    return reinterpret_cast<PFN_vkVoidFunction>(device_with_faults);
  }
  return vkGetInstanceProcAddr(instance, name);
}

void inject_fault(int call, VkResult result) {
  faults = {call, result, 0, {}};
}

int fallible_calls() {
  return faults.calls;
}

std::string failed_call() {
  return faults.failed;
}

}  // namespace relume::test
