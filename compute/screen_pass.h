// SPDX-License-Identifier: MIT
//
// A video screen lights the room: an image of the host, bound to a material, is reduced to the clusters that
// show it, on the device. It sets their exitance, or their albedo.
//
// The life of a pass: create from a texture_footprint (core/texture_footprint.h) made for the size of the
// images; the host provides buffers() and binds them; it adds each image that it may show (a film decoder has
// a few in turn), uploads screen_data once, and records a pass in each frame in which the image changed.
//
// Images are sampled as the host's sampler says, at level 0 of the view: nearest gives the mean of texels as
// the precompute takes it, linear the same with less noise; addressing as the material's texture has it.
// Values are linear: an image of sRGB codes has an sRGB format, which decodes them. An image much finer than
// the footprint was made for is best shown through a view of a smaller mip level.
//
// Synchronisation: record begins with COMPUTE_SHADER reads of the image and writes of albedo or exitance, and
// ends with COMPUTE_SHADER writes of it, which are visible to COMPUTE_SHADER and to TRANSFER reads. Between
// record functions that run one after another on one queue the barriers are the pass's; those of the image
// are the host's. Left behind: the bound compute pipeline, descriptor set 0 and push constants [0, 28) of the
// compute bind point.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compute/material_pass.h"
#include "core/texture_footprint.h"

namespace relume {

enum class ScreenTarget : std::uint32_t { exitance, albedo };

struct ScreenPassOptions {
  ScreenTarget target = ScreenTarget::exitance;
  double max_albedo = 0.95;      ///< albedo above is lowered to it; at most 0.9999
  std::uint32_t max_images = 4;  ///< that are ever added
};

class ScreenPass {
 public:
  /// Compiles the kernel. `system` is that of the footprint, which is read, not kept. Fails with usage when
  /// no cluster shows the image, or more than 65 535 do, with no_device when a buffer is larger than every
  /// device can bind (2^23 samples).
  static Result<ScreenPass> create(const HostDevice& host, const System& system,
                                   const TextureFootprint& footprint, const ScreenPassOptions& options);

  std::span<const BufferRequirement> buffers() const { return buffers_; }

  /// Hands over one range per entry of buffers(), and where the colours of all clusters of the system are. To
  /// be called once; all of it must outlive its use.
  Result<void> bind(std::span<const BufferRange> ranges, const ClusterColorRanges& colors);

  /// After bind. Gives the number by which record knows the image.
  Result<std::uint32_t> add_image(const SampledImage& image);

  /// `factor`: what a texel of 1 is worth, in cd/m2 for exitance.
  void record(VkCommandBuffer commands, std::uint32_t image, const Rgb& factor) const;

 private:
  ScreenPass(const DeviceFunctions& functions, KernelSet kernels)
      : functions_(functions), kernels_(std::move(kernels)) {}

  DeviceFunctions functions_;
  KernelSet kernels_;
  std::vector<BufferRequirement> buffers_;
  kernels::ScreenConstants constants_{};
  std::uint32_t clusters_of_system_ = 0;
  std::vector<BufferRange> ranges_;
  std::vector<VkDescriptorSet> sets_;  ///< per image
};

/// The bytes of ScreenPass::buffers(). Refers to nothing.
UploadData screen_data(const TextureFootprint& footprint);

}  // namespace relume
