// SPDX-License-Identifier: MIT
#include "compute/kernel_trials.h"

#include <algorithm>
#include <utility>

#include "compute/row_kernels.h"

namespace relume {
namespace {

constexpr std::uint32_t kSenders = 2048, kTiles = 1024, kTileRows = 8, kEntries = 128;
/// A fixed sequence of numbers below 256 that look random.
std::uint32_t noise(std::uint32_t index) {
  return ((index * 2654435761u) ^ (index >> 7) * 40503u) >> 16 & 0xffu;
}

BlockMatrix tuning_matrix(ValueCodec codec) {
  BlockMatrixBuilder builder(kSenders, codec);
  std::vector<std::uint16_t> columns(kEntries);
  std::vector<double> values(std::size_t{kTileRows} * kEntries);
  constexpr std::uint32_t kStride = kSenders / kEntries;
  for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
    for (std::uint32_t c = 0; c < kEntries; ++c)
      columns[c] = static_cast<std::uint16_t>(c * kStride + noise(tile + c) % kStride);
    for (std::size_t v = 0; v < values.size(); ++v)
      values[v] = (1.0 + noise(tile + static_cast<std::uint32_t>(v))) / (256.0 * kEntries);
    builder.append_tile(columns, values, kTileRows);
  }
  return std::move(builder).finish();
}

/// One system whose gather matrix is the one above; its bounces have nothing to do.
Model tuning_model(ValueCodec codec) {
  Model model;
  System& system = model.systems.emplace_back();
  system.clusters.resize(kSenders);
  for (std::uint32_t i = 0; i < kSenders; ++i) {
    Cluster& cluster = system.clusters[i];
    for (std::uint32_t c = 0; c < 3; ++c) cluster.exitance[c] = float(noise(3 * i + c));
  }
  BlockMatrixBuilder empty(kSenders, codec);
  for (std::uint32_t i = 0; i < kSenders; ++i) {
    system.imports.push_back({0, i});
    empty.append_row({}, std::vector<double>());
  }
  system.bounce = std::move(empty).finish();
  system.gather = tuning_matrix(codec);
  return model;
}

}  // namespace

KernelTrials::KernelTrials(ValueCodec codec) : model_(std::make_unique<Model>(tuning_model(codec))) {}

Result<KernelTrials> KernelTrials::create(const HostDevice& host, ValueCodec codec) {
  KernelTrials trials(codec);
  for (const RowKernel kernel : {RowKernel::tile_shared, RowKernel::tile_shuffle}) {
    if (!supports_row_kernel(host, kernel)) continue;
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
      auto solver = GpuSolver::create(host, *trials.model_, {.kernel = kernel, .fetch = fetch});
      if (!solver) return tl::unexpected<Error>(solver.error());
      trials.choices_.push_back({kernel, fetch});
      trials.solvers_.push_back(std::move(*solver));
    }
  }
  const GpuSolver& any = trials.solvers_.front();
  auto of_system = any.system_buffers(*trials.model_, 0);
  if (!of_system) return tl::unexpected<Error>(of_system.error());
  trials.buffers_.assign(any.buffers().begin(), any.buffers().end());
  trials.buffers_.insert(trials.buffers_.end(), of_system->begin(), of_system->end());
  return trials;
}

Result<void> KernelTrials::bind(std::span<const BufferRange> ranges) {
  for (GpuSolver& solver : solvers_) {
    const std::size_t own = std::min(solver.buffers().size(), ranges.size());
    if (auto bound = solver.bind(ranges.first(own)); !bound) return bound;
    if (auto loaded = solver.load(*model_, 0, ranges.subspan(own)); !loaded) return loaded;
  }
  return {};
}

UploadData KernelTrials::data() const {
  UploadData data = solvers_.front().model_data(*model_);
  data.append(solvers_.front().system_data(*model_, 0));
  return data;
}

bool KernelTrials::record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                                 UploadCursor& cursor) const {
  return solvers_.front().record_upload(commands, data, staging, cursor);
}

void KernelTrials::record(VkCommandBuffer commands, std::size_t trial) const {
  const GpuSolver& solver = solvers_[trial];
  Schedule schedule = make_schedule(1, 0.0);
  activate(solver.traits(), schedule, 0);
  const FramePlan plan = solver.plan(schedule, PassWishes{.restart = true, .gather = true});
  // Nothing that it checks can be wrong here but a device that was lost, which the submission will say.
  static_cast<void>(solver.record_frame(commands, {.plan = &plan}, {}));
}

}  // namespace relume
