// SPDX-License-Identifier: MIT
#include "compute/material_pass.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "compute/pass_buffers.h"
#include "compute/recording.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

kernels::vec4 state_vector(const Rgb& color, float what) {
  return {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z), what};
}

std::size_t state_count(const Model& model, std::uint32_t system, StatePer states) {
  return states == StatePer::material ? model.materials.size() : model.systems[system].clusters.size();
}

kernels::uvec4 bits_of(const std::array<float, 3>& color, kernels::uint last) {
  return {std::bit_cast<kernels::uint>(color[0]), std::bit_cast<kernels::uint>(color[1]),
          std::bit_cast<kernels::uint>(color[2]), last};
}

}  // namespace

kernels::MaterialState replaced_material(const std::optional<Rgb>& albedo,
                                         const std::optional<Rgb>& radiance) {
  kernels::MaterialState state{{0, 0, 0, kernels::kKeepStored}, {0, 0, 0, kernels::kKeepStored}};
  if (albedo) state.albedo = state_vector(*albedo, kernels::kReplaceStored);
  if (radiance) state.exitance = state_vector(exitance_from_radiance(*radiance), kernels::kReplaceStored);
  return state;
}

kernels::MaterialState scaled_material(const Rgb& albedo_factor, const Rgb& exitance_factor) {
  return {state_vector(albedo_factor, kernels::kScaleStored),
          state_vector(exitance_factor, kernels::kScaleStored)};
}

Result<MaterialPass> MaterialPass::create(const HostDevice& host, const Model& model, std::uint32_t system,
                                          const MaterialPassOptions& options) {
  const System& of = model.systems[system];
  if (of.clusters.empty()) return fail(ErrorCode::usage, "system '" + of.name + "' has no clusters");
  const std::string owner = "materials of '" + of.name + "' ";
  std::vector<BufferRequirement> buffers{
      storage_requirement(owner + "stored", 2 * of.clusters.size() * sizeof(kernels::uvec4)),
      storage_requirement(owner + "states",
                          state_count(model, system, options.states) * sizeof(kernels::MaterialState))};
  if (auto checked = check_storage_sizes(buffers); !checked) return tl::unexpected<Error>(checked.error());
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  KernelSetInfo info;
  info.shape = {.storage_buffers = kernels::kMaterialBuffers};
  info.push_constant_bytes = sizeof(kernels::MaterialConstants);
  info.kernels = {{KernelId::materials}};
  auto set = KernelSet::create(host, *functions, info);
  if (!set) return tl::unexpected<Error>(set.error());
  MaterialPass pass(*functions, std::move(*set));
  pass.buffers_ = std::move(buffers);
  pass.constants_ = {static_cast<kernels::uint>(of.clusters.size()),
                     options.states == StatePer::cluster ? 1u : 0u,
                     static_cast<float>(std::min(options.max_albedo, 0.9999))};
  return pass;
}

Result<void> MaterialPass::bind(std::span<const BufferRange> ranges, const ClusterColorRanges& colors) {
  auto fitted = fit_ranges(buffers_, ranges);
  if (!fitted) return tl::unexpected<Error>(fitted.error());
  const auto outputs = fit_color_ranges(constants_.clusters, colors.albedo, colors.exitance);
  if (!outputs) return tl::unexpected<Error>(outputs.error());
  fitted->insert(fitted->end(), outputs->begin(), outputs->end());
  const auto set = kernels_.make_set(*fitted);
  if (!set) return tl::unexpected<Error>(set.error());
  set_ = *set;
  return {};
}

void MaterialPass::record(VkCommandBuffer commands) const {
  const ScopedLabel label(functions_, commands, "relume materials");
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
  const std::uint32_t workgroups = std::min(
      (constants_.clusters + kernels::kWorkgroupSize - 1) / kernels::kWorkgroupSize, kernels::kMaxWorkgroups);
  kernels_.record(commands, 0, set_, std::as_bytes(std::span(&constants_, 1)), workgroups);
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
}

UploadData material_data(const Model& model, std::uint32_t system, StatePer states) {
  std::vector<kernels::uvec4> stored;
  for (const Cluster& cluster : model.systems[system].clusters) {
    stored.push_back(bits_of(cluster.albedo, cluster.material));
    stored.push_back(bits_of(cluster.exitance, 0));
  }
  const std::vector<kernels::MaterialState> kept(state_count(model, system, states),
                                                 replaced_material({}, {}));
  UploadData data;
  data.add_owned(0, 0, owned_bytes(stored));
  data.add_owned(1, 0, owned_bytes(kept));
  return data;
}

}  // namespace relume
