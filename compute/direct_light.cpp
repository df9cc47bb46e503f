// SPDX-License-Identifier: MIT
#include "compute/direct_light.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "compute/device_functions.h"
#include "compute/direct_light_data.h"
#include "compute/direct_light_options.h"
#include "compute/guest.h"
#include "compute/kernel_set.h"
#include "compute/pass_buffers.h"
#include "compute/pass_plan.h"
#include "compute/record_upload.h"
#include "compute/recording.h"
#include "core/light_patches.h"
#include "core/ray_offset.h"
#include "kernels/shared/bindings.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

static_assert(static_cast<kernels::uint>(LightType::point) == kernels::kLightPoint);
static_assert(static_cast<kernels::uint>(LightType::spot) == kernels::kLightSpot);
static_assert(static_cast<kernels::uint>(LightType::directional) == kernels::kLightDirectional);
static_assert(kMaxPatchRows * kMaxPatchRows <= 16, "the number in the piece has 4 bits");

constexpr VkDeviceSize kLeastBytes = 256;
constexpr VkDeviceSize kWorkBytes = VkDeviceSize{4} << 20;
constexpr std::uint32_t kLeastPairs = 262144;
constexpr std::uint32_t kLightsThatReachAll = 64;
constexpr VkDeviceSize kSlotBytes = kernels::kBlockElements * sizeof(float);

enum Kernel : std::uint32_t { kTrace, kSum, kClusters, kGather, kRays };

constexpr std::array<const char*, kDirectLightBuffers> kNames = {
    "occluder tree",  "occluder triangles", "occluder opacity", "light pieces",    "light patches",
    "light elements", "light tables",       "light records",    "light work",      "light shares",
    "element light",  "cluster light",      "gather light",     "light visibility"};

template <class T>
void add_piece(UploadData& data, std::uint32_t buffer, const std::vector<T>& values) {
  if (!values.empty()) data.add_owned(buffer, 0, owned_bytes(values));
}

template <class T>
void append(std::vector<std::byte>& bytes, const T& value) {
  const auto more = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace

struct DirectLightState {
  HostDevice host;
  DeviceFunctions functions;
  DirectLightOptions options;
  std::vector<std::uint32_t> systems;
  glm::dvec3 origin{0.0};
  kernels::DirectLightRange range{};  ///< as far as all dispatches share it
  std::shared_ptr<const std::vector<LightBlock>> blocks;
  std::uint32_t gather_rows = 0;
  std::vector<BufferRequirement> buffers;
  KernelSet kernels;
  std::vector<BufferRange> ranges;  ///< empty until bound
  VkDescriptorSet set = VK_NULL_HANDLE;

  void dispatch(VkCommandBuffer commands, Kernel kernel, const kernels::DirectLightRange& constants,
                std::uint32_t workgroups) const {
    kernels.record(commands, kernel, set, std::as_bytes(std::span(&constants, 1)), workgroups);
  }
};

namespace {

std::uint32_t pair_limit(const DirectLightOptions& options, std::size_t blocks, VkDeviceSize max_range) {
  const std::uint64_t wanted =
      options.max_pairs > 0
          ? options.max_pairs
          : std::max<std::uint64_t>(kLeastPairs, std::uint64_t{kLightsThatReachAll} * blocks);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, max_range / kSlotBytes));
}

/// Byte sizes by DirectLightBuffer.
std::array<VkDeviceSize, kDirectLightBuffers> byte_sizes(const Model& model, const LightSurfaces& surfaces,
                                                         const LightTables& tables,
                                                         const DirectLightOptions& options) {
  const Occluders& occluders = model.occluders;
  const VkDeviceSize clusters = surfaces.clusters.size() / 2;
  const bool masked = options.visibility == LightVisibility::mask;
  return {occluders.bvh.nodes.size() * sizeof(BvhNode),
          occluders.bvh.triangles.size() * 3 * sizeof(kernels::uvec4),
          opacity_words(occluders.opacity).size() * 4,
          surfaces.pieces.size() * sizeof(kernels::LightPiece),
          surfaces.patches.size() * 4,
          surfaces.elements.size() * sizeof(kernels::LightElement),
          tables.words.size() * 4,
          options.max_lights * sizeof(kernels::LightRecord),
          std::max<VkDeviceSize>(kWorkBytes, options.max_lights * VkDeviceSize{32}),
          options.max_pairs * kSlotBytes,
          surfaces.elements.size() * sizeof(kernels::vec4),
          clusters * sizeof(kernels::vec4),
          surfaces.gather_rows.size() * sizeof(kernels::vec4),
          masked ? options.max_lights * clusters * sizeof(float) : 0};
}

Result<std::vector<BufferRequirement>> requirements(
    const std::array<VkDeviceSize, kDirectLightBuffers>& sizes, const VkPhysicalDeviceLimits& limits) {
  const VkDeviceSize alignment =
      std::max(limits.minStorageBufferOffsetAlignment, limits.minTexelBufferOffsetAlignment);
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                        VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  std::vector<BufferRequirement> needed;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i] > limits.maxStorageBufferRange) {
      return fail(ErrorCode::no_device, std::string("the buffer '") + kNames[i] + "' of direct light needs " +
                                            std::to_string(sizes[i]) +
                                            " bytes, but the device binds at most " +
                                            std::to_string(limits.maxStorageBufferRange));
    }
    needed.push_back({kNames[i], std::max(sizes[i], kLeastBytes), alignment, kUsage});
  }
  return needed;
}

/// Metres about the origin: how far off surfaces rays start, and how far away directional lights are.
void set_lengths(const Occluders& occluders, kernels::DirectLightRange& range) {
  range.offset = ray_offset(occluders.positions);
  if (occluders.triangles.empty()) return;
  glm::vec3 lower = occluders.positions[occluders.triangles[0][0]], upper = lower;
  for (const auto& triangle : occluders.triangles) {
    for (const std::uint32_t corner : triangle) {
      lower = glm::min(lower, occluders.positions[corner]);
      upper = glm::max(upper, occluders.positions[corner]);
    }
  }
  range.far = 2.0f * glm::length(upper - lower);
}

Result<KernelSet> make_kernels(const HostDevice& host, const DeviceFunctions& functions, MatrixFetch fetch) {
  const auto constant = static_cast<std::uint32_t>(fetch);
  return KernelSet::create(host, functions,
                           {{kernels::kDirectLightBindings, kernels::kDirectLightTexelBindings, 0},
                            sizeof(kernels::DirectLightRange),
                            {{KernelId::direct_trace, {constant}},
                             {KernelId::direct_sum},
                             {KernelId::direct_clusters},
                             {KernelId::direct_gather},
                             {KernelId::shadow_rays, {constant}}},
                            1});
}

/// The work as it lies in the work buffer; `range` gets to know where its parts begin.
std::vector<std::byte> work_bytes(const LightWork& work, bool masked, kernels::DirectLightRange& range) {
  std::vector<std::byte> bytes;
  for (const LightWork::Trace& trace : work.traces)
    append(bytes, kernels::TraceJob{trace.block, trace.light, trace.slot, masked ? kernels::kJobMask : 0});
  range.sum_jobs = static_cast<std::uint32_t>(bytes.size() / 4);
  for (const LightWork::Sum& sum : work.sums)
    append(bytes, kernels::SumJob{sum.block, sum.first_pair, sum.pair_count, 0});
  range.pairs = static_cast<std::uint32_t>(bytes.size() / 4);
  for (const auto& [slot, light] : work.pairs) append(bytes, std::array<std::uint32_t, 2>{slot, light});
  return bytes;
}

void record_traces(const DirectLightState& state, VkCommandBuffer commands, const LightWork& work,
                   kernels::DirectLightRange range) {
  std::size_t first = 0;
  while (first < work.traces.size()) {
    std::size_t end = first;
    std::uint64_t rays = 0;
    while (end < work.traces.size() && end - first < kernels::kMaxWorkgroups &&
           (end == first || rays + work.traces[end].rays <= state.options.max_dispatch_rays))
      rays += work.traces[end++].rays;
    range.first = static_cast<std::uint32_t>(first);
    range.count = static_cast<std::uint32_t>(end - first);
    state.dispatch(commands, kTrace, range, range.count);
    first = end;
  }
}

void record_sums(const DirectLightState& state, VkCommandBuffer commands, const LightWork& work,
                 kernels::DirectLightRange range) {
  constexpr std::uint32_t kBlocksPerWorkgroup = kernels::kWorkgroupSize / kernels::kBlockElements;
  constexpr std::uint32_t kMost = kBlocksPerWorkgroup * kernels::kMaxWorkgroups;
  const auto sums = static_cast<std::uint32_t>(work.sums.size());
  for (range.first = 0; range.first < sums; range.first += kMost) {
    range.count = std::min(kMost, sums - range.first);
    state.dispatch(commands, kSum, range, (range.count + kBlocksPerWorkgroup - 1) / kBlocksPerWorkgroup);
  }
}

void record_results(const DirectLightState& state, VkCommandBuffer commands, const LightWork& work,
                    kernels::DirectLightRange range) {
  if (work.end_cluster > work.first_cluster) {
    range.first = work.first_cluster;
    range.count = work.end_cluster - work.first_cluster;
    state.dispatch(commands, kClusters, range, workgroup_count(range.count));
  }
  if (state.gather_rows == 0) return;
  range.first = 0;
  range.count = state.gather_rows;
  state.dispatch(commands, kGather, range, workgroup_count(range.count));
}

}  // namespace

DirectLight::DirectLight(std::unique_ptr<DirectLightState> state) : state_(std::move(state)) {}
DirectLight::DirectLight(DirectLight&&) noexcept = default;
DirectLight& DirectLight::operator=(DirectLight&&) noexcept = default;
DirectLight::~DirectLight() = default;

Result<DirectLight> DirectLight::create(const HostDevice& host, const Model& model,
                                        const DirectLightOptions& asked) {
  if (auto checked = check_light_options(model, asked); !checked)
    return tl::unexpected<Error>(checked.error());
  const auto limits = device_limits(host);
  if (!limits) return tl::unexpected<Error>(limits.error());
  const std::vector<std::uint32_t> systems = chosen_systems(model, asked);
  const LightSurfaces surfaces = light_surfaces(model, systems, asked.patches_per_element);
  const LightTables tables = light_tables(surfaces);
  DirectLightOptions options = asked;
  options.max_pairs = pair_limit(options, surfaces.blocks.size(), limits->maxStorageBufferRange);
  auto buffers = requirements(byte_sizes(model, surfaces, tables, options), *limits);
  if (!buffers) return tl::unexpected<Error>(buffers.error());
  const VkDeviceSize texels =
      std::max((*buffers)[kLightTree].byte_size, (*buffers)[kLightTriangles].byte_size) /
      sizeof(kernels::uvec4);
  const bool texels_fit = texels <= limits->maxTexelBufferElements;
  if (options.fetch == MatrixFetch::texels && !texels_fit)
    return fail(ErrorCode::no_device, "the tree of occluders does not fit the texel buffers of the device");
  options.fetch = options.fetch.value_or(texels_fit ? MatrixFetch::texels : MatrixFetch::storage);
  auto functions = load_device_functions(host);
  if (!functions) return tl::unexpected<Error>(functions.error());
  auto kernels = make_kernels(host, *functions, *options.fetch);
  if (!kernels) return tl::unexpected<Error>(kernels.error());

  kernels::DirectLightRange range{};
  range.clusters = tables.clusters;
  range.gather_rows = tables.gather_rows;
  range.cluster_count = static_cast<std::uint32_t>(surfaces.clusters.size() / 2);
  set_lengths(model.occluders, range);
  const auto gather_rows = static_cast<std::uint32_t>(surfaces.gather_rows.size());
  return DirectLight(std::make_unique<DirectLightState>(
      DirectLightState{host,
                       *functions,
                       options,
                       systems,
                       model.origin,
                       range,
                       std::make_shared<const std::vector<LightBlock>>(surfaces.blocks),
                       gather_rows,
                       std::move(*buffers),
                       std::move(*kernels),
                       {},
                       VK_NULL_HANDLE}));
}

std::span<const BufferRequirement> DirectLight::buffers() const {
  return state_->buffers;
}

Result<void> DirectLight::bind(std::span<const BufferRange> ranges) {
  auto exact = fit_ranges(buffers(), ranges);
  if (!exact) return tl::unexpected<Error>(exact.error());
  // Where texels are not read, their views need not fit.
  const bool texels = state_->options.fetch == MatrixFetch::texels;
  const auto view = [&](DirectLightBuffer which) {
    TexelRange shown{(*exact)[which], VK_FORMAT_R32G32B32A32_UINT};
    if (!texels) shown.range.byte_size = kLeastBytes;
    return shown;
  };
  const std::array<TexelRange, kernels::kDirectLightTexelBindings> views = {view(kLightTree),
                                                                            view(kLightTriangles)};
  const auto set = state_->kernels.make_set(*exact, views);
  if (!set) return tl::unexpected<Error>(set.error());
  state_->set = *set;
  state_->ranges = std::move(*exact);
  return {};
}

UploadData DirectLight::model_data(const Model& model, bool occluders) const {
  UploadData data;
  if (occluders) {
    std::vector<BvhNode> nodes = model.occluders.bvh.nodes;
    if (nodes.empty()) nodes.emplace_back();
    add_piece(data, kLightTree, nodes);
    add_piece(data, kLightTriangles, leaf_triangles(model.occluders));
    add_piece(data, kLightOpacity, opacity_words(model.occluders.opacity));
  }
  const LightSurfaces surfaces = light_surfaces(model, state_->systems, state_->options.patches_per_element);
  add_piece(data, kLightPieces, surfaces.pieces);
  add_piece(data, kLightPatches, surfaces.patches);
  add_piece(data, kLightElements, surfaces.elements);
  add_piece(data, kLightTables, light_tables(surfaces).words);
  // Read before everything has been traced for the first time.
  add_piece(data, kElementLight, std::vector<kernels::vec4>(surfaces.elements.size()));
  add_piece(data, kClusterLight, std::vector<kernels::vec4>(surfaces.clusters.size() / 2));
  return data;
}

bool DirectLight::record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                                UploadCursor& cursor) const {
  return relume::record_upload(state_->functions, commands, state_->ranges, data, staging, cursor);
}

LightSchedule DirectLight::make_schedule() const {
  return LightSchedule(state_->blocks, state_->origin, state_->options.max_lights, state_->options.max_pairs);
}

VkDeviceSize DirectLight::staging_bytes(std::size_t lights) const {
  return lights * (sizeof(kernels::LightRecord) + 24) + 64;
}

LightPart DirectLight::record(VkCommandBuffer commands, LightSchedule& schedule, const Staging& staging,
                              std::uint64_t max_rays) const {
  const DirectLightState& state = *state_;
  const ScopedLabel label(state.functions, commands, "relume direct light");
  if (staging.range.byte_size < staging_bytes(schedule.lights().size())) return {schedule.complete(), 0};
  UploadData data;
  if (schedule.lights_changed) {
    std::vector<kernels::LightRecord> records;
    for (const Light& light : schedule.lights()) records.push_back(light_record(light));
    add_piece(data, kLightRecords, records);
    schedule.lights_changed = false;
  }
  VkDeviceSize room = staging.range.byte_size;
  for (const UploadPiece& piece : data.pieces) room -= std::min<VkDeviceSize>(room, piece.bytes.size());
  const VkDeviceSize work_room = std::min(room, state.buffers[kLightWork].byte_size);
  const LightWork work = schedule.take({max_rays, work_room / 4});
  if (work.sums.empty()) return {true, 0};

  kernels::DirectLightRange range = state.range;
  data.add_owned(kLightWork, 0, work_bytes(work, state.options.visibility == LightVisibility::mask, range));
  UploadCursor cursor;
  record_upload(commands, data, staging, cursor);
  record_traces(state, commands, work, range);
  record_barrier(state.functions, commands, kComputeAndTransfer, kComputeAndTransfer);
  record_sums(state, commands, work, range);
  record_barrier(state.functions, commands, kComputeAndTransfer, kComputeAndTransfer);
  record_results(state, commands, work, range);
  record_barrier(state.functions, commands, kComputeAndTransfer, kComputeAndTransfer);
  return {schedule.complete(), work.rays};
}

void DirectLight::record_shadow_rays(VkCommandBuffer commands, std::uint32_t count) const {
  const auto slice =
      static_cast<std::uint32_t>(std::clamp<std::uint64_t>(state_->options.max_dispatch_rays, 1, 1u << 20));
  record_barrier(state_->functions, commands, kComputeAndTransfer, kComputeAndTransfer);
  kernels::DirectLightRange range = state_->range;
  for (range.first = 0; range.first < count; range.first += range.count) {
    range.count = std::min(slice, count - range.first);
    state_->dispatch(commands, kRays, range,
                     (range.count + kernels::kWorkgroupSize - 1) / kernels::kWorkgroupSize);
  }
  record_barrier(state_->functions, commands, kComputeAndTransfer, kComputeAndTransfer);
}

std::uint32_t DirectLight::max_shadow_rays() const {
  constexpr VkDeviceSize kRayBytes = 8 * sizeof(float);
  return static_cast<std::uint32_t>(std::min(state_->buffers[kLightWork].byte_size / kRayBytes,
                                             state_->buffers[kLightShares].byte_size / sizeof(float)));
}

BufferRange DirectLight::buffer(DirectLightBuffer which) const {
  return state_->ranges[which];
}

std::uint32_t DirectLight::cluster_count() const {
  return state_->range.cluster_count;
}

std::uint32_t DirectLight::gather_row_count() const {
  return state_->gather_rows;
}

}  // namespace relume
