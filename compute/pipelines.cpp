// SPDX-License-Identifier: MIT
#include "compute/pipelines.h"

#include <bit>

#include "kernels/shared/limits.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

static_assert(static_cast<kernels::uint>(ValueCodec::f32) == kernels::kCodecF32);
static_assert(static_cast<kernels::uint>(ValueCodec::unorm16) == kernels::kCodecUnorm16);
static_assert(static_cast<kernels::uint>(ValueCodec::sqrt8) == kernels::kCodecSqrt8);

static_assert(kMaxLightings == kernels::kMaxLightings);

static_assert(static_cast<kernels::uint>(MatrixFetch::storage) == kernels::kFetchStorage);
static_assert(static_cast<kernels::uint>(MatrixFetch::texels) == kernels::kFetchTexels);

constexpr std::array<SetShape, kernels::kSets> kSetShapes = [] {
  std::array<SetShape, kernels::kSets> shapes{};
  shapes[kernels::kSolveSet] = {kernels::kSolveBindings, kernels::kSolveTexelBindings, 0};
  shapes[kernels::kSystemSet] = {kernels::kSystemBindings, kernels::kSystemTexelBindings, 0};
  shapes[kernels::kBlockSet] = {kernels::kBlockBindings, kernels::kBlockTexelBindings, 0};
  return shapes;
}();

KernelId bounce_kernel(RowKernel row_kernel) {
  switch (row_kernel) {
    case RowKernel::row_per_thread:
      return KernelId::bounce_row_per_thread;
    case RowKernel::tile_shared:
      return KernelId::bounce_tile_shared;
    case RowKernel::tile_shuffle:
      return KernelId::bounce_tile_shuffle;
    case RowKernel::row_per_8_lanes:
      break;
  }
  return KernelId::bounce_row_per_8_lanes;
}

KernelId gather_kernel(RowKernel row_kernel) {
  switch (row_kernel) {
    case RowKernel::row_per_thread:
      return KernelId::gather_row_per_thread;
    case RowKernel::tile_shared:
      return KernelId::gather_tile_shared;
    case RowKernel::tile_shuffle:
      return KernelId::gather_tile_shuffle;
    case RowKernel::row_per_8_lanes:
      break;
  }
  return KernelId::gather_row_per_8_lanes;
}

}  // namespace

SetShape set_shape(std::uint32_t set) {
  return kSetShapes[set];
}

KernelId step_kernel_id(StepKernel step, RowKernel row_kernel, std::uint32_t tile_rows) {
  const RowKernel of_rows = row_kernel_for(row_kernel, tile_rows);
  switch (step) {
    case StepKernel::bounce:
      return bounce_kernel(of_rows);
    case StepKernel::gather:
      return gather_kernel(of_rows);
    case StepKernel::start:
      return KernelId::start;
    case StepKernel::small_nodes:
      return KernelId::small_nodes;
    case StepKernel::nodes:
      return row_kernel == RowKernel::tile_shuffle ? KernelId::nodes_shuffle : KernelId::nodes;
    case StepKernel::residual:
      return KernelId::residual;
    case StepKernel::directions:
      return KernelId::directions;
    case StepKernel::probes:
      return KernelId::probes;
    case StepKernel::restrict_rooms:
      return KernelId::restrict_rooms;
    case StepKernel::solve_rooms:
      return KernelId::solve_rooms;
    case StepKernel::correct_rooms:
      return KernelId::correct_rooms;
    case StepKernel::import_radiosity:
      break;
  }
  return KernelId::import_radiosity;
}

Result<Pipelines> Pipelines::create(const HostDevice& host, const DeviceFunctions& functions,
                                    const KernelConstants& constants) {
  Pipelines pipelines(host, functions, constants);
  for (std::uint32_t set = 0; set < kernels::kSets; ++set) {
    auto layout = make_set_layout(host, functions, set_shape(set));
    if (!layout) return tl::unexpected<Error>(layout.error());
    pipelines.set_layouts_[set] = std::move(*layout);
  }
  std::array<VkDescriptorSetLayout, kernels::kSets> sets{};
  for (std::size_t i = 0; i < sets.size(); ++i) sets[i] = pipelines.set_layouts_[i].get();
  auto layout = make_pipeline_layout(host, functions, sets, sizeof(kernels::Range));
  if (!layout) return tl::unexpected<Error>(layout.error());
  pipelines.layout_ = std::move(*layout);
  return pipelines;
}

Result<void> Pipelines::add(KernelId kernel, const BlockFormat& format) {
  if (pipelines_.contains({kernel, format})) return {};
  std::array<std::uint32_t, 6> constants{};
  constants[kernels::kCodecConstant] = static_cast<std::uint32_t>(format.codec);
  constants[kernels::kFetchConstant] = static_cast<std::uint32_t>(format.fetch);
  constants[kernels::kTileRowsConstant] = format.tile_rows;
  const bool half_senders = constants_.sender_scale > 0.0f;
  constants[kernels::kHalfSendersConstant] = half_senders ? 1 : 0;
  constants[kernels::kSenderScaleConstant] =
      std::bit_cast<std::uint32_t>(half_senders ? constants_.sender_scale : 1.0f);
  constants[kernels::kLightingsConstant] = constants_.lightings;
  auto pipeline = make_compute_pipeline(host_, functions_, layout_.get(), kernel, constants);
  if (!pipeline) return tl::unexpected<Error>(pipeline.error());
  pipelines_.emplace(std::pair{kernel, format}, std::move(*pipeline));
  return {};
}

}  // namespace relume
