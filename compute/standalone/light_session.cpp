// SPDX-License-Identifier: MIT
#include "compute/standalone/light_session.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace relume {
namespace {

Result<std::vector<Rgb>> read_rgb(StandaloneDevice& device, const BufferRange& range, std::size_t count) {
  const auto floats = read_floats(device, range, 4 * count);
  if (!floats) return fail(floats.error());
  std::vector<Rgb> values;
  for (std::size_t i = 0; i < count; ++i)
    values.emplace_back((*floats)[4 * i], (*floats)[4 * i + 1], (*floats)[4 * i + 2]);
  return values;
}

Result<void> add_rgb(const Result<std::vector<Rgb>>& values, std::vector<Rgb>& sum) {
  if (!values) return fail(values.error());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += (*values)[i];
  return {};
}

/// How many of them, from the first, stay below the limits; at least one.
std::size_t lights_that_fit(const LightSchedule& schedule, std::span<const Light> lights) {
  std::uint64_t pairs = 0;
  std::size_t count = 0;
  while (count < lights.size() && count < schedule.max_lights()) {
    pairs += schedule.pairs_of(lights[count]);
    if (count > 0 && pairs > schedule.max_pairs()) break;
    ++count;
  }
  return count;
}

/// Loaded systems one after another, as many together as have `max_elements`, but at least one.
std::vector<std::vector<std::uint32_t>> system_groups(const Model& model, std::size_t max_elements) {
  std::vector<std::vector<std::uint32_t>> groups;
  std::size_t elements = 0;
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    if (!system.loaded) continue;
    elements += system.elements.size();
    if (groups.empty() || elements > max_elements) {
      groups.emplace_back();
      elements = system.elements.size();
    }
    groups.back().push_back(s);
  }
  return groups;
}

DeviceDirectLight unlit(const Model& model, const std::vector<std::uint32_t>& systems) {
  DeviceDirectLight zero;
  for (const std::uint32_t s : systems) {
    const System& system = model.systems[s];
    zero.clusters.resize(zero.clusters.size() + system.clusters.size(), Rgb(0.0));
    zero.gather.resize(zero.gather.size() + system.lumels.size() + system.sensors.size(), Rgb(0.0));
  }
  return zero;
}

/// Adds what the lights give these systems to `sum`.
Result<void> light_group(StandaloneDevice& device, const Model& model,
                         const std::vector<std::uint32_t>& systems, std::span<const Light> lights,
                         DeviceDirectLight& sum) {
  if (lights.empty()) return {};
  LightSessionOptions options;
  options.light.systems = systems;
  auto session = LightSession::create(device, model, options);
  if (!session) return fail(session.error());
  while (!lights.empty()) {
    const std::size_t batch = lights_that_fit(session->schedule(), lights);
    if (auto lit = session->set_lights(lights.first(batch)); !lit) return fail(lit.error());
    if (auto added = add_rgb(session->read_clusters(), sum.clusters); !added) return added;
    if (auto added = add_rgb(session->read_gather(), sum.gather); !added) return added;
    lights = lights.subspan(batch);
  }
  return {};
}

}  // namespace

Result<LightSession> LightSession::create(StandaloneDevice& device, const Model& model,
                                          const LightSessionOptions& options) {
  auto light = DirectLight::create(device.host(), model, options.light);
  if (!light) return fail(light.error());
  LightSession session(device, options, std::move(*light));
  if (auto provided = session.provide_memory(model); !provided) return fail(provided.error());
  return session;
}

Result<void> LightSession::provide_memory(const Model& model) {
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& requirement : light_.buffers()) {
    auto range = arena_.allocate(requirement);
    if (!range) return fail(range.error());
    ranges.push_back(*range);
  }
  if (auto bound = light_.bind(ranges); !bound) return bound;
  if (auto staging = grow_staging(options_.staging_bytes); !staging) return staging;
  if (auto uploaded = upload(light_.model_data(model)); !uploaded) return fail(uploaded.error());
  return {};
}

Result<void> LightSession::grow_staging(VkDeviceSize bytes) {
  if (staging_.byte_size >= bytes) return {};
  auto staging = make_device_buffer(*device_, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  if (!staging) return fail(staging.error());
  staging_ = std::move(*staging);
  return {};
}

Result<SubmitTimes> LightSession::upload(const UploadData& data) {
  SubmitTimes sum;
  UploadCursor cursor;
  for (bool done = false; !done;) {
    const auto times = device_->submit(
        [&](VkCommandBuffer commands) {
          done = light_.record_upload(commands, data, {staging_.range(), staging_.mapped}, cursor);
        },
        options_.timeout_seconds);
    if (!times) return times;
    sum += *times;
  }
  return sum;
}

Result<LightTimes> LightSession::set_lights(std::span<const Light> lights) {
  if (auto set = schedule_.set_lights(lights); !set) return fail(set.error());
  if (auto grown = grow_staging(light_.staging_bytes(lights.size())); !grown) return fail(grown.error());
  LightTimes done;
  while (!schedule_.complete()) {
    LightPart part;
    const auto times = device_->submit(
        [&](VkCommandBuffer commands) {
          part = light_.record(commands, schedule_, {staging_.range(), staging_.mapped},
                               options_.max_submit_rays);
        },
        options_.timeout_seconds);
    if (!times) return fail(times.error());
    done.sum += *times;
    done.rays += part.cost;
    done.longest_gpu_seconds = std::max(done.longest_gpu_seconds, times->gpu_seconds);
  }
  return done;
}

Result<void> LightSession::write_mask(std::span<const float> visibility) {
  UploadData data;
  const std::span bytes = std::as_bytes(visibility);
  data.add_owned(kLightMask, 0, {bytes.begin(), bytes.end()});
  if (auto uploaded = upload(data); !uploaded) return fail(uploaded.error());
  return {};
}

Result<std::vector<Rgb>> LightSession::read_clusters() {
  return read_rgb(*device_, light_.cluster_light(), light_.cluster_count());
}

Result<std::vector<Rgb>> LightSession::read_gather() {
  return read_rgb(*device_, light_.gather_light(), light_.gather_row_count());
}

Result<std::vector<float>> LightSession::trace(std::span<const LightSegment> segments, SubmitTimes* times) {
  std::vector<float> shares;
  if (times != nullptr) *times = {};
  for (std::size_t first = 0; first < segments.size(); first += light_.max_shadow_rays()) {
    const auto count = std::min<std::size_t>(light_.max_shadow_rays(), segments.size() - first);
    std::vector<std::array<float, 8>> rays;
    for (const auto& [from, to] : segments.subspan(first, count))
      rays.push_back({from.x, from.y, from.z, 0.0f, to.x, to.y, to.z, 0.0f});
    UploadData data;
    const std::span bytes = std::as_bytes(std::span(rays));
    data.add_owned(kLightWork, 0, {bytes.begin(), bytes.end()});
    if (auto uploaded = upload(data); !uploaded) return fail(uploaded.error());
    const auto traced = device_->submit(
        [&](VkCommandBuffer commands) {
          light_.record_shadow_rays(commands, static_cast<std::uint32_t>(count));
        },
        options_.timeout_seconds);
    if (!traced) return fail(traced.error());
    if (times != nullptr) *times += *traced;
    const auto read = read_floats(*device_, light_.buffer(kLightShares), count);
    if (!read) return fail(read.error());
    shares.insert(shares.end(), read->begin(), read->end());
  }
  retrace();
  return shares;
}

Result<DeviceDirectLight> direct_light_on_device(StandaloneDevice& device, const Model& model,
                                                 std::span<const Light> lights, const DirectLightRun& run) {
  DeviceDirectLight all;
  for (const std::vector<std::uint32_t>& systems : system_groups(model, run.max_elements)) {
    DeviceDirectLight sum = unlit(model, systems);
    if (auto lit = light_group(device, model, systems, lights, sum); !lit) return fail(lit.error());
    all.clusters.insert(all.clusters.end(), sum.clusters.begin(), sum.clusters.end());
    all.gather.insert(all.gather.end(), sum.gather.begin(), sum.gather.end());
  }
  return all;
}

}  // namespace relume
