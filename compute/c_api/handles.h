// SPDX-License-Identifier: MIT
//
// What is behind the handles of compute/relume.h and relume_passes.h.
#pragma once

#include <algorithm>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "compute/direct_light.h"
#include "compute/gpu_solver.h"
#include "compute/light_cache.h"
#include "compute/lightmap_pass.h"
#include "compute/material_pass.h"
#include "compute/relume.h"
#include "compute/relume_passes.h"
#include "compute/screen_pass.h"

struct relume_model {
  relume::Model model;
};

/// Lights of one system.
struct SystemLights {
  relume::DirectLight light;
  relume::LightSchedule schedule;
  bool by_mask = false;
  bool uploaded = false;
};

/// Bytes on their way, and what to do when they are recorded.
struct PendingUpload {
  relume::UploadData data;
  std::uint32_t system = relume::kNone;  ///< that it is for
  std::function<void()> then{};
  const void* pass = nullptr;  ///< lightmap, materials or screen that it is for
  relume::UploadCursor cursor{};
};

struct relume_solver {
  relume::HostDevice host;
  const relume::Model* model;
  relume::GpuSolver solver;
  relume::Schedule schedule;
  std::vector<relume::Light> lights{};
  std::map<std::uint32_t, std::unique_ptr<SystemLights>> system_lights{};
  /// Of the first lights: the occluders are of all.
  std::vector<relume::BufferRange> occluders{};
  std::deque<PendingUpload> uploads{};
  /// What a plan that is under way would overwrite waits here for the next.
  std::vector<std::function<void()>> before_plan{};
  std::optional<relume::FramePlan> plan{};
  bool recorded = false;  ///< of the plan; its lights are booked as traced
};

struct relume_lightmap {
  relume_solver* solver;
  std::uint32_t system;
  relume::LightmapFormat format;
  relume::LightmapTexels texels;
  relume::LightmapPass pass;
  bool uploaded = false;
};

struct relume_light_cache {
  relume_solver* solver;
  std::uint32_t system;
  std::uint32_t lights;
  relume::LightCache cache;
  bool bound = false;
};

struct relume_materials {
  relume_solver* solver;
  std::uint32_t system;
  relume::StatePer per;
  relume::MaterialPass pass;
  relume::BufferRange states{};  ///< of the states, once bound
  bool uploaded = false;
};

struct relume_screen {
  relume_solver* solver;
  std::uint32_t system;
  relume::TextureFootprint footprint;
  std::uint32_t max_images;
  relume::ScreenPass pass;
  std::uint32_t images = 0;
  bool bound = false;
  bool uploaded = false;
};

namespace relume::c_api {

inline relume_status report(const Error& from, relume_error* error) {
  const auto status = static_cast<relume_status>(from.code);
  if (error == nullptr) return status;
  error->status = status;
  const std::size_t size = std::min(from.message.size(), sizeof error->message - 1);
  std::copy_n(from.message.begin(), size, error->message);
  error->message[size] = '\0';
  return status;
}

/// The status of `body`, a function that gives a Result<void>. Nothing is thrown further.
template <class Body>
relume_status guarded(relume_error* error, const Body& body) {
  try {
    const Result<void> result = body();
    if (!result) return report(result.error(), error);
    if (error != nullptr) *error = {RELUME_OK, ""};
    return RELUME_OK;
  } catch (const std::bad_alloc&) {
    return report({ErrorCode::out_of_memory, "out of memory"}, error);
  } catch (const std::exception& exception) {
    return report({ErrorCode::check_failed, exception.what()}, error);
  }
}

inline BufferRange from_c(const relume_buffer_range& range) {
  return {range.buffer, range.offset, range.byte_size};
}

inline relume_buffer_range to_c(const BufferRange& range) {
  return {range.buffer, range.offset, range.byte_size};
}

inline Staging from_c(const relume_staging& staging) {
  return {from_c(staging.range), static_cast<std::byte*>(staging.mapped)};
}

/// The host's callback as the library wants it.
BufferAllocator allocator(relume_allocate allocate, void* user);

/// One range for each.
Result<std::vector<BufferRange>> allocate_all(std::span<const BufferRequirement> requirements,
                                              const BufferAllocator& allocate);

/// Fails when there is no such system.
Result<void> check_loaded(const relume_solver& solver, std::uint32_t system);

/// Where the colours of a loaded system's clusters are.
ClusterColorRanges color_ranges(const relume_solver& solver, std::uint32_t system);

/// The bytes of a pass, on their way to what it was bound to; then it may be recorded.
template <class Pass>
void upload_pass(Pass& pass, UploadData data, std::vector<BufferRange> ranges) {
  data.targets = std::move(ranges);
  pass.solver->uploads.push_back({std::move(data), pass.system, [&pass] { pass.uploaded = true; }, &pass});
}

/// What is left of it to upload is forgotten.
template <class Pass>
void destroy_pass(Pass* pass) {
  if (pass == nullptr) return;
  std::erase_if(pass->solver->uploads, [pass](const PendingUpload& upload) { return upload.pass == pass; });
  delete pass;
}

}  // namespace relume::c_api
