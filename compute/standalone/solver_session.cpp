// SPDX-License-Identifier: MIT
#include "compute/standalone/solver_session.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "compute/vulkan_info.h"

namespace relume {
namespace {

constexpr VkDeviceSize kTransferBytes = VkDeviceSize{16} << 20;

void record_copy_to_host(VkCommandBuffer commands, const BufferRange& from, const BufferRange& to) {
  const VkBufferCopy copy{from.offset, to.offset, from.byte_size};
  vkCmdCopyBuffer(commands, from.buffer, to.buffer, 1, &copy);
  auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier,
                       0, nullptr, 0, nullptr);
}

void add(SubmitTimes& sum, const SubmitTimes& times) {
  sum.seconds += times.seconds;
  sum.gpu_seconds += times.gpu_seconds;
}

}  // namespace

Result<SolverSession> SolverSession::create(StandaloneDevice& device, const Model& model,
                                            const SolverOptions& options, const SessionLimits& limits) {
  auto solver = GpuSolver::create(device.host(), model, options);
  if (!solver) return tl::unexpected<Error>(solver.error());
  SolverSession session(device, static_cast<std::uint32_t>(model.systems.size()), limits, std::move(*solver));
  if (auto provided = session.provide_memory(); !provided) return tl::unexpected<Error>(provided.error());
  return session;
}

Result<void> SolverSession::provide_memory() {
  const auto allocate = [this](const BufferRequirement& requirement) { return arena_.allocate(requirement); };
  if (auto bound = solver_.bind(allocate); !bound) return bound;
  auto staging =
      make_device_buffer(*device_, kTransferBytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  if (!staging) return tl::unexpected<Error>(staging.error());
  staging_ = std::move(*staging);
  auto readback =
      make_device_buffer(*device_, kTransferBytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback);
  if (!readback) return tl::unexpected<Error>(readback.error());
  readback_ = std::move(*readback);
  return {};
}

Result<SubmitTimes> SolverSession::upload(const UploadData& data) {
  SubmitTimes sum;
  UploadCursor cursor;
  for (bool done = false; !done;) {
    auto times = device_->submit(
        [&](VkCommandBuffer commands) {
          done = solver_.record_upload(commands, data, {staging_.range(), staging_.mapped}, cursor);
        },
        limits_.timeout_seconds);
    if (!times) return times;
    add(sum, *times);
  }
  return sum;
}

Result<std::vector<Rgb>> SolverSession::multiply(const std::vector<Rgb>& v) {
  latest_ = RadiosityHalf::a;
  if (auto uploaded = upload(solver_.radiosity_data(v, latest_)); !uploaded) {
    return tl::unexpected<Error>(uploaded.error());
  }
  if (auto bounced = bounce(1); !bounced) return tl::unexpected<Error>(bounced.error());
  return read_radiosity();
}

Result<SubmitTimes> SolverSession::start() {
  return device_->submit([this](VkCommandBuffer commands) { latest_ = solver_.record_start(commands); },
                         limits_.timeout_seconds);
}

Result<SubmitTimes> SolverSession::bounce(std::uint32_t count) {
  SubmitTimes sum;
  PassCursor cursor;
  const auto record = [&](VkCommandBuffer commands) {
    std::uint64_t budget = limits_.max_submit_form_factors;
    while (count > 0) {
      const PassPart part = solver_.record_bounce_part(commands, latest_, cursor, budget);
      budget -= std::min(budget, part.cost);
      if (!part.complete) return;
      latest_ = other_half(latest_);
      cursor = {};
      --count;
      if (budget < solver_.bounce_cost()) return;
    }
  };
  while (count > 0) {
    auto times = device_->submit(record, limits_.timeout_seconds);
    if (!times) return times;
    add(sum, *times);
  }
  return sum;
}

Result<Residual> SolverSession::residual() {
  const BufferRange from = solver_.residual();
  auto times = device_->submit(
      [&](VkCommandBuffer commands) {
        solver_.record_residual(commands, latest_);
        record_copy_to_host(commands, from, {readback_.buffer.get(), 0, from.byte_size});
      },
      limits_.timeout_seconds);
  if (!times) return tl::unexpected<Error>(times.error());
  return read_residual({readback_.mapped, from.byte_size});
}

Result<SubmitTimes> SolverSession::gather() {
  SubmitTimes sum;
  PassCursor cursor;
  for (bool done = false; !done;) {
    auto times = device_->submit(
        [&](VkCommandBuffer commands) {
          done =
              solver_.record_gather_part(commands, latest_, cursor, limits_.max_submit_form_factors).complete;
        },
        limits_.timeout_seconds);
    if (!times) return times;
    add(sum, *times);
  }
  return sum;
}

Result<std::vector<Rgb>> SolverSession::read_radiosity() {
  return read_radiosity(latest_);
}

Result<std::vector<Rgb>> SolverSession::read_previous_radiosity() {
  return read_radiosity(other_half(latest_));
}

Result<std::vector<Rgb>> SolverSession::read_radiosity(RadiosityHalf half) {
  std::vector<Rgb> values;
  if (auto read = append_rgb(solver_.radiosity(half), values); !read)
    return tl::unexpected<Error>(read.error());
  return values;
}

Result<std::vector<Rgb>> SolverSession::read_irradiance() {
  std::vector<Rgb> values;
  for (std::uint32_t system = 0; system < systems_; ++system) {
    auto read = append_rgb(solver_.irradiance(system), values);
    if (!read) return tl::unexpected<Error>(read.error());
  }
  return values;
}

Result<void> SolverSession::append_rgb(const BufferRange& range, std::vector<Rgb>& values) {
  using Texel = std::array<float, 4>;
  for (VkDeviceSize begin = 0; begin < range.byte_size; begin += kTransferBytes) {
    const VkDeviceSize bytes = std::min(kTransferBytes, range.byte_size - begin);
    auto times = device_->submit(
        [&](VkCommandBuffer commands) {
          record_copy_to_host(commands, {range.buffer, range.offset + begin, bytes},
                              {readback_.buffer.get(), 0, bytes});
        },
        limits_.timeout_seconds);
    if (!times) return tl::unexpected<Error>(times.error());
    for (VkDeviceSize at = 0; at < bytes; at += sizeof(Texel)) {
      Texel texel{};
      std::memcpy(&texel, readback_.mapped + at, sizeof texel);
      values.emplace_back(texel[0], texel[1], texel[2]);
    }
  }
  return {};
}

}  // namespace relume
