// SPDX-License-Identifier: MIT
//
// Models with nothing but matrices: what a solve needs.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/block_matrix.h"
#include "core/model.h"
#include "core/solve.h"
#include "support/matrices.h"

namespace relume::test {

/// A system drawn by hand: rows are clusters (bounce) or receivers (gather), columns are imports.
struct DrawnSystem {
  std::vector<SenderRef> imports;
  DenseMatrix bounce;
  DenseMatrix gather;
};

struct Storage {
  ValueCodec codec = ValueCodec::f32;
  std::size_t max_block_bytes = kMaxBlockBytes;
  std::uint32_t tile_rows = 1;
};

Model drawn_model(const std::vector<DrawnSystem>& systems, std::uint32_t sky_patches,
                  const Storage& storage = {});

/// Numbers that are the same everywhere: the distributions of the standard library are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  ///< [0, 1)
  std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(unit() * end); }

 private:
  std::mt19937_64 engine_;
};

struct RandomShape {
  std::vector<std::uint32_t> clusters_of_system = {37, 1, 120, 64};
  std::uint32_t gather_rows = 90;  ///< per system
  std::uint32_t sky_patches = 11;
  std::uint32_t nodes = 0;  ///< per system that has two clusters, and of the sky: ranges of any length
  std::uint32_t spanning_nodes = 0;  ///< above the systems: a random sender of each of some systems
  std::uint32_t probes = 0;          ///< per system, with up to row_entries senders; every fifth sees nothing
  std::uint32_t row_entries = 40;    ///< at most; every seventh row is empty
  double row_sum = 0.95;
  bool directional = false;  ///< directions of any length up to 1 for the gather matrices
};

/// Every system imports all clusters, nodes, sky patches and nodes above the systems, in shuffled order.
/// Areas differ.
Model random_model(const RandomShape& shape, std::uint64_t seed, const Storage& storage = {});

/// The model as if `system` had not been loaded.
Model unloaded(Model model, std::size_t system);

/// Albedo up to 0.9, and different light in every channel, cluster and sky patch.
Lighting random_lighting(const Model& model, std::uint64_t seed);

/// A closed room in which every row sums to exactly 1: `clusters` clusters, `entries` equal form factors a
/// row (a power of two).
Model furnace_model(std::uint32_t clusters, std::uint32_t entries);

}  // namespace relume::test
