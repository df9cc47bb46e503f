// SPDX-License-Identifier: MIT
//
// Which row kernel is the fastest on a device: measured, because no driver's name says it. The host times;
// what is recorded is a product of a made-up matrix, a million form factors in tiles of eight rows, by each
// kernel that the device can run, from storage and from texel buffers.
//
//   auto trials = KernelTrials::create(host, ValueCodec::unorm16);
//   trials->bind(allocated_for(trials->buffers()));
//   // record_upload of trials->data(), submit
//   for each i: submit trials->record(commands, i) twice, timestamps around the second: the first may compile
//   SolverOptions{.kernel = trials->choices()[fastest].kernel, .fetch = trials->choices()[fastest].fetch}
//
// All give the same bits, so that the choice changes no result. It depends on the device, its driver and the
// codec alone, and may be kept for them. Ownership, synchronisation and failure: as compute/gpu_solver.h.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "compute/gpu_solver.h"
#include "core/block_matrix.h"

namespace relume {

class KernelTrials {
 public:
  /// Makes the pipelines of all trials.
  static Result<KernelTrials> create(const HostDevice& host, ValueCodec codec);

  /// What trial number i tries.
  std::span<const RowKernelChoice> choices() const { return choices_; }

  /// 10 MB, for all trials together.
  std::span<const BufferRequirement> buffers() const { return buffers_; }
  Result<void> bind(std::span<const BufferRange> ranges);

  /// For record_upload. Refers to this, wherever it is moved.
  UploadData data() const;
  bool record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                     UploadCursor& cursor) const;

  void record(VkCommandBuffer commands, std::size_t trial) const;

  /// What the last trial gave: four floats a row.
  BufferRange irradiance() const { return solvers_.front().irradiance(0); }

 private:
  KernelTrials(ValueCodec codec);

  std::unique_ptr<const Model> model_;
  std::vector<RowKernelChoice> choices_;
  std::vector<GpuSolver> solvers_;  ///< one a trial, all on the same buffers
  std::vector<BufferRequirement> buffers_;
};

}  // namespace relume
