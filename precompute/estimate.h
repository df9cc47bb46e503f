// SPDX-License-Identifier: MIT
//
// What a precompute will take, extrapolated from a model of few rows.
#pragma once

#include <cstdint>

#include "core/model.h"
#include "precompute/precompute.h"
#include "precompute/rows.h"

namespace relume {

/// A sample (in_sample) of about 512 clusters.
std::uint32_t sample_every(std::uint32_t clusters);

/// Light probes of a sample, at most.
inline constexpr std::size_t kSampledProbes = 64;

/// What is known of a sample beside its model.
struct SampleFacts {
  std::uint32_t every = 1;
  bool cut = false;                ///< whether rows are cut: full ones are then held a batch at a time
  RowCounts counts;                ///< of the sample alone
  std::uint64_t probes = 0;        ///< light probes in all; the sample has some of them, evenly spread
  std::uint64_t volume_bytes = 0;  ///< of the cells between them
  double seconds_before = 0.0;     ///< of what is done once, whatever the number of rows
  double seconds_rows = 0.0;       ///< of rays and cut of the sample
  double seconds_after = 0.0;      ///< of the model made from it
  std::uint64_t resident_bytes = 0, peak_bytes = 0;  ///< of the process before rows were traced
};

/// Rows grow from those of the sample, system by system; what else a file holds is the sample's. Memory is
/// that of the process now, and of rows, tiles, matrices and the file's bytes where they are held together.
PrecomputeEstimate extrapolate(const Model& sample, const SampleFacts& facts);

}  // namespace relume
