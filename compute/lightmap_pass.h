// SPDX-License-Identifier: MIT
//
// Irradiance of a system, or where it comes from, into the host's lightmap image, from which the host's
// shaders sample it (kernels/include/relume_sample_lightmap.glsl).
//
// The life of a pass: create; the host makes the image and its storage view as image() says, the buffers as
// buffers() says, and binds both; it uploads lightmap_data once (compute/record_upload.h); then record, in
// any number.
//
// The image. Kernels round to nearest themselves and write bits, through a view of an unsigned integer
// format: so the image has VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT and, where the format itself cannot be stored
// to, VK_IMAGE_CREATE_EXTENDED_USAGE_BIT. The host samples it through a view of its own, of the format
// itself; for a format with EXTENDED_USAGE that view is made with
// VkImageViewUsageCreateInfo{VK_IMAGE_USAGE_SAMPLED_BIT}. One mip level is written; the host makes others. A
// value is the irradiance in lux, linear Rec.709, row 0 of the lightmap in row 0 of the image. Texels without
// a value (core/lightmap_texels.h) are never written: the host clears the image once.
//
// Synchronisation: record begins with COMPUTE_SHADER reads (irradiance and direct, SHADER_READ) and ends with
// COMPUTE_SHADER writes of the image (SHADER_WRITE); no barriers inside. The image is in layout GENERAL
// meanwhile; the transitions from and to the layout in which the host samples it, and the barriers that go
// with them, are the host's. Behind a solver's gather on the same queue no barrier is needed for its
// irradiance. Left behind: the bound compute pipeline, descriptor set 0 and push constants [0, 12) of the
// compute bind point.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/kernel_set.h"
#include "compute/lightmap_format.h"
#include "compute/upload.h"
#include "core/lightmap_texels.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

/// What the host's image is made with, at least: 2D, optimal tiling, one layer, one sample.
struct LightmapImage {
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkFormat storage_view_format = VK_FORMAT_UNDEFINED;  ///< of the view that bind() gets, and in a format list
  VkExtent2D extent{};                                 ///< lumels of the system's lightmap
  VkImageUsageFlags usage = 0;  ///< STORAGE and SAMPLED; the host adds what it needs for clears and copies
  VkImageCreateFlags flags = 0;
};

/// What lightmap_pass reads, of the same system: four floats per gather row, as GpuSolver::irradiance.
struct LightmapInputs {
  BufferRange irradiance;
  std::optional<BufferRange> direct{};  ///< added to it; absent: indirect light alone
  /// GpuSolver::directional_irradiance, which lies behind the irradiance: for directions, and for nothing
  /// else.
  std::optional<BufferRange> moments{};
};

class LightmapPass {
 public:
  /// Compiles the kernel of the format. `texels` is lightmap_texels(system); both are read, not kept. Fails
  /// with usage when the system has no texel that carries a value, or directions are asked of one that has
  /// none; with no_device when a buffer is larger than every device can bind (2^24 texels).
  static Result<LightmapPass> create(const HostDevice& host, const System& system,
                                     const LightmapTexels& texels, LightmapFormat format);

  const LightmapImage& image() const { return image_; }
  std::span<const BufferRequirement> buffers() const { return buffers_; }

  /// Hands over one range per entry of buffers(), what is read, and a view of the image in the storage
  /// format. To be called once; all of it must outlive its use. Fails with usage where a range is too small
  /// or the view is null.
  Result<void> bind(std::span<const BufferRange> ranges, const LightmapInputs& inputs,
                    VkImageView storage_view);

  /// All texels that carry a value, in dispatches of at most 2^18.
  void record(VkCommandBuffer commands) const;

 private:
  LightmapPass(const DeviceFunctions& functions, KernelSet kernels)
      : functions_(functions), kernels_(std::move(kernels)) {}

  Result<void> check_moments(const LightmapInputs& inputs) const;

  DeviceFunctions functions_;
  KernelSet kernels_;
  LightmapImage image_;
  std::vector<BufferRequirement> buffers_;
  std::uint32_t texels_ = 0;
  VkDeviceSize input_bytes_ = 0;  ///< of irradiance and direct
  bool adds_direct_ = false;
  bool shows_direction_ = false;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

/// The bytes of LightmapPass::buffers(). Refers to nothing.
UploadData lightmap_data(const LightmapTexels& texels);

}  // namespace relume
