// SPDX-License-Identifier: MIT
//
// A DirectLight on a StandaloneDevice, with memory, staging and readback: each verb submits and waits.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "compute/direct_light.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/standalone_memory.h"
#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"

namespace relume {

struct LightSessionOptions {
  DirectLightOptions light{};
  std::uint64_t max_submit_rays = 1u << 20;
  VkDeviceSize staging_bytes = VkDeviceSize{8} << 20;  ///< grows to what the lights need
  double timeout_seconds = 60.0;                       ///< of one submission
};

/// Metres about the origin of the model.
struct LightSegment {
  glm::vec3 from{0.0f};
  glm::vec3 to{0.0f};
};

struct LightTimes {
  SubmitTimes sum;
  std::uint64_t rays = 0;            ///< shadow rays, as planned
  double longest_gpu_seconds = 0.0;  ///< of one submission
};

class LightSession {
 public:
  /// The device must outlive the session. The model is uploaded.
  static Result<LightSession> create(StandaloneDevice& device, const Model& model,
                                     const LightSessionOptions& options = {});

  const DirectLight& light() const { return light_; }
  const LightSchedule& schedule() const { return schedule_; }
  std::uint64_t device_bytes() const { return arena_.byte_size(); }

  /// Brings H up to date with these lights: traces what has changed since the last call.
  Result<LightTimes> set_lights(std::span<const Light> lights);

  /// All is traced again at the next set_lights().
  void retrace() { schedule_.retrace(); }

  /// The host's mask: one value per light and cluster (LightVisibility::mask).
  Result<void> write_mask(std::span<const float> visibility);

  /// H, lm/m2.
  Result<std::vector<Rgb>> read_clusters();
  Result<std::vector<Rgb>> read_gather();

  /// The share of light that gets along each segment; the slots of pairs are overwritten, so what comes after
  /// is traced anew.
  Result<std::vector<float>> trace(std::span<const LightSegment> segments, SubmitTimes* times = nullptr);

 private:
  LightSession(StandaloneDevice& device, const LightSessionOptions& options, DirectLight light)
      : device_(&device),
        options_(options),
        arena_(device),
        light_(std::move(light)),
        schedule_(light_.make_schedule()) {}

  Result<void> provide_memory(const Model& model);
  Result<void> grow_staging(VkDeviceSize bytes);
  Result<SubmitTimes> upload(const UploadData& data);

  StandaloneDevice* device_;
  LightSessionOptions options_;
  DeviceArena arena_;
  DeviceBuffer staging_;
  // The light goes before the memory that it is bound to.
  DirectLight light_;
  LightSchedule schedule_;
};

struct DeviceDirectLight {
  std::vector<Rgb> clusters;  ///< H, lm/m2 per cluster of all systems
  std::vector<Rgb> gather;    ///< per gather row (lumels, sensors)
};

struct DirectLightRun {
  /// Systems are done together up to so many surface elements, so that their buffers stay small.
  std::size_t max_elements = std::size_t{1} << 18;
};

/// direct_irradiance() of the precompute, on a device: of any number of lights, in batches. All systems that
/// are loaded. Fails with no_device when the occluders, or the elements of one system, are more than the
/// device can bind.
Result<DeviceDirectLight> direct_light_on_device(StandaloneDevice& device, const Model& model,
                                                 std::span<const Light> lights,
                                                 const DirectLightRun& run = {});

}  // namespace relume
