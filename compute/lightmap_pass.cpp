// SPDX-License-Identifier: MIT
#include "compute/lightmap_pass.h"

#include <algorithm>
#include <array>
#include <utility>

#include "compute/pass_buffers.h"
#include "compute/recording.h"
#include "core/directional_irradiance.h"
#include "kernels/shared/glsl_types.h"
#include "kernels/shared/lightmap.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

struct FormatTraits {
  VkFormat format;
  VkFormat storage_view_format;
  VkImageCreateFlags flags;
  KernelId kernel;
};

/// Storage of the view formats is mandatory in Vulkan; of the formats of 32 bits it is not.
FormatTraits traits_of(LightmapFormat format) {
  constexpr VkImageCreateFlags kMutable = VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT;
  constexpr VkImageCreateFlags kExtended = kMutable | VK_IMAGE_CREATE_EXTENDED_USAGE_BIT;
  switch (format) {
    case LightmapFormat::r11g11b10f:
      return {VK_FORMAT_B10G11R11_UFLOAT_PACK32, VK_FORMAT_R32_UINT, kExtended,
              KernelId::lightmap_r11g11b10f};
    case LightmapFormat::rgb9e5:
      return {VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, VK_FORMAT_R32_UINT, kExtended, KernelId::lightmap_rgb9e5};
    case LightmapFormat::direction_rgba16f:
      return {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R16G16B16A16_UINT, kMutable,
              KernelId::lightmap_direction};
    case LightmapFormat::rgba16f:
      break;
  }
  return {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R16G16B16A16_UINT, kMutable, KernelId::lightmap_rgba16f};
}

/// Some 20 ms on two cores of a processor.
constexpr std::uint32_t kMaxDispatchTexels = 1u << 18;
static_assert(kMaxDispatchTexels / kernels::kWorkgroupSize <= kernels::kMaxWorkgroups);

constexpr VkDeviceSize kTexelBytes = 2 * sizeof(kernels::uint);

std::vector<BufferRequirement> buffers_for(const System& system, const LightmapTexels& texels) {
  const std::string owner = "lightmap '" + system.name + "' ";
  return {storage_requirement(owner + "texels", (texels.texels.size() + 1) * kTexelBytes),
          storage_requirement(owner + "lumels", texels.lumels.size() * sizeof(kernels::uint))};
}

}  // namespace

Result<LightmapPass> LightmapPass::create(const HostDevice& host, const System& system,
                                          const LightmapTexels& texels, LightmapFormat format) {
  if (texels.texels.empty()) {
    return fail(ErrorCode::usage, "system '" + system.name + "' has no lumel that a lightmap could show");
  }
  const bool shows_direction = format == LightmapFormat::direction_rgba16f;
  if (shows_direction && !is_directional(system)) {
    return fail(ErrorCode::usage,
                "a lightmap of directions needs a model that has them (precompute "
                "--directional), found none in system '" +
                    system.name + "'");
  }
  std::vector<BufferRequirement> buffers = buffers_for(system, texels);
  if (auto checked = check_storage_sizes(buffers); !checked) return tl::unexpected<Error>(checked.error());
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  const FormatTraits traits = traits_of(format);
  KernelSetInfo info;
  info.shape = {.storage_buffers = kernels::kLightmapBuffers, .storage_images = 1};
  info.push_constant_bytes = sizeof(kernels::LightmapRange);
  info.kernels = {{traits.kernel}};
  auto set = KernelSet::create(host, *functions, info);
  if (!set) return tl::unexpected<Error>(set.error());

  LightmapPass pass(*functions, std::move(*set));
  pass.image_ = {traits.format,
                 traits.storage_view_format,
                 {system.lightmap_width, system.lightmap_height},
                 VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                 traits.flags};
  pass.buffers_ = std::move(buffers);
  pass.texels_ = static_cast<std::uint32_t>(texels.texels.size());
  pass.input_bytes_ = system.lumels.size() * sizeof(kernels::vec4);
  pass.shows_direction_ = shows_direction;
  return pass;
}

Result<void> LightmapPass::bind(std::span<const BufferRange> ranges, const LightmapInputs& inputs,
                                VkImageView storage_view) {
  auto fitted = fit_ranges(buffers_, ranges);
  if (!fitted) return tl::unexpected<Error>(fitted.error());
  if (auto checked = check_moments(inputs); !checked) return checked;
  // Their offsets are those that the solver was bound with.
  const std::array<BufferRequirement, 2> inputs_needed{
      {{"irradiance", input_bytes_, sizeof(kernels::vec4), 0},
       {"direct irradiance", input_bytes_, sizeof(kernels::vec4), 0}}};
  auto read =
      fit_ranges(inputs_needed, std::array{inputs.irradiance, inputs.direct.value_or(inputs.irradiance)});
  if (!read) return tl::unexpected<Error>(read.error());
  if (storage_view == VK_NULL_HANDLE)
    return fail(ErrorCode::usage, "lightmap: expected a view of the host's image, found VK_NULL_HANDLE");
  if (inputs.moments) read->front().byte_size = inputs.irradiance.byte_size + inputs.moments->byte_size;
  fitted->insert(fitted->end(), read->begin(), read->end());
  const auto set = kernels_.make_set(*fitted, {}, {&storage_view, 1});
  if (!set) return tl::unexpected<Error>(set.error());
  set_ = *set;
  adds_direct_ = inputs.direct.has_value();
  return {};
}

Result<void> LightmapPass::check_moments(const LightmapInputs& inputs) const {
  if (shows_direction_ != inputs.moments.has_value()) {
    return fail(ErrorCode::usage, shows_direction_ ? "a lightmap of directions reads moments, found none"
                                                   : "a lightmap of irradiance reads no moments");
  }
  if (!shows_direction_) return {};
  if (inputs.direct) return fail(ErrorCode::usage, "a lightmap of directions shows indirect light alone");
  const BufferRange &rows = inputs.irradiance, &moments = *inputs.moments;
  if (moments.buffer == rows.buffer && moments.offset == rows.offset + rows.byte_size &&
      moments.byte_size == 3 * rows.byte_size)
    return {};
  return fail(ErrorCode::usage,
              "moments of a lightmap lie behind its irradiance and are three times as many");
}

void LightmapPass::record(VkCommandBuffer commands) const {
  const ScopedLabel label(functions_, commands, "relume lightmap");
  for (std::uint32_t first = 0; first < texels_; first += kMaxDispatchTexels) {
    const std::uint32_t count = std::min(texels_ - first, kMaxDispatchTexels);
    const kernels::LightmapRange range{first, count, adds_direct_ ? 1u : 0u};
    const std::uint32_t workgroups = (count + kernels::kWorkgroupSize - 1) / kernels::kWorkgroupSize;
    kernels_.record(commands, 0, set_, std::as_bytes(std::span(&range, 1)), workgroups);
  }
}

UploadData lightmap_data(const LightmapTexels& texels) {
  std::vector<kernels::uint> records;
  records.reserve(2 * texels.first_lumel.size());
  for (std::size_t i = 0; i < texels.texels.size(); ++i) {
    records.push_back(texels.texels[i].x | (kernels::uint{texels.texels[i].y} << 16));
    records.push_back(texels.first_lumel[i]);
  }
  records.push_back(0);
  records.push_back(texels.first_lumel.back());
  UploadData data;
  data.add_owned(0, 0, owned_bytes(records));
  data.add_owned(1, 0, owned_bytes(texels.lumels));
  return data;
}

}  // namespace relume
