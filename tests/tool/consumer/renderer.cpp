// SPDX-License-Identifier: MIT
//
// consumer [FILE]: a renderer in C++, from an installed package: core and compute, on a device of its own.
// Lights a model for some frames; what they show must be what the reference of the same package says.
#include <compute/gpu_solver.h>
#include <core/compare.h>
#include <core/model_file.h>
#include <core/reference_solver.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <functional>

extern "C" {
#include "device.h"
}

#ifdef WITH_BAKER
bool bakes();
#endif

namespace {

constexpr int kFrames = 60;
constexpr double kLargestRadiosity = 1e5;
constexpr double kAllowed = 1e-4;
const relume::Rgb kDirect(400.0, 300.0, 200.0);  // lm/m2, of every cluster

relume::BufferRange range_of(const relume_buffer_range& range) {
  return {range.buffer, range.offset, range.byte_size};
}

struct DeviceOfOurs {
  renderer state{};
  DeviceOfOurs() = default;
  DeviceOfOurs(const DeviceOfOurs&) = delete;
  DeviceOfOurs& operator=(const DeviceOfOurs&) = delete;
  ~DeviceOfOurs() { close_renderer(&state); }

  relume::Result<relume::BufferRange> allocate(const relume::BufferRequirement& needed) {
    relume_buffer_requirement asked{};
    asked.byte_size = needed.byte_size;
    asked.alignment = needed.alignment;
    asked.usage = needed.usage;
    relume_buffer_range made{};
    if (allocate_buffer(&state, &asked, &made) != 0)
      return relume::fail(relume::ErrorCode::out_of_memory, "no memory for " + needed.name);
    return range_of(made);
  }
};

relume::Result<void> upload(DeviceOfOurs& device, const relume::GpuSolver& solver,
                            const relume::UploadData& data, const relume_staging& staging) {
  const relume::Staging memory{range_of(staging.range), static_cast<std::byte*>(staging.mapped)};
  relume::UploadCursor cursor;
  for (bool done = false; !done;) {
    done = solver.record_upload(begin_commands(&device.state), data, memory, cursor);
    if (submit_commands(&device.state) != 0)
      return relume::fail(relume::ErrorCode::no_device, "an upload was not run");
  }
  return {};
}

relume::Result<void> load(DeviceOfOurs& device, relume::GpuSolver& solver, const relume::Model& model,
                          relume::Schedule& schedule, const relume_staging& staging) {
  const auto allocate = [&](const relume::BufferRequirement& needed) { return device.allocate(needed); };
  if (auto bound = solver.bind(allocate); !bound) return bound;
  relume::UploadData data = solver.model_data(model);
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    if (auto loaded = solver.load(model, s, allocate); !loaded) return loaded;
    data.append(solver.system_data(model, s));
    relume::activate(solver.traits(), schedule, s);
  }
  return upload(device, solver, data, staging);
}

/// Frames in which the host writes direct light; every third command buffer is thrown away. The irradiance of
/// system 0 goes to `target`.
relume::Result<void> show(DeviceOfOurs& device, const relume::GpuSolver& solver, const relume::Model& model,
                          relume::Schedule& schedule, const relume_staging& inputs,
                          const relume::BufferRange& target) {
  std::vector<relume::InputCopy> copies;
  relume::BufferRange source = range_of(inputs.range);
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    source.byte_size = 16 * model.systems[s].clusters.size();
    copies.push_back({relume::Quantity::direct, s, 0, source});
    source.offset += source.byte_size;
  }
  const relume::IrradianceTarget targets[] = {{0, target}};
  for (int frame = 0; frame < kFrames; ++frame) {
    relume::FramePlan plan = solver.plan(schedule, relume::FrameWishes{.bounces = 2});
    const auto recorded = solver.record_frame(begin_commands(&device.state),
                                              {.plan = &plan, .copies = copies}, {.irradiance = targets});
    if (!recorded) return recorded;
    if (frame % 3 == 1) {
      vkEndCommandBuffer(device.state.commands);
      continue;
    }
    if (submit_commands(&device.state) != 0)
      return relume::fail(relume::ErrorCode::no_device, "a frame was not run");
    schedule = std::move(plan.next);
  }
  return {};
}

std::vector<relume::Rgb> reference(const relume::Model& model) {
  relume::Lighting lighting = relume::stored_lighting(model);
  for (relume::Rgb& direct : lighting.direct) direct = kDirect;
  const relume::ReferenceMatrices matrices = relume::reference_matrices(model);
  const auto solution = relume::solve_reference(matrices.bounce, lighting, {10000, 1e-8});
  if (!solution) return {};
  std::vector<relume::Rgb> rows = relume::gather(matrices.gather, lighting, solution->radiosity);
  rows.resize(relume::gather_offsets(model)[1]);
  return rows;
}

relume::Result<double> error_of_frames(DeviceOfOurs& device, const relume::Model& model) {
  const renderer& r = device.state;
  auto solver =
      relume::GpuSolver::create({r.instance, r.physical_device, r.device, vkGetInstanceProcAddr}, model, {});
  if (!solver) return tl::unexpected(solver.error());
  const std::size_t clusters = relume::cluster_offsets(model).back(), rows = relume::gather_offsets(model)[1];
  relume_staging staging{}, inputs{}, results{};
  if (allocate_staging(&device.state, 1 << 22, &staging) != 0 ||
      allocate_staging(&device.state, 16 * clusters, &inputs) != 0 ||
      allocate_staging(&device.state, 16 * rows, &results) != 0)
    return relume::fail(relume::ErrorCode::out_of_memory, "no memory to copy from and to");
  auto* direct = static_cast<float*>(inputs.mapped);
  for (std::size_t i = 0; i < 4 * clusters; ++i) direct[i] = i % 4 < 3 ? float(kDirect[int(i % 4)]) : 0.0f;
  relume::Schedule schedule = relume::make_schedule(model.systems.size(), kLargestRadiosity);
  if (auto loaded = load(device, *solver, model, schedule, staging); !loaded)
    return tl::unexpected(loaded.error());
  if (auto shown = show(device, *solver, model, schedule, inputs, range_of(results.range)); !shown)
    return tl::unexpected(shown.error());
  std::vector<relume::Rgb> found;
  for (std::size_t i = 0; i < rows; ++i) {
    std::array<float, 4> value{};
    std::memcpy(value.data(), static_cast<const std::byte*>(results.mapped) + 16 * i, 16);
    found.emplace_back(value[0], value[1], value[2]);
  }
  const std::vector<relume::Rgb> expected = reference(model);
  if (expected.size() != rows) return relume::fail(relume::ErrorCode::check_failed, "no reference");
  return relume::compare("irradiance", found, expected).max_relative_error;
}

int run(const char* file) {
  const auto model = relume::read_model(file);
  if (!model) {
    std::fprintf(stderr, "%s\n", model.error().message.c_str());
    return 1;
  }
  DeviceOfOurs device;
  relume_error error;
  if (open_renderer(&device.state, &error) == 0) {
    std::printf("no device: %s\n", error.message);
    return 0;
  }
  const auto off = error_of_frames(device, *model);
  if (!off) {
    std::fprintf(stderr, "%s\n", off.error().message.c_str());
    return 1;
  }
  std::printf("irradiance of system 0: off by %g at most\n", *off);
  return *off <= kAllowed ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  const relume::Model empty;
  const bool reads = relume::decode_model(relume::encode_model(empty), "empty").has_value();
  const bool names = relume::row_kernel_from_name("row_per_thread").has_value();
#ifdef WITH_BAKER
  if (!bakes()) return 1;
#endif
  if (!reads || !names) return 1;
  return count > 1 ? run(arguments[1]) : 0;
}
