// SPDX-License-Identifier: MIT
#include "compute/gpu_solver.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "compute/device_functions.h"
#include "compute/guest.h"
#include "compute/recording.h"
#include "compute/solver_data.h"
#include "compute/solver_state.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

constexpr std::pair<RowKernel, std::string_view> kRowKernelNames[] = {
    {RowKernel::row_per_thread, "row_per_thread"},
    {RowKernel::row_per_8_lanes, "row_per_8_lanes"},
};

/// Both alignments are powers of two.
LayoutLimits layout_limits(const VkPhysicalDeviceLimits& limits) {
  return {limits.maxStorageBufferRange,
          std::max(limits.minStorageBufferOffsetAlignment, limits.minTexelBufferOffsetAlignment)};
}

Result<MatrixFetch> choose_fetch(const SolverOptions& options, const SolverLayout& layout,
                                 VkDeviceSize max_texels) {
  const VkDeviceSize needed = largest_texel_buffer(layout);
  if (options.fetch == MatrixFetch::texels && needed > max_texels) {
    return fail(ErrorCode::no_device, "a block of the matrices needs texel buffers of " +
                                          std::to_string(needed) + " elements, but the device has at most " +
                                          std::to_string(max_texels));
  }
  return options.fetch.value_or(needed > max_texels ? MatrixFetch::storage : MatrixFetch::texels);
}

Result<void> add_pass_pipelines(Pipelines& pipelines, const Pass& pass, RowKernel row_kernel) {
  for (const DispatchStep& step : pass) {
    if (auto added = pipelines.add(step_kernel_id(step.kernel, row_kernel), step.format); !added)
      return added;
  }
  return {};
}

Result<void> add_all_pipelines(Pipelines& pipelines, const Pass& bounce, const Pass& gather,
                               RowKernel row_kernel) {
  for (const KernelId kernel : {KernelId::start, KernelId::residual}) {
    if (auto added = pipelines.add(kernel, {}); !added) return added;
  }
  if (auto added = add_pass_pipelines(pipelines, bounce, row_kernel); !added) return added;
  return add_pass_pipelines(pipelines, gather, row_kernel);
}

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

Rgb floats_of(const kernels::uvec4& bits) {
  return {std::bit_cast<float>(bits.x), std::bit_cast<float>(bits.y), std::bit_cast<float>(bits.z)};
}

}  // namespace

std::string_view row_kernel_name(RowKernel kernel) {
  for (const auto& [value, name] : kRowKernelNames) {
    if (value == kernel) return name;
  }
  return {};
}

std::optional<RowKernel> row_kernel_from_name(std::string_view name) {
  for (const auto& [value, known] : kRowKernelNames) {
    if (known == name) return value;
  }
  return std::nullopt;
}

Residual read_residual(std::span<const std::byte> bytes) {
  kernels::ResidualRecord record{};
  std::memcpy(&record, bytes.data(), std::min(bytes.size(), sizeof record));
  return {floats_of(record.weighted_change), floats_of(record.change), floats_of(record.weighted_radiosity),
          floats_of(record.radiosity)};
}

GpuSolver::GpuSolver(std::unique_ptr<SolverState> state) : state_(std::move(state)) {}
GpuSolver::GpuSolver(GpuSolver&&) noexcept = default;
GpuSolver& GpuSolver::operator=(GpuSolver&&) noexcept = default;
GpuSolver::~GpuSolver() = default;

Result<GpuSolver> GpuSolver::create(const HostDevice& host, const Model& model,
                                    const SolverOptions& options) {
  const auto limits = device_limits(host);
  if (!limits) return tl::unexpected<Error>(limits.error());
  auto layout = solver_layout(model, layout_limits(*limits));
  if (!layout) return tl::unexpected<Error>(layout.error());
  const auto fetch = choose_fetch(options, *layout, limits->maxTexelBufferElements);
  if (!fetch) return tl::unexpected<Error>(fetch.error());
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  auto pipelines = Pipelines::create(host, *functions, *fetch);
  if (!pipelines) return tl::unexpected<Error>(pipelines.error());

  const std::uint64_t slice = std::max<std::uint64_t>(options.max_dispatch_form_factors, 1);
  Pass bounce = plan_pass(model, *layout, StepKernel::bounce, options.kernel, slice);
  Pass gather = plan_pass(model, *layout, StepKernel::gather, options.kernel, slice);
  if (auto added = add_all_pipelines(*pipelines, bounce, gather, options.kernel); !added) {
    return tl::unexpected<Error>(added.error());
  }
  return GpuSolver(std::make_unique<SolverState>(SolverState{host,
                                                             *functions,
                                                             options,
                                                             limits->maxTexelBufferElements,
                                                             std::move(*layout),
                                                             std::move(*pipelines),
                                                             std::move(bounce),
                                                             std::move(gather),
                                                             {},
                                                             {}}));
}

std::span<const BufferRequirement> GpuSolver::buffers() const {
  return state_->layout.buffers;
}

Result<void> GpuSolver::bind(std::span<const BufferRange> ranges) {
  auto exact = fit_ranges(buffers(), ranges);
  if (!exact) return tl::unexpected<Error>(exact.error());
  auto sets = make_descriptor_sets(state_->host, state_->functions, state_->pipelines, state_->layout, *exact,
                                   state_->max_texels);
  if (!sets) return tl::unexpected<Error>(sets.error());
  state_->ranges = std::move(*exact);
  state_->sets = std::move(*sets);
  return {};
}

Result<void> GpuSolver::bind(const BufferAllocator& allocate) {
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : buffers()) {
    auto range = allocate(buffer);
    if (!range) return tl::unexpected<Error>(range.error());
    ranges.push_back(*range);
  }
  return bind(ranges);
}

UploadData GpuSolver::model_data(const Model& model) const {
  return model_upload(model, state_->layout);
}

UploadData GpuSolver::lighting_data(const Lighting& lighting, const std::vector<Rgb>& weights) const {
  return lighting_upload(lighting, weights, state_->layout);
}

UploadData GpuSolver::radiosity_data(const std::vector<Rgb>& radiosity, RadiosityHalf half) const {
  return radiosity_upload(radiosity, half == RadiosityHalf::a ? kRadiosityA : kRadiosityB);
}

bool GpuSolver::record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                              UploadCursor& cursor) const {
  return record_upload_part(state_->functions, commands, data, state_->ranges, staging, cursor);
}

RadiosityHalf GpuSolver::record_start(VkCommandBuffer commands) const {
  const ScopedLabel label(state_->functions, commands, "relume start");
  record_solve_kernel(*state_, commands, KernelId::start, RadiosityHalf::a);
  record_barrier(state_->functions, commands, kComputeWrite, kComputeAndCopy);
  return RadiosityHalf::a;
}

RadiosityHalf GpuSolver::record_bounces(VkCommandBuffer commands, std::uint32_t count,
                                        RadiosityHalf from) const {
  for (std::uint32_t i = 0; i < count; ++i) {
    PassCursor cursor;
    record_bounce_part(commands, from, cursor, kNoLimit);
    from = other_half(from);
  }
  return from;
}

PassPart GpuSolver::record_bounce_part(VkCommandBuffer commands, RadiosityHalf from, PassCursor& cursor,
                                       std::uint64_t max_cost) const {
  const ScopedLabel label(state_->functions, commands, "relume bounce");
  return record_pass_part(*state_, commands, state_->bounce, from, cursor, max_cost);
}

void GpuSolver::record_gather(VkCommandBuffer commands, RadiosityHalf from) const {
  PassCursor cursor;
  record_gather_part(commands, from, cursor, kNoLimit);
}

PassPart GpuSolver::record_gather_part(VkCommandBuffer commands, RadiosityHalf from, PassCursor& cursor,
                                       std::uint64_t max_cost) const {
  const ScopedLabel label(state_->functions, commands, "relume gather");
  return record_pass_part(*state_, commands, state_->gather, from, cursor, max_cost);
}

void GpuSolver::record_residual(VkCommandBuffer commands, RadiosityHalf last) const {
  const ScopedLabel label(state_->functions, commands, "relume residual");
  const BufferRange record = residual();
  record_barrier(state_->functions, commands, kComputeAndCopy, kTransferWrite);
  state_->functions.cmd_fill_buffer(commands, record.buffer, record.offset, record.byte_size, 0);
  record_barrier(state_->functions, commands, kTransferWrite, kComputeAndCopy);
  record_solve_kernel(*state_, commands, KernelId::residual, other_half(last));
  record_barrier(state_->functions, commands, kComputeWrite, kComputeAndCopy);
}

std::uint64_t GpuSolver::bounce_cost() const {
  return pass_cost(state_->bounce);
}

BufferRange GpuSolver::radiosity(RadiosityHalf half) const {
  const BufferRange& senders = state_->ranges[half == RadiosityHalf::a ? kRadiosityA : kRadiosityB];
  return {senders.buffer, senders.offset, state_->layout.clusters * kRgbBytes};
}

BufferRange GpuSolver::irradiance(std::uint32_t system) const {
  const SystemLayout& layout = state_->layout.systems[system];
  const BufferRange& whole = state_->ranges[layout.irradiance_buffer];
  return {whole.buffer, whole.offset, layout.gather_rows * kRgbBytes};
}

BufferRange GpuSolver::direct_irradiance() const {
  return state_->ranges[kDirect];
}

BufferRange GpuSolver::residual() const {
  return state_->ranges[kResidual];
}

}  // namespace relume
