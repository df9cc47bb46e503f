// SPDX-License-Identifier: MIT
#include "compute/light_cache.h"

#include <algorithm>
#include <string>
#include <utility>

#include "compute/pass_buffers.h"
#include "compute/pass_plan.h"
#include "compute/recording.h"
#include "kernels/shared/light_cache.h"

namespace relume {
namespace {

constexpr VkDeviceSize kColorBytes = sizeof(kernels::vec4);

}  // namespace

Result<LightCache> LightCache::create(const HostDevice& host, std::uint32_t rows, std::uint32_t lights) {
  if (rows == 0 || lights == 0 || lights > kMaxCachedLights) {
    return fail(ErrorCode::usage, "a light cache is for 1 to " + std::to_string(kMaxCachedLights) +
                                      " lights and at least one row, found " + std::to_string(lights) +
                                      " and " + std::to_string(rows));
  }
  std::vector<BufferRequirement> buffers{storage_requirement("light responses", kColorBytes * rows * lights),
                                         storage_requirement("light colours", kColorBytes * lights)};
  if (auto checked = check_storage_sizes(buffers); !checked) return tl::unexpected<Error>(checked.error());
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  KernelSetInfo info;
  info.shape = {.storage_buffers = kernels::kLightCacheBuffers};
  info.push_constant_bytes = sizeof(kernels::LightCacheConstants);
  info.kernels = {{KernelId::combine_lights}};
  auto set = KernelSet::create(host, *functions, info);
  if (!set) return tl::unexpected<Error>(set.error());
  LightCache cache(*functions, std::move(*set));
  cache.buffers_ = std::move(buffers);
  cache.rows_ = rows;
  cache.lights_ = lights;
  return cache;
}

Result<void> LightCache::bind(std::span<const BufferRange> ranges, const BufferRange& irradiance) {
  auto fitted = fit_ranges(buffers_, ranges);
  if (!fitted) return tl::unexpected<Error>(fitted.error());
  const BufferRequirement needed{"irradiance", kColorBytes * rows_, kColorBytes, 0};
  const auto output = fit_ranges({&needed, 1}, {&irradiance, 1});
  if (!output) return tl::unexpected<Error>(output.error());
  ranges_ = std::move(*fitted);
  ranges_.push_back(output->front());
  const auto set = kernels_.make_set(ranges_);
  if (!set) return tl::unexpected<Error>(set.error());
  set_ = *set;
  return {};
}

void LightCache::record_keep(VkCommandBuffer commands, std::uint32_t light) const {
  record_keep(commands, light, ranges_[kernels::kCachedIrradianceBinding]);
}

void LightCache::record_keep(VkCommandBuffer commands, std::uint32_t light,
                             const BufferRange& irradiance) const {
  const ScopedLabel label(functions_, commands, "relume light response");
  const BufferRange& responses = ranges_[kernels::kCachedResponsesBinding];
  const VkDeviceSize bytes = kColorBytes * rows_;
  const VkBufferCopy copy{irradiance.offset, responses.offset + light * bytes, bytes};
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
  functions_.cmd_copy_buffer(commands, irradiance.buffer, responses.buffer, 1, &copy);
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
}

void LightCache::record(VkCommandBuffer commands, std::span<const Rgb> colors) const {
  const ScopedLabel label(functions_, commands, "relume lights combined");
  std::vector<kernels::vec4> values;
  for (const Rgb& color : colors.first(std::min<std::size_t>(colors.size(), lights_)))
    values.push_back(
        {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z), 0.0f});
  const kernels::LightCacheConstants constants{rows_, static_cast<kernels::uint>(values.size())};
  const BufferRange& target = ranges_[kernels::kCachedColorsBinding];
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
  if (!values.empty())
    functions_.cmd_update_buffer(commands, target.buffer, target.offset, values.size() * kColorBytes,
                                 values.data());
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
  kernels_.record(commands, 0, set_, std::as_bytes(std::span(&constants, 1)), workgroup_count(rows_));
  record_barrier(functions_, commands, kComputeAndTransfer, kComputeAndTransfer);
}

}  // namespace relume
