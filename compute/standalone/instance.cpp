// SPDX-License-Identifier: MIT
#include "compute/standalone/instance.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <utility>
#include <vector>

#include "compute/device_requirements.h"
#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

bool has_validation_layer() {
  std::uint32_t count = 0;
  if (vkEnumerateInstanceLayerProperties(&count, nullptr) != VK_SUCCESS) return false;
  std::vector<VkLayerProperties> layers(count);
  if (vkEnumerateInstanceLayerProperties(&count, layers.data()) != VK_SUCCESS) return false;
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::strcmp(layer.layerName, kValidationLayer) == 0;
  });
}

/// What each kind of validation turns on and off.
VkValidationFeaturesEXT features_of(ValidationKind kind) {
  static constexpr VkValidationFeatureEnableEXT kSynchronization =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  static constexpr VkValidationFeatureEnableEXT kGpuAssisted[] = {
      VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT,
      VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT};
  static constexpr VkValidationFeatureDisableEXT kOthers = VK_VALIDATION_FEATURE_DISABLE_CORE_CHECKS_EXT;
  auto features = vulkan_info<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  if (kind == ValidationKind::gpu_assisted) {
    features.enabledValidationFeatureCount = 2;
    features.pEnabledValidationFeatures = kGpuAssisted;
    features.disabledValidationFeatureCount = 1;
    features.pDisabledValidationFeatures = &kOthers;
  } else {
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &kSynchronization;
  }
  return features;
}

VkResult create_instance(ValidationKind kind, ValidationLog& log, VkInstance& instance) {
  auto application = vulkan_info<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "relume";
  application.apiVersion = DeviceRequirements{}.api_version;
  auto info = vulkan_info<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  if (kind == ValidationKind::none) return vkCreateInstance(&info, nullptr, &instance);

  const VkValidationFeaturesEXT features = features_of(kind);
  VkDebugUtilsMessengerCreateInfoEXT messenger = log.messenger_info();
  messenger.pNext = &features;
  const char* const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                    VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  info.pNext = &messenger;
  info.enabledLayerCount = 1;
  info.ppEnabledLayerNames = &kValidationLayer;
  info.enabledExtensionCount = 2;
  info.ppEnabledExtensionNames = extensions;
  return vkCreateInstance(&info, nullptr, &instance);
}

struct Candidate {
  VkPhysicalDevice device = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
};

int rank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 4;
    default:
      return 3;
  }
}

/// Best first; equal ones stay in the order of the instance.
Result<std::vector<Candidate>> list_devices(VkInstance instance) {
  std::uint32_t count = 0;
  std::vector<VkPhysicalDevice> devices;
  VkResult listed = vkEnumeratePhysicalDevices(instance, &count, nullptr);
  if (listed == VK_SUCCESS) {
    devices.resize(count);
    listed = vkEnumeratePhysicalDevices(instance, &count, devices.data());
  }
  if (auto done = check_vulkan(listed, "listing devices"); !done) return tl::unexpected<Error>(done.error());
  std::vector<Candidate> candidates(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    candidates[i].device = devices[i];
    vkGetPhysicalDeviceProperties(devices[i], &candidates[i].properties);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return rank(a.properties.deviceType) < rank(b.properties.deviceType);
  });
  return candidates;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

Result<Instance> Instance::create(ValidationKind validation, ValidationLog& log) {
  if (!has_validation_layer()) validation = ValidationKind::none;
  const bool validating = validation != ValidationKind::none;
  Instance instance;
  const VkResult result = create_instance(validation, log, instance.instance_);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(vulkan_error(result, "creating a Vulkan instance"));
  }
  if (!validating) return instance;
  const auto create_messenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance.instance_, "vkCreateDebugUtilsMessengerEXT"));
  const VkDebugUtilsMessengerCreateInfoEXT info = log.messenger_info();
  const VkResult created = create_messenger == nullptr
                               ? VK_ERROR_EXTENSION_NOT_PRESENT
                               : create_messenger(instance.instance_, &info, nullptr, &instance.messenger_);
  if (created != VK_SUCCESS)
    return tl::unexpected<Error>(vulkan_error(created, "creating a debug messenger"));
  return instance;
}

Instance::Instance(Instance&& other) noexcept
    : instance_(std::exchange(other.instance_, nullptr)),
      messenger_(std::exchange(other.messenger_, nullptr)) {}

Instance::~Instance() {
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy_messenger(instance_, messenger_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

Result<VkPhysicalDevice> choose_physical_device(VkInstance instance, const std::string& name) {
  const auto candidates = list_devices(instance);
  if (!candidates) return tl::unexpected<Error>(candidates.error());
  std::string found;
  for (const Candidate& candidate : *candidates) {
    const std::string device_name = candidate.properties.deviceName;
    if (!found.empty()) found += "; ";
    if (lower_case(device_name).find(lower_case(name)) == std::string::npos) {
      found += "'" + device_name + "' has another name";
      continue;
    }
    const auto required = device_requirements(vkGetInstanceProcAddr, instance, candidate.device);
    if (required) return candidate.device;
    found += required.error().message;
  }
  const std::string wanted =
      name.empty() ? "no usable Vulkan device" : "no usable Vulkan device named '" + name + "'";
  return fail(ErrorCode::no_device, wanted + ": found " + (found.empty() ? "none" : found));
}

}  // namespace relume
