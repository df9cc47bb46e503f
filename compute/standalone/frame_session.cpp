// SPDX-License-Identifier: MIT
#include "compute/standalone/frame_session.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <numeric>
#include <utility>

#include "compute/record_upload.h"
#include "compute/standalone/staging_parts.h"

namespace relume {
namespace {

constexpr VkDeviceSize kUploadBytes = VkDeviceSize{16} << 20;
constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                      VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
constexpr VkDeviceSize kTracePairBytes = 64;  ///< of the work of a light and a block, and more

enum Moment : std::uint32_t { kBegin, kInputs, kDirectLight, kBounces, kGather, kLightmaps, kMoments };

struct Lightmap {
  LightmapPass pass;
  DeviceImage image;
  VulkanHandle<VkImageView> view;
};

/// The passes of one system.
struct SystemPasses {
  std::uint32_t system;
  DirectLight light;
  LightSchedule schedule;
  MaterialPass materials;
  BufferRange states;
  std::optional<Lightmap> lightmap;
};

std::vector<float> four_floats(std::span<const Rgb> values) {
  std::vector<float> floats;
  for (const Rgb& v : values)
    floats.insert(floats.end(),
                  {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f});
  return floats;
}

}  // namespace

/// Members go in reverse order: passes and the solver before the memory that they are bound to.
struct FrameSession::State {
  StandaloneDevice* device;
  FrameSessionOptions options;
  DeviceFunctions functions;
  std::vector<std::uint32_t> first_cluster;
  std::uint32_t materials;
  Timestamps moments;
  DeviceArena arena;
  DeviceBuffer staging;
  GpuSolver solver;
  Schedule schedule;
  std::vector<BufferRange> occluders;  ///< the buffers that direct light of all systems shares
  std::vector<SystemPasses> passes;
  bool started = false;

  Result<BufferRange> allocate(BufferRequirement requirement) {
    requirement.usage = kUsage;
    return arena.allocate(requirement);
  }
  Result<std::vector<BufferRange>> allocate(std::span<const BufferRequirement> needed);
  Result<void> grow_staging(VkDeviceSize byte_size);
  Result<void> upload(std::span<const BufferRange> ranges, const UploadData& data);
  Result<void> load(const Model& model);
  Result<void> add_passes(const Model& model, std::uint32_t system);
  Result<DirectLight> make_light(const Model& model, std::uint32_t system);
  Result<std::optional<Lightmap>> make_lightmap(const System& system, std::uint32_t number,
                                                const DirectLight& light);
  VkDeviceSize light_bytes(const SystemPasses& of) const;
  VkDeviceSize frame_bytes(const FrameContent& content) const;
  void record_states(VkCommandBuffer commands, StagingParts& staging, const FrameContent& content) const;
  Result<Schedule> record(VkCommandBuffer commands, const FrameContent& content, FrameTimes& times);
  Result<std::vector<Rgb>> read(
      const std::function<std::pair<BufferRange, std::size_t>(const SystemPasses&)>& where);
};

Result<std::vector<BufferRange>> FrameSession::State::allocate(std::span<const BufferRequirement> needed) {
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : needed) {
    auto range = allocate(buffer);
    if (!range) return fail(range.error());
    ranges.push_back(*range);
  }
  return ranges;
}

Result<void> FrameSession::State::grow_staging(VkDeviceSize byte_size) {
  if (staging.byte_size >= byte_size) return {};
  auto made = make_device_buffer(*device, byte_size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  if (!made) return fail(made.error());
  staging = std::move(*made);
  return {};
}

Result<void> FrameSession::State::upload(std::span<const BufferRange> ranges, const UploadData& data) {
  UploadCursor cursor;
  for (bool done = false; !done;) {
    const auto submitted = device->submit([&](VkCommandBuffer commands) {
      const std::span<const BufferRange> targets = ranges.empty() ? data.targets : ranges;
      done = record_upload(functions, commands, targets, data, {staging.range(), staging.mapped}, cursor);
    });
    if (!submitted) return fail(submitted.error());
  }
  return {};
}

Result<void> FrameSession::State::load(const Model& model) {
  const auto allocator = [this](const BufferRequirement& requirement) { return allocate(requirement); };
  if (auto bound = solver.bind(allocator); !bound) return bound;
  if (auto grown = grow_staging(kUploadBytes); !grown) return grown;
  UploadData data = solver.model_data(model);
  for (std::uint32_t system = 0; system < model.systems.size(); ++system) {
    if (!model.systems[system].loaded) continue;
    if (auto loaded = solver.load(model, system, allocator); !loaded) return loaded;
    data.append(solver.system_data(model, system));
    activate(solver.traits(), schedule, system);
  }
  if (auto uploaded = upload({}, data); !uploaded) return uploaded;
  for (std::uint32_t system = 0; system < model.systems.size(); ++system) {
    if (!model.systems[system].loaded) continue;
    if (auto added = add_passes(model, system); !added) return added;
  }
  return {};
}

Result<DirectLight> FrameSession::State::make_light(const Model& model, std::uint32_t system) {
  DirectLightOptions asked;
  asked.systems = {system};
  asked.max_pairs = options.max_pairs;
  asked.patches_per_element = options.patches_per_element;
  auto light = DirectLight::create(device->host(), model, asked);
  if (!light) return light;
  const bool first = occluders.empty();
  std::vector<BufferRange> ranges = occluders;
  for (const BufferRequirement& buffer : light->buffers().subspan(occluders.size())) {
    auto range = allocate(buffer);
    if (!range) return fail(range.error());
    ranges.push_back(*range);
  }
  if (first) occluders.assign(ranges.begin(), ranges.begin() + kLightPieces);
  ranges[kClusterLight] = solver.input(system, Quantity::direct);
  if (auto bound = light->bind(ranges); !bound) return fail(bound.error());
  if (auto uploaded = upload(ranges, light->model_data(model, first)); !uploaded)
    return fail(uploaded.error());
  return light;
}

Result<std::optional<Lightmap>> FrameSession::State::make_lightmap(const System& system, std::uint32_t number,
                                                                   const DirectLight& light) {
  const LightmapTexels texels = lightmap_texels(system);
  if (texels.texels.empty()) return std::optional<Lightmap>{};
  auto pass = LightmapPass::create(device->host(), system, texels, options.lightmaps);
  if (!pass) return fail(pass.error());
  const auto ranges = allocate(pass->buffers());
  if (!ranges) return fail(ranges.error());
  if (auto uploaded = upload(*ranges, lightmap_data(texels)); !uploaded) return fail(uploaded.error());
  auto image = make_lightmap_target(*device, pass->image());
  if (!image) return fail(image.error());
  auto view = make_image_view(*device, *image, pass->image().storage_view_format, VK_IMAGE_USAGE_STORAGE_BIT);
  if (!view) return fail(view.error());
  const LightmapInputs inputs{solver.irradiance(number), light.gather_light()};
  if (auto bound = pass->bind(*ranges, inputs, view->get()); !bound) return fail(bound.error());
  return Lightmap{std::move(*pass), std::move(*image), std::move(*view)};
}

Result<void> FrameSession::State::add_passes(const Model& model, std::uint32_t system) {
  auto light = make_light(model, system);
  if (!light) return fail(light.error());
  auto pass = MaterialPass::create(device->host(), model, system, options.materials);
  if (!pass) return fail(pass.error());
  const auto ranges = allocate(pass->buffers());
  if (!ranges) return fail(ranges.error());
  const auto bound =
      pass->bind(*ranges, {solver.input(system, Quantity::albedo), solver.input(system, Quantity::exitance)});
  if (!bound) return bound;
  if (auto uploaded = upload(*ranges, material_data(model, system, options.materials.states)); !uploaded)
    return uploaded;
  auto lightmap = make_lightmap(model.systems[system], system, *light);
  if (!lightmap) return fail(lightmap.error());
  LightSchedule traced = light->make_schedule();
  passes.push_back(
      {system, std::move(*light), std::move(traced), std::move(*pass), (*ranges)[1], std::move(*lightmap)});
  return {};
}

VkDeviceSize FrameSession::State::light_bytes(const SystemPasses& of) const {
  return of.light.staging_bytes(of.schedule.lights().size()) +
         kTracePairBytes *
             (of.schedule.pair_count() + of.light.gather_row_count() + of.light.cluster_count());
}

VkDeviceSize FrameSession::State::frame_bytes(const FrameContent& content) const {
  VkDeviceSize bytes =
      content.materials.size_bytes() + kRgbBytes * content.sky.size() + 4 * StagingParts::kAlignment;
  for (const SystemPasses& of : passes) bytes += light_bytes(of) + 2 * StagingParts::kAlignment;
  return bytes;
}

void FrameSession::State::record_states(VkCommandBuffer commands, StagingParts& staging_parts,
                                        const FrameContent& content) const {
  if (content.materials.empty()) return;
  const BufferRange source = staging_parts.copy_of(std::as_bytes(content.materials));
  for (const SystemPasses& of : passes) {
    const bool per_cluster = options.materials.states == StatePer::cluster;
    const std::size_t first = per_cluster ? first_cluster[of.system] : 0;
    const std::size_t end = per_cluster ? first_cluster[of.system + 1] : materials;
    constexpr VkDeviceSize kBytes = sizeof(kernels::MaterialState);
    const VkBufferCopy copy{source.offset + first * kBytes, of.states.offset, (end - first) * kBytes};
    vkCmdCopyBuffer(commands, source.buffer, of.states.buffer, 1, &copy);
  }
}

/// Gather and lightmaps are recorded apart from the bounces, so that a timestamp fits between them.
Result<Schedule> FrameSession::State::record(VkCommandBuffer commands, const FrameContent& content,
                                             FrameTimes& times) {
  StagingParts parts(staging);
  const FramePlan bounces =
      solver.plan(schedule, PassWishes{.restart = !started, .bounces = content.bounces});
  const FramePlan gather = solver.plan(bounces.next, PassWishes{.gather = true});
  moments.record_reset(commands);
  moments.record_mark(commands, kBegin);
  record_states(commands, parts, content);
  std::vector<const MaterialPass*> changed;
  for (const SystemPasses& of : passes) {
    if (!content.materials.empty()) changed.push_back(&of.materials);
  }
  std::vector<InputCopy> copies;
  if (!content.sky.empty()) {
    const std::vector<float> sky = four_floats(content.sky);
    const auto systems = static_cast<std::uint32_t>(first_cluster.size() - 1);
    copies.push_back({Quantity::sky, systems, 0, parts.copy_of(std::as_bytes(std::span(sky)))});
  }
  std::size_t next = 0;
  const auto write_inputs = [&](VkCommandBuffer into, std::uint32_t) {
    if (next == 0) moments.record_mark(into, kInputs);
    SystemPasses& of = passes[next++];
    times.shadow_rays +=
        of.light.record(into, of.schedule, parts.take(light_bytes(of)), ~std::uint64_t{0}).cost;
    if (next == passes.size()) moments.record_mark(into, kDirectLight);
  };
  const auto first = solver.record_frame(
      commands, {.plan = &bounces, .copies = copies, .materials = changed, .write_inputs = write_inputs}, {});
  if (!first) return fail(first.error());
  moments.record_mark(commands, kBounces);
  if (auto second = solver.record_frame(commands, {.plan = &gather}, {}); !second)
    return fail(second.error());
  moments.record_mark(commands, kGather);
  for (const SystemPasses& of : passes) {
    if (of.lightmap) of.lightmap->pass.record(commands);
  }
  moments.record_mark(commands, kLightmaps);
  return gather.next;
}

FrameSession::FrameSession(std::unique_ptr<State> state) : state_(std::move(state)) {}
FrameSession::FrameSession(FrameSession&&) noexcept = default;
FrameSession& FrameSession::operator=(FrameSession&&) noexcept = default;
FrameSession::~FrameSession() = default;

Result<FrameSession> FrameSession::create(StandaloneDevice& device, const Model& model,
                                          const FrameSessionOptions& options) {
  const HostDevice host = device.host();
  auto solver = GpuSolver::create(host, model, options.solver);
  if (!solver) return fail(solver.error());
  auto functions = load_device_functions(host);
  if (!functions) return fail(functions.error());
  auto moments = Timestamps::create(host.physical_device, host.device, device.queue_family(), kMoments);
  if (!moments) return fail(moments.error());
  auto state = std::make_unique<State>(State{&device,
                                             options,
                                             *functions,
                                             cluster_offsets(model),
                                             static_cast<std::uint32_t>(model.materials.size()),
                                             std::move(*moments),
                                             DeviceArena(device),
                                             {},
                                             std::move(*solver),
                                             make_schedule(model.systems.size(), 0.0),
                                             {},
                                             {}});
  if (auto loaded = state->load(model); !loaded) return fail(loaded.error());
  return FrameSession(std::move(state));
}

Result<FrameTimes> FrameSession::frame(const FrameContent& content) {
  State& state = *state_;
  FrameTimes times;
  const auto start = std::chrono::steady_clock::now();
  const std::size_t states =
      state.options.materials.states == StatePer::cluster ? state.first_cluster.back() : state.materials;
  if (!content.materials.empty() && content.materials.size() != states) {
    return fail(ErrorCode::usage, "a frame has states of " + std::to_string(content.materials.size()) +
                                      " materials or clusters, expected " + std::to_string(states));
  }
  for (SystemPasses& of : state.passes) {
    if (auto set = of.schedule.set_lights(content.lights); !set) return fail(set.error());
  }
  if (auto grown = state.grow_staging(state.frame_bytes(content)); !grown) return fail(grown.error());
  Result<Schedule> next;
  const auto submitted =
      state.device->submit([&](VkCommandBuffer commands) { next = state.record(commands, content, times); });
  if (!submitted) return fail(submitted.error());
  if (!next) return fail(next.error());
  state.schedule = std::move(*next);
  state.started = true;
  times.host = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto moments = state.moments.seconds();
  if (!moments) return fail(moments.error());
  const std::vector<double>& seconds = *moments;
  times.inputs = seconds[kBegin];
  times.direct_light = seconds[kInputs];
  times.bounces = seconds[kDirectLight];
  times.gather = seconds[kBounces];
  times.lightmaps = seconds[kGather];
  return times;
}

const GpuSolver& FrameSession::solver() const {
  return state_->solver;
}

std::uint64_t FrameSession::entries() const {
  std::uint64_t cost = 0;
  for (const SystemTraits& traits : state_->solver.traits()) {
    for (const StepKernel kernel : {StepKernel::bounce, StepKernel::gather}) {
      const std::vector<std::uint64_t>& costs = traits.costs[static_cast<std::size_t>(kernel)];
      cost = std::accumulate(costs.begin(), costs.end(), cost);
    }
  }
  return cost;
}

Result<std::vector<Rgb>> FrameSession::State::read(
    const std::function<std::pair<BufferRange, std::size_t>(const SystemPasses&)>& where) {
  std::vector<Rgb> values;
  for (const SystemPasses& of : passes) {
    const auto [range, count] = where(of);
    const auto floats = read_floats(*device, range, 4 * count);
    if (!floats) return fail(floats.error());
    for (std::size_t i = 0; i < floats->size(); i += 4)
      values.emplace_back((*floats)[i], (*floats)[i + 1], (*floats)[i + 2]);
  }
  return values;
}

Result<std::vector<Rgb>> FrameSession::read_albedo() {
  return state_->read([this](const SystemPasses& of) {
    return std::pair(state_->solver.input(of.system, Quantity::albedo),
                     std::size_t{of.light.cluster_count()});
  });
}

Result<std::vector<Rgb>> FrameSession::read_direct() {
  return state_->read([](const SystemPasses& of) {
    return std::pair(of.light.cluster_light(), std::size_t{of.light.cluster_count()});
  });
}

Result<std::vector<Rgb>> FrameSession::read_radiosity() {
  return state_->read([this](const SystemPasses& of) {
    const std::uint32_t half = state_->schedule.systems[of.system].half;
    return std::pair(state_->solver.radiosity(of.system, half), std::size_t{of.light.cluster_count()});
  });
}

Result<std::vector<Rgb>> FrameSession::read_irradiance() {
  return state_->read([this](const SystemPasses& of) {
    return std::pair(state_->solver.irradiance(of.system), std::size_t{of.light.gather_row_count()});
  });
}

Result<std::vector<Rgb>> FrameSession::read_gather_direct() {
  return state_->read([](const SystemPasses& of) {
    return std::pair(of.light.gather_light(), std::size_t{of.light.gather_row_count()});
  });
}

Result<std::vector<std::byte>> FrameSession::read_lightmap(std::uint32_t system) {
  for (const SystemPasses& of : state_->passes) {
    if (of.system == system && of.lightmap)
      return read_image(*state_->device, of.lightmap->image, kImageWritten,
                        texel_bytes(state_->options.lightmaps));
  }
  return std::vector<std::byte>{};
}

}  // namespace relume
