// SPDX-License-Identifier: MIT
#include "compute/gpu_solver.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "compute/guest.h"
#include "compute/pass_buffers.h"
#include "compute/record_upload.h"
#include "compute/row_kernels.h"
#include "compute/solver_data.h"
#include "compute/solver_state.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

/// Both alignments are powers of two.
LayoutLimits limits_of(const VkPhysicalDeviceLimits& limits, const SolverOptions& options) {
  return {limits.maxStorageBufferRange,
          std::max(limits.minStorageBufferOffsetAlignment, limits.minTexelBufferOffsetAlignment),
          options.half_senders_up_to > 0.0, options.lightings};
}

/// So that single precision has room for scales and products.
constexpr double kMostHalfSenders = 1e30;

/// The power of two that brings the largest radiosity just below the largest half; 0: single precision.
float sender_scale(const SolverOptions& options) {
  constexpr double kLargestHalf = 65504.0;
  if (options.half_senders_up_to <= 0.0) return 0.0f;
  const double exponent = std::floor(std::log2(kLargestHalf / options.half_senders_up_to));
  return static_cast<float>(std::exp2(std::min(exponent, 100.0)));
}

Rgb floats_of(const kernels::uvec4& bits) {
  return {std::bit_cast<float>(bits.x), std::bit_cast<float>(bits.y), std::bit_cast<float>(bits.z)};
}

}  // namespace

std::vector<Residual> read_residuals(std::span<const std::byte> bytes) {
  std::vector<Residual> residuals;
  for (std::size_t at = 0; at + sizeof(kernels::ResidualRecord) <= bytes.size();
       at += sizeof(kernels::ResidualRecord)) {
    kernels::ResidualRecord record{};
    std::memcpy(&record, bytes.data() + at, sizeof record);
    residuals.push_back({floats_of(record.weighted_change), floats_of(record.change),
                         floats_of(record.weighted_radiosity), floats_of(record.radiosity)});
  }
  return residuals;
}

GpuSolver::GpuSolver(std::unique_ptr<SolverState> state) : state_(std::move(state)) {}
GpuSolver::GpuSolver(GpuSolver&&) noexcept = default;
GpuSolver& GpuSolver::operator=(GpuSolver&&) noexcept = default;
GpuSolver::~GpuSolver() = default;

Result<GpuSolver> GpuSolver::create(const HostDevice& host, const Model& model,
                                    const SolverOptions& options) {
  const auto limits = device_limits(host);
  if (!limits) return tl::unexpected<Error>(limits.error());
  if (!(options.half_senders_up_to >= 0.0 && options.half_senders_up_to <= kMostHalfSenders)) {
    return fail(ErrorCode::usage, "half_senders_up_to: expected 0 to " + std::to_string(kMostHalfSenders) +
                                      " lm/m2, found " + std::to_string(options.half_senders_up_to));
  }
  if (options.lightings == 0 || options.lightings > kMaxLightings) {
    return fail(ErrorCode::usage, "lightings: expected 1 to " + std::to_string(kMaxLightings) + ", found " +
                                      std::to_string(options.lightings));
  }
  const RowKernel kernel = options.kernel.value_or(default_tile_kernel(host));
  if (!supports_row_kernel(host, kernel)) {
    return fail(ErrorCode::no_device,
                "the kernel '" + std::string(row_kernel_name(kernel)) +
                    "' needs subgroups of 8 or more with shuffles, which the device lacks");
  }
  const std::uint32_t capacity =
      options.sender_capacity > 0 ? options.sender_capacity : loaded_senders(model);
  const LayoutLimits layout_limits = limits_of(*limits, options);
  auto layout = solver_layout(model, capacity, layout_limits);
  if (!layout) return tl::unexpected<Error>(layout.error());
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  auto pipelines = Pipelines::create(host, *functions, {sender_scale(options), options.lightings});
  if (!pipelines) return tl::unexpected<Error>(pipelines.error());
  const NodeTables sky = node_tables(model.sky_tree, layout->sky_patches);
  for (const KernelId of_nodes : {KernelId::small_nodes, KernelId::nodes}) {
    if (sky.records.empty()) break;
    if (auto added = pipelines->add(of_nodes, {}); !added) return tl::unexpected<Error>(added.error());
  }
  SenderRanges senders(layout->system_places(), layout->sender_step);
  const std::size_t systems = model.systems.size();
  auto state = std::make_unique<SolverState>(
      SolverState{host,
                  *functions,
                  options,
                  kernel,
                  layout_limits,
                  limits->maxTexelBufferElements,
                  std::move(*layout),
                  std::move(*pipelines),
                  plan_small_nodes(sky, MatrixFetch::storage),
                  plan_nodes(sky, RowKernel::row_per_8_lanes, MatrixFetch::storage),
                  std::move(senders),
                  {},
                  {},
                  {},
                  {},
                  {},
                  {}});
  state->systems.resize(systems);
  state->traits.resize(systems);
  return GpuSolver(std::move(state));
}

std::span<const BufferRequirement> GpuSolver::buffers() const {
  return state_->layout.buffers;
}

Result<void> GpuSolver::bind(std::span<const BufferRange> ranges) {
  if (state_->failure) return tl::unexpected<Error>(*state_->failure);
  auto exact = fit_ranges(buffers(), ranges);
  if (!exact) return tl::unexpected<Error>(exact.error());
  auto sets =
      make_solve_sets(state_->host, state_->functions, state_->pipelines, *exact,
                      radiosity_part(state_->layout, (*exact)[kRadiosity], 0, state_->layout.sky_senders()),
                      state_->max_texels);
  if (!sets) {
    latch_failure(*state_, sets.error());
    return tl::unexpected<Error>(sets.error());
  }
  state_->ranges = std::move(*exact);
  state_->sets = std::move(*sets);
  return {};
}

Result<void> GpuSolver::bind(const BufferAllocator& allocate) {
  const auto ranges = allocate_ranges(buffers(), allocate);
  if (!ranges) return tl::unexpected<Error>(ranges.error());
  return bind(*ranges);
}

Result<std::vector<BufferRequirement>> GpuSolver::system_buffers(const Model& model,
                                                                 std::uint32_t system) const {
  auto layout = loadable_layout(*state_, model, system);
  if (!layout) return tl::unexpected<Error>(layout.error());
  return std::move(layout->buffers);
}

Result<void> GpuSolver::load(const Model& model, std::uint32_t system, std::span<const BufferRange> ranges,
                             std::span<const Rgb> albedo) {
  return load_system(*state_, model, system, ranges, albedo);
}

Result<void> GpuSolver::load(const Model& model, std::uint32_t system, const BufferAllocator& allocate,
                             std::span<const Rgb> albedo) {
  const auto needed = system_buffers(model, system);
  if (!needed) return tl::unexpected<Error>(needed.error());
  const auto ranges = allocate_ranges(*needed, allocate);
  if (!ranges) return tl::unexpected<Error>(ranges.error());
  return load(model, system, *ranges, albedo);
}

void GpuSolver::unload(std::uint32_t system) {
  unload_system(*state_, system);
}

Result<void> GpuSolver::bind_rooms(const RoomTables& tables, std::span<const BufferRange> ranges) {
  if (state_->failure) return tl::unexpected<Error>(*state_->failure);
  auto bound = load_rooms(*state_, tables, ranges);
  if (!bound && bound.error().code != ErrorCode::usage) latch_failure(*state_, bound.error());
  return bound;
}

UploadData GpuSolver::room_data(const RoomTables& tables) const {
  UploadData data = room_upload(tables, state_->layout.lightings);
  data.targets = state_->rooms->ranges;
  return data;
}

bool GpuSolver::loaded(std::uint32_t system) const {
  return system < state_->systems.size() && state_->systems[system] != nullptr;
}

std::span<const SystemTraits> GpuSolver::traits() const {
  return state_->traits;
}

FramePlan GpuSolver::plan(const Schedule& schedule, const FrameWishes& wishes) const {
  return plan_frame(traits(), schedule, wishes);
}

FramePlan GpuSolver::plan(const Schedule& schedule, const PassWishes& wishes) const {
  return plan_together(traits(), schedule, wishes);
}

UploadData GpuSolver::model_data(const Model& model) const {
  UploadData data = model_upload(model, state_->layout);
  data.targets = state_->ranges;
  return data;
}

UploadData GpuSolver::system_data(const Model& model, std::uint32_t system) const {
  const LoadedSystem& loaded = *state_->systems[system];
  UploadData data = system_upload(model, system, loaded.layout);
  data.targets = loaded.ranges;
  return data;
}

UploadData GpuSolver::input_data(std::uint32_t system, Quantity quantity, std::span<const Rgb> values,
                                 std::uint32_t lighting) const {
  UploadData data;
  data.add_owned(0, 0, rgb_bytes(values));
  data.targets = {input(system, quantity, lighting)};
  return data;
}

UploadData GpuSolver::radiosity_data(std::uint32_t system, std::uint32_t half,
                                     std::span<const Rgb> radiosity_of_clusters,
                                     std::uint32_t lighting) const {
  UploadData data;
  data.add_owned(0, 0, rgb_bytes(radiosity_of_clusters));
  data.targets = {radiosity(system, half, lighting)};
  return data;
}

bool GpuSolver::record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                              UploadCursor& cursor) const {
  return relume::record_upload(state_->functions, commands, data.targets, data, staging, cursor);
}

Result<void> GpuSolver::record_frame(VkCommandBuffer commands, const FrameInputs& inputs,
                                     const FrameOutputs& outputs) const {
  if (auto checked = check_frame(*state_, inputs, outputs); !checked) return checked;
  record_checked_frame(*state_, commands, inputs, outputs);
  return {};
}

void GpuSolver::latch(const Error& error) {
  if (!state_->failure) state_->failure = error;
}

BufferRange GpuSolver::input(std::uint32_t system, Quantity quantity, std::uint32_t lighting) const {
  return input_range(*state_, system, quantity, lighting);
}

BufferRange GpuSolver::radiosity(std::uint32_t system, std::uint32_t half, std::uint32_t lighting) const {
  if (lighting >= state_->layout.lightings) return {};
  const LoadedSystem& loaded = *state_->systems[system];
  const BufferRange& senders = state_->ranges[kRadiosity];
  const VkDeviceSize plane = lighting * state_->layout.radiosity_plane.step;
  return {senders.buffer, senders.offset + plane + loaded.first_of_half(half) * kRgbBytes,
          loaded.layout.clusters * kRgbBytes};
}

BufferRange GpuSolver::irradiance(std::uint32_t system, std::uint32_t lighting) const {
  if (lighting >= state_->layout.lightings) return {};
  const LoadedSystem& loaded = *state_->systems[system];
  const BufferRange& whole = loaded.ranges[kIrradiance];
  return {whole.buffer, whole.offset + lighting * loaded.layout.irradiance_plane.step,
          loaded.layout.gather_rows * kRgbBytes};
}

BufferRange GpuSolver::directional_irradiance(std::uint32_t system, std::uint32_t lighting) const {
  const BufferRange rows = irradiance(system, lighting);
  if (!state_->systems[system]->layout.directional || rows.buffer == VK_NULL_HANDLE) return {};
  return {rows.buffer, rows.offset + rows.byte_size, rows.byte_size / kRgbBytes * kMomentBytes};
}

BufferRange GpuSolver::probe_coefficients(std::uint32_t lighting) const {
  if (lighting >= state_->layout.lightings || state_->layout.probes == 0) return {};
  const BufferRange& whole = state_->ranges[kProbeCoefficients];
  const LightingPlane& plane = state_->layout.probes_plane;
  return {whole.buffer, whole.offset + lighting * plane.step, plane.byte_size};
}

BufferRange GpuSolver::residuals() const {
  const BufferRange& whole = state_->ranges[kResiduals];
  return {whole.buffer, whole.offset, state_->layout.residual_bytes()};
}

}  // namespace relume
