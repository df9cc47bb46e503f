// SPDX-License-Identifier: MIT
#include "compute/standalone/tune_row_kernel.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "compute/kernel_trials.h"
#include "compute/standalone/kernel_cache.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/standalone/standalone_memory.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

/// Enough that each trial has the cores to itself at least once, on a machine that does other things as well.
constexpr int kRounds = 15;
constexpr VkDeviceSize kStagingBytes = VkDeviceSize{16} << 20;

Result<void> provide_memory(StandaloneDevice& device, KernelTrials& trials, DeviceArena& arena) {
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : trials.buffers()) {
    auto range = arena.allocate(buffer);
    if (!range) return tl::unexpected<Error>(range.error());
    ranges.push_back(*range);
  }
  if (auto bound = trials.bind(ranges); !bound) return bound;
  const auto staging =
      make_device_buffer(device, kStagingBytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  if (!staging) return tl::unexpected<Error>(staging.error());
  const UploadData data = trials.data();
  UploadCursor cursor;
  for (bool done = false; !done;) {
    const auto submitted = device.submit([&](VkCommandBuffer commands) {
      done = trials.record_upload(commands, data, {staging->range(), staging->mapped}, cursor);
    });
    if (!submitted) return tl::unexpected<Error>(submitted.error());
  }
  return {};
}

Result<double> seconds_of_trial(StandaloneDevice& device, const KernelTrials& trials, std::size_t trial) {
  const auto times = device.submit([&](VkCommandBuffer commands) { trials.record(commands, trial); });
  if (!times) return tl::unexpected<Error>(times.error());
  return times->gpu_seconds > 0.0 ? times->gpu_seconds : times->seconds;
}

/// The trials that give the bits of the first, by number. This first time compiles on some drivers.
Result<std::vector<std::size_t>> equal_trials(StandaloneDevice& device, const KernelTrials& trials) {
  const BufferRange irradiance = trials.irradiance();
  std::vector<float> expected;
  std::vector<std::size_t> equal;
  for (std::size_t trial = 0; trial < trials.choices().size(); ++trial) {
    if (auto ran = seconds_of_trial(device, trials, trial); !ran) return tl::unexpected<Error>(ran.error());
    auto found = read_floats(device, irradiance, irradiance.byte_size / sizeof(float));
    if (!found) return tl::unexpected<Error>(found.error());
    if (trial == 0) expected = *found;
    if (*found == expected) equal.push_back(trial);
  }
  return equal;
}

const MatrixBlock* first_tiles(const Model& model) {
  for (const System& system : model.systems) {
    for (const BlockMatrix* matrix : {&system.gather, &system.bounce}) {
      if (!matrix->blocks.empty() && matrix->blocks[0].tile_rows == kernels::kTileOfRows)
        return &matrix->blocks[0];
    }
  }
  return nullptr;
}

std::string cache_key(const StandaloneDevice& device, ValueCodec codec) {
  std::string key =
      device.name() + ", " + device.driver() + ", codec " + std::to_string(static_cast<int>(codec));
  std::replace(key.begin(), key.end(), '\t', ' ');
  std::replace(key.begin(), key.end(), '\n', ' ');
  return key;
}

}  // namespace

Result<std::vector<RowKernelTime>> time_row_kernels(StandaloneDevice& device, ValueCodec codec) {
  auto trials = KernelTrials::create(device.host(), codec);
  if (!trials) return tl::unexpected<Error>(trials.error());
  DeviceArena arena(device);
  if (auto provided = provide_memory(device, *trials, arena); !provided)
    return tl::unexpected<Error>(provided.error());
  const auto equal = equal_trials(device, *trials);
  if (!equal) return tl::unexpected<Error>(equal.error());
  std::vector<RowKernelTime> times;
  for (const std::size_t trial : *equal) times.push_back({trials->choices()[trial], 0.0});
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto seconds = seconds_of_trial(device, *trials, (*equal)[i]);
      if (!seconds) return tl::unexpected<Error>(seconds.error());
      times[i].seconds = round == 0 ? *seconds : std::min(times[i].seconds, *seconds);
    }
  }
  std::sort(times.begin(), times.end(),
            [](const RowKernelTime& a, const RowKernelTime& b) { return a.seconds < b.seconds; });
  return times;
}

Result<RowKernelChoice> tuned_row_kernel(StandaloneDevice& device, const Model& model,
                                         const std::filesystem::path& cache) {
  const MatrixBlock* tiles = first_tiles(model);
  if (tiles == nullptr) return RowKernelChoice{default_row_kernel(device, model), MatrixFetch::texels};
  const std::string key = cache_key(device, tiles->codec);
  if (!cache.empty()) {
    if (const auto known = read_kernel_cache(cache, key)) return *known;
  }
  const auto times = time_row_kernels(device, tiles->codec);
  if (!times) return tl::unexpected<Error>(times.error());
  if (!cache.empty()) write_kernel_cache(cache, key, times->front().choice);
  return times->front().choice;
}

}  // namespace relume
