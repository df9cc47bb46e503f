// SPDX-License-Identifier: MIT
#include "compute/standalone/standalone_device.h"

#include <vulkan/vulkan.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "compute/device_requirements.h"
#include "compute/standalone/instance.h"
#include "compute/standalone/timestamps.h"
#include "compute/standalone/validation_log.h"
#include "compute/vulkan_error.h"
#include "compute/vulkan_handle.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

struct DestroyDevice {
  void operator()(VkDevice device) const { vkDestroyDevice(device, nullptr); }
};
using DeviceHandle = std::unique_ptr<VkDevice_T, DestroyDevice>;

/// The first that can compute; device_requirements has seen that there is one.
std::uint32_t compute_family(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  std::uint32_t index = 0;
  while (index + 1 < count && (families[index].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) ++index;
  return index;
}

Result<DeviceHandle> create_device(VkPhysicalDevice physical_device, std::uint32_t family) {
  const DeviceRequirements requirements;
  const float priority = 1.0f;
  auto queue = vulkan_info<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto info = vulkan_info<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(requirements.device_extensions.size());
  info.ppEnabledExtensionNames = requirements.device_extensions.data();
  info.pEnabledFeatures = &requirements.features;
  VkDevice device = VK_NULL_HANDLE;
  const VkResult result = vkCreateDevice(physical_device, &info, nullptr, &device);
  if (result != VK_SUCCESS) return tl::unexpected<Error>(vulkan_error(result, "creating a Vulkan device"));
  return DeviceHandle(device);
}

ValidationKind validation_kind(const StandaloneOptions& options) {
  if (!options.validation) return ValidationKind::none;
  return options.gpu_assisted ? ValidationKind::gpu_assisted : ValidationKind::core_and_synchronization;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

/// Members go in reverse order: children of the device before the device before the instance before the log.
struct StandaloneDevice::State {
  State(std::unique_ptr<ValidationLog> its_log, Instance its_instance, VkPhysicalDevice chosen)
      : log(std::move(its_log)), instance(std::move(its_instance)), physical_device(chosen) {}

  std::unique_ptr<ValidationLog> log;
  Instance instance;
  VkPhysicalDevice physical_device;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  std::uint32_t family = 0;
  std::string name;
  DeviceHandle device;
  VkQueue queue = VK_NULL_HANDLE;
  VulkanHandle<VkCommandPool> command_pool;
  VulkanHandle<VkFence> fence;
  Timestamps timestamps;  ///< around the commands
  VkCommandBuffer commands = VK_NULL_HANDLE;
  bool lost = false;

  Result<void> create_children();
  Result<void> record(const std::function<void(VkCommandBuffer)>& record);
  Result<void> wait(double timeout_seconds);
};

Result<void> StandaloneDevice::State::create_children() {
  VkDevice owner = device.get();
  vkGetDeviceQueue(owner, family, 0, &queue);

  auto pool_info = vulkan_info<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool_info.queueFamilyIndex = family;
  VkCommandPool pool = VK_NULL_HANDLE;
  if (auto made =
          check_vulkan(vkCreateCommandPool(owner, &pool_info, nullptr, &pool), "creating a command pool");
      !made) {
    return made;
  }
  command_pool = {owner, pool, vkDestroyCommandPool, nullptr};

  auto commands_info =
      vulkan_info<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  commands_info.commandPool = pool;
  commands_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  commands_info.commandBufferCount = 1;
  if (auto made = check_vulkan(vkAllocateCommandBuffers(owner, &commands_info, &commands),
                               "allocating a command buffer");
      !made) {
    return made;
  }

  const auto fence_info = vulkan_info<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  VkFence made_fence = VK_NULL_HANDLE;
  if (auto made = check_vulkan(vkCreateFence(owner, &fence_info, nullptr, &made_fence), "creating a fence");
      !made) {
    return made;
  }
  fence = {owner, made_fence, vkDestroyFence, nullptr};
  auto clock = Timestamps::create(physical_device, owner, family, 2);
  if (!clock) return tl::unexpected<Error>(clock.error());
  timestamps = std::move(*clock);
  return {};
}

Result<void> StandaloneDevice::State::record(const std::function<void(VkCommandBuffer)>& record_commands) {
  if (auto reset =
          check_vulkan(vkResetCommandPool(device.get(), command_pool.get(), 0), "resetting a command pool");
      !reset) {
    return reset;
  }
  auto begin = vulkan_info<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  if (auto begun = check_vulkan(vkBeginCommandBuffer(commands, &begin), "beginning a command buffer");
      !begun) {
    return begun;
  }
  timestamps.record_reset(commands);
  timestamps.record_mark(commands, 0);
  record_commands(commands);
  timestamps.record_mark(commands, 1);
  return check_vulkan(vkEndCommandBuffer(commands), "ending a command buffer");
}

Result<void> StandaloneDevice::State::wait(double timeout_seconds) {
  const auto nanoseconds = static_cast<std::uint64_t>(std::llround(timeout_seconds * 1e9));
  VkFence done = fence.get();
  const VkResult waited = vkWaitForFences(device.get(), 1, &done, VK_TRUE, nanoseconds);
  if (waited != VK_SUCCESS) {
    lost = true;
    // Whoever gets the error frees what the commands still use.
    vkDeviceWaitIdle(device.get());
  }
  if (auto finished = check_vulkan(waited, "waiting for the device '" + name + "'"); !finished)
    return finished;
  return check_vulkan(vkResetFences(device.get(), 1, &done), "resetting a fence");
}

StandaloneDevice::StandaloneDevice(std::unique_ptr<State> state) : state_(std::move(state)) {}
StandaloneDevice::StandaloneDevice(StandaloneDevice&&) noexcept = default;
StandaloneDevice& StandaloneDevice::operator=(StandaloneDevice&&) noexcept = default;

StandaloneDevice::~StandaloneDevice() = default;

Result<StandaloneDevice> StandaloneDevice::create(const StandaloneOptions& options) {
  auto log = std::make_unique<ValidationLog>();
  auto instance = Instance::create(validation_kind(options), *log);
  if (!instance) return tl::unexpected<Error>(instance.error());
  const auto physical_device = choose_physical_device(instance->get(), options.device_name);
  if (!physical_device) return tl::unexpected<Error>(physical_device.error());
  const std::uint32_t family = compute_family(*physical_device);
  auto device = create_device(*physical_device, family);
  if (!device) return tl::unexpected<Error>(device.error());

  auto state = std::make_unique<State>(std::move(log), std::move(*instance), *physical_device);
  vkGetPhysicalDeviceProperties(*physical_device, &state->properties);
  vkGetPhysicalDeviceMemoryProperties(*physical_device, &state->memory);
  state->family = family;
  state->name = state->properties.deviceName;
  state->device = std::move(*device);
  if (auto created = state->create_children(); !created) return tl::unexpected<Error>(created.error());
  return StandaloneDevice(std::move(state));
}

HostDevice StandaloneDevice::host() const {
  return {state_->instance.get(), state_->physical_device, state_->device.get(), vkGetInstanceProcAddr};
}

const std::string& StandaloneDevice::name() const {
  return state_->name;
}

std::string StandaloneDevice::driver() const {
  auto driver =
      vulkan_info<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  auto properties = vulkan_info<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &driver;
  vkGetPhysicalDeviceProperties2(state_->physical_device, &properties);
  const std::string info = driver.driverInfo;
  return info.empty() ? std::string(driver.driverName) : driver.driverName + (", " + info);
}

VkPhysicalDeviceType StandaloneDevice::type() const {
  return state_->properties.deviceType;
}

std::uint32_t StandaloneDevice::queue_family() const {
  return state_->family;
}

const VkPhysicalDeviceMemoryProperties& StandaloneDevice::memory_properties() const {
  return state_->memory;
}

bool StandaloneDevice::validating() const {
  return state_->instance.validating();
}

std::vector<std::string> StandaloneDevice::validation_messages() const {
  return state_->log->messages();
}

Result<SubmitTimes> StandaloneDevice::submit(const std::function<void(VkCommandBuffer)>& record,
                                             double timeout_seconds) {
  if (state_->lost) return fail(ErrorCode::no_device, "the device '" + state_->name + "' was lost before");
  const auto start = std::chrono::steady_clock::now();
  if (auto recorded = state_->record(record); !recorded) return tl::unexpected<Error>(recorded.error());
  auto info = vulkan_info<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &state_->commands;
  const VkResult submitted = vkQueueSubmit(state_->queue, 1, &info, state_->fence.get());
  if (submitted != VK_SUCCESS) {
    state_->lost = true;
    return tl::unexpected<Error>(vulkan_error(submitted, "submitting to the device '" + state_->name + "'"));
  }
  if (auto waited = state_->wait(timeout_seconds); !waited) return tl::unexpected<Error>(waited.error());
  const auto on_device = state_->timestamps.seconds();
  if (!on_device) return tl::unexpected<Error>(on_device.error());
  return SubmitTimes{seconds_since(start), on_device->front()};
}

}  // namespace relume
