// SPDX-License-Identifier: MIT
#include "compute/standalone/solver_session.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <span>

#include "compute/room_tables.h"
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

}  // namespace

SolverSession::SolverSession(StandaloneDevice& device, const Model& model, const SessionLimits& limits,
                             GpuSolver solver, std::uint32_t lightings)
    : device_(&device),
      first_cluster_(cluster_offsets(model)),
      limits_(limits),
      lightings_(lightings),
      schedule_(make_schedule(model.systems.size(), 0.0)),
      arena_(device),
      solver_(std::move(solver)) {}

Result<SolverSession> SolverSession::create(StandaloneDevice& device, const Model& model,
                                            const SolverOptions& options, const SessionLimits& limits) {
  auto solver = GpuSolver::create(device.host(), model, options);
  if (!solver) return tl::unexpected<Error>(solver.error());
  SolverSession session(device, model, limits, std::move(*solver), options.lightings);
  if (auto provided = session.provide_memory(); !provided) return tl::unexpected<Error>(provided.error());
  if (auto loaded = session.load(model); !loaded) return tl::unexpected<Error>(loaded.error());
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

Result<void> SolverSession::load(const Model& model) {
  const auto allocate = [this](const BufferRequirement& requirement) { return arena_.allocate(requirement); };
  UploadData data = solver_.model_data(model);
  for (std::uint32_t system = 0; system < model.systems.size(); ++system) {
    if (!model.systems[system].loaded) continue;
    if (auto loaded = solver_.load(model, system, allocate); !loaded) return loaded;
    data.append(solver_.system_data(model, system));
    activate(solver_.traits(), schedule_, system);
  }
  const auto uploaded = upload(data);
  if (!uploaded) return tl::unexpected<Error>(uploaded.error());
  upload_seconds_ = uploaded->seconds;
  return {};
}

std::uint64_t SolverSession::bounce_cost() const {
  std::uint64_t cost = 0;
  for (const SystemTraits& traits : solver_.traits()) {
    for (const StepKernel kernel :
         {StepKernel::import_radiosity, StepKernel::bounce, StepKernel::small_nodes, StepKernel::nodes}) {
      const std::vector<std::uint64_t>& costs = traits.costs[static_cast<std::size_t>(kernel)];
      cost = std::accumulate(costs.begin(), costs.end(), cost);
    }
  }
  return cost;
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
    sum += *times;
  }
  return sum;
}

Result<void> SolverSession::light(const Lighting& lighting, const std::vector<Rgb>& weights,
                                  std::uint32_t number) {
  const std::vector<Rgb> ones(weights.empty() ? lighting.albedo.size() : 0, Rgb(1.0));
  const std::pair<Quantity, std::span<const Rgb>> quantities[] = {
      {Quantity::albedo, lighting.albedo},
      {Quantity::exitance, lighting.exitance},
      {Quantity::direct, lighting.direct},
      {Quantity::weights, weights.empty() ? ones : weights},
  };
  const auto systems = static_cast<std::uint32_t>(first_cluster_.size() - 1);
  UploadData data = solver_.input_data(systems, Quantity::sky, lighting.sky_radiosity, number);
  for (std::uint32_t system = 0; system < systems; ++system) {
    if (!solver_.loaded(system)) continue;
    const std::size_t first = first_cluster_[system], count = first_cluster_[system + 1] - first;
    for (const auto& [quantity, values] : quantities)
      data.append(solver_.input_data(system, quantity, values.subspan(first, count), number));
  }
  if (auto uploaded = upload(data); !uploaded) return tl::unexpected<Error>(uploaded.error());
  return {};
}

Result<void> SolverSession::set_radiosity(const std::vector<Rgb>& v) {
  UploadData data;
  for (std::uint32_t system = 0; system + 1 < first_cluster_.size(); ++system) {
    if (!solver_.loaded(system)) continue;
    const std::size_t first = first_cluster_[system], count = first_cluster_[system + 1] - first;
    data.append(
        solver_.radiosity_data(system, schedule_.systems[system].half, std::span(v).subspan(first, count)));
    schedule_.systems[system].started = true;
  }
  if (auto uploaded = upload(data); !uploaded) return tl::unexpected<Error>(uploaded.error());
  return {};
}

Result<std::vector<Rgb>> SolverSession::multiply(const std::vector<Rgb>& v) {
  if (auto set = set_radiosity(v); !set) return tl::unexpected<Error>(set.error());
  if (auto bounced = run({.bounces = 1}); !bounced) return tl::unexpected<Error>(bounced.error());
  return read_radiosity();
}

Result<void> SolverSession::correct_by(const Model& model, const RoomWeights& weights) {
  const auto tables = room_tables(model, weights);
  if (!tables) return tl::unexpected<Error>(tables.error());
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : room_buffers(*tables, lightings_)) {
    auto range = arena_.allocate(buffer);
    if (!range) return tl::unexpected<Error>(range.error());
    ranges.push_back(*range);
  }
  if (auto bound = solver_.bind_rooms(*tables, ranges); !bound) return bound;
  if (auto uploaded = upload(solver_.room_data(*tables)); !uploaded)
    return tl::unexpected<Error>(uploaded.error());
  return {};
}

Result<SubmitTimes> SolverSession::run(PassWishes wishes, std::uint32_t times) {
  wishes.max_form_factors = limits_.max_submit_form_factors;
  SubmitTimes sum;
  for (bool complete = false; !complete;) {
    FramePlan plan = solver_.plan(schedule_, wishes);
    Result<void> recorded;
    auto taken = device_->submit(
        [&](VkCommandBuffer commands) {
          for (std::uint32_t i = 0; i < times && recorded; ++i)
            recorded = solver_.record_frame(commands, {.plan = &plan}, {});
        },
        limits_.timeout_seconds);
    if (!recorded) return tl::unexpected<Error>(recorded.error());
    if (!taken) {
      solver_.latch(taken.error());
      return taken;
    }
    sum += *taken;
    complete = plan.pass_complete;
    schedule_ = std::move(plan.next);
  }
  return sum;
}

Result<Residual> SolverSession::residual() {
  const auto bytes = read(solver_.residuals());
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  Residual all;
  const std::vector<Residual> residuals = read_residuals(*bytes);
  for (std::size_t record = 0; record < residuals.size(); ++record) {
    const Residual& residual = residuals[record];
    if (!solver_.loaded(static_cast<std::uint32_t>(record % schedule_.systems.size()))) continue;
    // NaN must not get lost in a maximum.
    const auto raise = [](Rgb& most, const Rgb& value) {
      for (int c = 0; c < 3; ++c) most[c] = value[c] <= most[c] ? most[c] : value[c];
    };
    raise(all.weighted_change, residual.weighted_change);
    raise(all.change, residual.change);
    raise(all.weighted_radiosity, residual.weighted_radiosity);
    raise(all.radiosity, residual.radiosity);
  }
  return all;
}

Result<std::vector<Rgb>> SolverSession::read_radiosity(std::uint32_t lighting) {
  return read_radiosity(lighting, true);
}

Result<std::vector<Rgb>> SolverSession::read_previous_radiosity() {
  return read_radiosity(0, false);
}

Result<std::vector<Rgb>> SolverSession::read_radiosity(std::uint32_t lighting, bool latest) {
  std::vector<Rgb> values;
  for (std::uint32_t system = 0; system < schedule_.systems.size(); ++system) {
    if (!solver_.loaded(system)) continue;
    const std::uint32_t half = schedule_.systems[system].half;
    auto read = append_rgb(solver_.radiosity(system, latest ? half : 1 - half, lighting), values);
    if (!read) return tl::unexpected<Error>(read.error());
  }
  return values;
}

Result<std::vector<Rgb>> SolverSession::read_irradiance(std::uint32_t lighting) {
  std::vector<Rgb> values;
  for (std::uint32_t system = 0; system < schedule_.systems.size(); ++system) {
    if (!solver_.loaded(system)) continue;
    auto read = append_rgb(solver_.irradiance(system, lighting), values);
    if (!read) return tl::unexpected<Error>(read.error());
  }
  return values;
}

Result<std::vector<IrradianceMoments>> SolverSession::read_directional_irradiance(std::uint32_t lighting) {
  std::vector<Rgb> values;
  bool any = false;
  for (std::uint32_t system = 0; system < schedule_.systems.size(); ++system) {
    if (!solver_.loaded(system)) continue;
    const BufferRange moments = solver_.directional_irradiance(system, lighting);
    any = any || moments.byte_size > 0;
    const std::size_t rows = solver_.irradiance(system).byte_size / kRgbBytes;
    if (moments.byte_size == 0) values.resize(values.size() + 3 * rows, Rgb(0.0));
    auto read = append_rgb(moments, values);
    if (!read) return tl::unexpected<Error>(read.error());
  }
  std::vector<IrradianceMoments> all(any ? values.size() / 3 : 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    std::copy_n(values.begin() + std::ptrdiff_t(3 * i), 3, all[i].begin());
  return all;
}

Result<std::vector<ProbeCoefficients>> SolverSession::read_probes(std::uint32_t lighting) {
  std::vector<Rgb> values;
  auto read = append_rgb(solver_.probe_coefficients(lighting), values);
  if (!read) return tl::unexpected<Error>(read.error());
  std::vector<ProbeCoefficients> probes(values.size() / kProbeHarmonics);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::copy_n(values.begin() + std::ptrdiff_t(i * kProbeHarmonics), kProbeHarmonics, probes[i].begin());
  }
  return probes;
}

Result<std::vector<std::byte>> SolverSession::read(const BufferRange& range) {
  std::vector<std::byte> bytes;
  for (VkDeviceSize begin = 0; begin < range.byte_size; begin += kTransferBytes) {
    const VkDeviceSize count = std::min(kTransferBytes, range.byte_size - begin);
    auto times = device_->submit(
        [&](VkCommandBuffer commands) {
          record_copy_to_host(commands, {range.buffer, range.offset + begin, count},
                              {readback_.buffer.get(), 0, count});
        },
        limits_.timeout_seconds);
    if (!times) return tl::unexpected<Error>(times.error());
    bytes.insert(bytes.end(), readback_.mapped, readback_.mapped + count);
  }
  return bytes;
}

Result<void> SolverSession::append_rgb(const BufferRange& range, std::vector<Rgb>& values) {
  using Texel = std::array<float, 4>;
  const auto bytes = read(range);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  for (std::size_t at = 0; at < bytes->size(); at += sizeof(Texel)) {
    Texel texel{};
    std::memcpy(&texel, bytes->data() + at, sizeof texel);
    values.emplace_back(texel[0], texel[1], texel[2]);
  }
  return {};
}

}  // namespace relume
