// SPDX-License-Identifier: MIT
#include "compute/screen_pass.h"

#include <algorithm>
#include <utility>

#include "compute/pass_buffers.h"
#include "compute/recording.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

static_assert(sizeof(FootprintSample) == 3 * sizeof(float));

KernelSetInfo kernel_set_info(std::uint32_t max_images) {
  KernelSetInfo info;
  info.shape = {.storage_buffers = kernels::kScreenBuffers, .sampled_images = 1};
  info.push_constant_bytes = sizeof(kernels::ScreenConstants);
  info.kernels = {{KernelId::screen}};
  info.max_sets = max_images;
  return info;
}

Result<void> check_cluster_count(const System& system, const TextureFootprint& footprint) {
  const std::size_t count = footprint.clusters.size();
  if (count > 0 && count <= kernels::kMaxWorkgroups) return {};
  return fail(ErrorCode::usage, "system '" + system.name + "' has " + std::to_string(count) +
                                    " clusters that show the image, expected 1 to " +
                                    std::to_string(kernels::kMaxWorkgroups));
}

}  // namespace

Result<ScreenPass> ScreenPass::create(const HostDevice& host, const System& system,
                                      const TextureFootprint& footprint, const ScreenPassOptions& options) {
  if (auto checked = check_cluster_count(system, footprint); !checked)
    return tl::unexpected<Error>(checked.error());
  const std::string owner = "screen of '" + system.name + "' ";
  std::vector<BufferRequirement> buffers{
      storage_requirement(owner + "clusters", footprint.clusters.size() * sizeof(kernels::uvec4)),
      storage_requirement(owner + "samples", footprint.samples.size() * sizeof(FootprintSample))};
  if (auto checked = check_storage_sizes(buffers); !checked) return tl::unexpected<Error>(checked.error());
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  auto set = KernelSet::create(host, *functions, kernel_set_info(options.max_images));
  if (!set) return tl::unexpected<Error>(set.error());
  ScreenPass pass(*functions, std::move(*set));
  pass.buffers_ = std::move(buffers);
  pass.clusters_of_system_ = static_cast<std::uint32_t>(system.clusters.size());
  pass.constants_.clusters = static_cast<kernels::uint>(footprint.clusters.size());
  pass.constants_.sets_albedo = options.target == ScreenTarget::albedo ? 1u : 0u;
  pass.constants_.max_albedo = static_cast<float>(std::min(options.max_albedo, 0.9999));
  return pass;
}

Result<void> ScreenPass::bind(std::span<const BufferRange> ranges, const ClusterColorRanges& colors) {
  auto fitted = fit_ranges(buffers_, ranges);
  if (!fitted) return tl::unexpected<Error>(fitted.error());
  const auto outputs = fit_color_ranges(clusters_of_system_, colors.albedo, colors.exitance);
  if (!outputs) return tl::unexpected<Error>(outputs.error());
  fitted->insert(fitted->end(), outputs->begin(), outputs->end());
  ranges_ = std::move(*fitted);
  return {};
}

Result<std::uint32_t> ScreenPass::add_image(const SampledImage& image) {
  const auto set = kernels_.make_set(ranges_, {}, {}, {&image, 1});
  if (!set) return tl::unexpected<Error>(set.error());
  sets_.push_back(*set);
  return static_cast<std::uint32_t>(sets_.size() - 1);
}

void ScreenPass::record(VkCommandBuffer commands, std::uint32_t image, const Rgb& factor) const {
  const ScopedLabel label(functions_, commands, "relume screen");
  const Rgb worth = constants_.sets_albedo != 0 ? factor : exitance_from_radiance(factor);
  kernels::ScreenConstants constants = constants_;
  constants.factor = {static_cast<float>(worth.x), static_cast<float>(worth.y), static_cast<float>(worth.z),
                      0.0f};
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
  kernels_.record(commands, 0, sets_[image], std::as_bytes(std::span(&constants, 1)), constants.clusters);
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
}

UploadData screen_data(const TextureFootprint& footprint) {
  std::vector<kernels::uvec4> clusters;
  for (const ClusterFootprint& cluster : footprint.clusters)
    clusters.push_back({cluster.cluster, cluster.first_sample, cluster.sample_count, 0});
  UploadData data;
  data.add_owned(0, 0, owned_bytes(clusters));
  data.add_owned(1, 0, owned_bytes(footprint.samples));
  return data;
}

}  // namespace relume
