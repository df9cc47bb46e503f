// SPDX-License-Identifier: MIT
//
// A device of our own, for programs that have none: the command line, tests and benchmarks. Only this folder
// creates instances, devices and queues, submits, and waits.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compute/host_device.h"
#include "core/result.h"

namespace relume {

struct StandaloneOptions {
  /// Core and synchronization validation by the Khronos layer, if it is installed.
  bool validation = false;
  /// With validation, instead of those two: the layer checks in the kernels themselves that they stay inside
  /// their buffers. A pass of its own, because it is slow and gets on with the others badly.
  bool gpu_assisted = false;
  /// Part of a device's name, upper or lower case; empty: discrete before integrated before virtual before
  /// processor.
  std::string device_name{};
};

/// How long a submission took.
struct SubmitTimes {
  double seconds = 0.0;      ///< from the call to the end of the wait
  double gpu_seconds = 0.0;  ///< between timestamps around its commands; 0 when the queue has none

  SubmitTimes& operator+=(const SubmitTimes& more) {
    seconds += more.seconds, gpu_seconds += more.gpu_seconds;
    return *this;
  }
};

class StandaloneDevice {
 public:
  /// Fails with no_device and a sentence that lists what was found.
  static Result<StandaloneDevice> create(const StandaloneOptions& options);

  StandaloneDevice(StandaloneDevice&&) noexcept;
  StandaloneDevice& operator=(StandaloneDevice&&) noexcept;
  ~StandaloneDevice();

  /// What a guest needs. Valid as long as the device.
  HostDevice host() const;

  const std::string& name() const;
  std::string driver() const;  ///< its name and version, in its own words
  VkPhysicalDeviceType type() const;
  std::uint32_t queue_family() const;
  const VkPhysicalDeviceMemoryProperties& memory_properties() const;

  /// Whether validation was asked for and is there.
  bool validating() const;

  /// What validation said so far, one message each. Nothing is printed.
  std::vector<std::string> validation_messages() const;

  /// Records one command buffer, submits it and waits until it has run. After a lost device, or when that
  /// took longer than `timeout_seconds`, this and every further submission fails with no_device.
  Result<SubmitTimes> submit(const std::function<void(VkCommandBuffer)>& record,
                             double timeout_seconds = 60.0);

 private:
  struct State;
  explicit StandaloneDevice(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace relume
