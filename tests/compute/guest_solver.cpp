// SPDX-License-Identifier: MIT
#include "compute/guest_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "compute/near_reference.h"

namespace relume::test {
namespace {

/// So little that most pieces are cut.
constexpr VkDeviceSize kStagingBytes = 10000;
constexpr VkDeviceSize kHostBytes = VkDeviceSize{16} << 20;

double largest(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

}  // namespace

double largest_radiosity(const Lighting& lighting) {
  double albedo = 0.0, source = 0.0;
  for (std::size_t i = 0; i < lighting.albedo.size(); ++i) {
    albedo = std::max(albedo, largest(lighting.albedo[i]));
    source = std::max(source, largest(lighting.exitance[i] + lighting.albedo[i] * lighting.direct[i]));
  }
  for (const Rgb& sky : lighting.sky_radiosity) source = std::max(source, largest(sky));
  return source / (1.0 - albedo);
}

Guest::Guest(StandaloneDevice& device, const HostDevice& host, const Model& model, const Lighting& lighting,
             const SolverOptions& options, const std::vector<Rgb>& weights)
    : device_(device),
      model_(model),
      lighting_(lighting),
      schedule_(make_schedule(model.systems.size(), largest_radiosity(lighting))) {
  auto made = GpuSolver::create(host, model, options);
  EXPECT_TRUE(made) << made.error().message;
  solver_.emplace(std::move(*made));
  memory_ = std::make_unique<GuardedMemory>(device, kHostBytes, solver_->buffers()[0].usage);
  const auto bound =
      solver_->bind([this](const BufferRequirement& requirement) { return memory_->allocate(requirement); });
  EXPECT_TRUE(bound) << bound.error().message;
  upload(solver_->model_data(model));
  light_sky(lighting);
  for (std::uint32_t system = 0; system < model.systems.size(); ++system) {
    if (!model.systems[system].loaded) continue;
    load(model, system, lighting);
    light(model, system, lighting, weights);
  }
}

void Guest::load(const Model& model, std::uint32_t system, const Lighting& lighting) {
  const std::uint32_t first = cluster_offsets(model)[system], last = cluster_offsets(model)[system + 1];
  const auto albedo = std::span(lighting.albedo).subspan(first, last - first);
  const auto allocate = [&](const BufferRequirement& requirement) {
    auto range = memory_->allocate(requirement);
    if (range) ranges_[system].push_back(*range);
    return range;
  };
  const auto loaded = solver_->load(model, system, allocate, albedo);
  ASSERT_TRUE(loaded) << loaded.error().message;
  upload(solver_->system_data(model, system));
  activate(solver_->traits(), schedule_, system);
}

VkDeviceSize Guest::system_bytes(std::uint32_t system) const {
  VkDeviceSize bytes = 0;
  for (const BufferRange& range : ranges_.at(system)) bytes += range.byte_size;
  return bytes;
}

void Guest::light(const Model& model, std::uint32_t system, const Lighting& lighting,
                  const std::vector<Rgb>& weights) {
  const std::vector<std::uint32_t> offsets = cluster_offsets(model);
  const auto upload_part = [&](Quantity quantity, const std::vector<Rgb>& values) {
    const auto part = std::span(values).subspan(offsets[system], offsets[system + 1] - offsets[system]);
    upload(solver_->input_data(system, quantity, part));
  };
  upload_part(Quantity::albedo, lighting.albedo);
  upload_part(Quantity::exitance, lighting.exitance);
  upload_part(Quantity::direct, lighting.direct);
  if (!weights.empty()) upload_part(Quantity::weights, weights);
}

void Guest::light_sky(const Lighting& lighting) {
  const auto sky = static_cast<std::uint32_t>(model_.systems.size());
  upload(solver_->input_data(sky, Quantity::sky, lighting.sky_radiosity));
}

void Guest::unload(std::uint32_t system) {
  solver_->unload(system);
  for (const BufferRange& range : ranges_[system]) memory_->release(range);
  ranges_.erase(system);
}

void Guest::upload(const UploadData& data) {
  auto staging =
      make_device_buffer(device_, kStagingBytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  ASSERT_TRUE(staging) << staging.error().message;
  UploadCursor cursor;
  for (bool done = false; !done;) {
    const auto submitted = device_.submit([&](VkCommandBuffer commands) {
      done = solver_->record_upload(commands, data, {staging->range(), staging->mapped}, cursor);
    });
    ASSERT_TRUE(submitted) << submitted.error().message;
  }
}

void Guest::upload(const std::vector<BufferRange>& targets, UploadData data) {
  data.targets = targets;
  upload(data);
}

void Guest::together(const PassWishes& wishes) {
  for (bool complete = false; !complete;) {
    FramePlan plan = solver_->plan(schedule_, wishes);
    const auto submitted = device_.submit([&](VkCommandBuffer commands) {
      const auto recorded = solver_->record_frame(commands, {.plan = &plan}, {});
      ASSERT_TRUE(recorded) << recorded.error().message;
    });
    ASSERT_TRUE(submitted) << submitted.error().message;
    complete = plan.pass_complete;
    schedule_ = std::move(plan.next);
  }
}

FramePlan Guest::frame(const FrameWishes& wishes, const FrameOutputs& outputs) {
  FramePlan plan = solver_->plan(schedule_, wishes);
  const auto submitted = device_.submit([&](VkCommandBuffer commands) {
    const auto recorded = solver_->record_frame(commands, {.plan = &plan}, outputs);
    EXPECT_TRUE(recorded) << recorded.error().message;
  });
  EXPECT_TRUE(submitted) << submitted.error().message;
  schedule_ = plan.next;
  return plan;
}

std::vector<Rgb> Guest::radiosity(bool latest) const {
  std::vector<Rgb> all;
  for (std::uint32_t s = 0; s < schedule_.systems.size(); ++s) {
    if (!solver_->loaded(s)) continue;
    const std::uint32_t half = schedule_.systems[s].half;
    const std::vector<Rgb> part = memory_->read_rgb(solver_->radiosity(s, latest ? half : 1 - half));
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::vector<Rgb> Guest::radiosity(std::uint32_t system) const {
  return memory_->read_rgb(solver_->radiosity(system, schedule_.systems[system].half));
}

std::vector<Rgb> Guest::irradiance(std::uint32_t system) const {
  return memory_->read_rgb(solver_->irradiance(system));
}

std::vector<Rgb> Guest::irradiance() const {
  std::vector<Rgb> all;
  for (std::uint32_t s = 0; s < schedule_.systems.size(); ++s) {
    if (!solver_->loaded(s)) continue;
    const std::vector<Rgb> part = irradiance(s);
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::vector<IrradianceMoments> Guest::moments() const {
  std::vector<IrradianceMoments> all;
  for (std::uint32_t s = 0; s < schedule_.systems.size(); ++s) {
    if (!solver_->loaded(s) || solver_->directional_irradiance(s).byte_size == 0) continue;
    const std::vector<Rgb> values = memory_->read_rgb(solver_->directional_irradiance(s));
    for (std::size_t i = 0; i < values.size(); i += 3)
      all.push_back({values[i], values[i + 1], values[i + 2]});
  }
  return all;
}

std::vector<ProbeCoefficients> Guest::probes() const {
  std::vector<ProbeCoefficients> all;
  if (model_.probe_names.empty()) return all;
  const std::vector<Rgb> values = memory_->read_rgb(solver_->probe_coefficients());
  for (auto at = values.begin(); at != values.end(); at += kProbeHarmonics)
    std::copy_n(at, kProbeHarmonics, all.emplace_back().begin());
  return all;
}

DeviceSolution Guest::results(std::uint32_t bounces) const {
  DeviceSolution out;
  out.solution.bounces = bounces;
  out.solution.radiosity = radiosity();
  out.irradiance = irradiance();
  out.moments = moments();
  out.probes = probes();
  return out;
}

testing::AssertionResult Guest::correct(std::uint32_t bounces) const {
  if (const std::size_t damaged = memory_->damaged_bytes(); damaged > 0) {
    return testing::AssertionFailure() << damaged << " bytes outside of the buffers were written";
  }
  return agrees_with_reference(results(bounces), model_, lighting_);
}

}  // namespace relume::test
