// SPDX-License-Identifier: MIT
#include "precompute/estimate.h"

#include <algorithm>

#include "core/directional_irradiance.h"
#include "core/model_file.h"

namespace relume {
namespace {

constexpr std::uint32_t kSampledTiles = 64, kClustersOfTile = 8;
/// Of a row that is held: its vectors and what the allocator adds to them; of a tile, its nine vectors.
constexpr double kRowBytes = 96.0, kTileBytes = 512.0;
/// A form factor that is held: a sender and a value.
constexpr double kEntryBytes = 8.0;
/// Rows that come and go leave gaps, which what follows does not fill.
constexpr double kBatchSlack = 1.2;
/// Of a tile of 8 that is held: a node, and 8 values.
constexpr double kTileEntryBytes = 36.0;

/// Rows of one kind.
struct RowSums {
  double rows = 0.0, sampled = 0.0;  ///< all, and those that the rest is of
  double nonzeros = 0.0, bytes = 0.0, columns = 0.0, tiles = 0.0;

  void scale() {
    const double factor = sampled > 0.0 ? rows / sampled : 0.0;
    for (double* sum : {&nonzeros, &bytes, &columns, &tiles}) *sum *= factor;
    sampled = rows;
  }
  void add(const RowSums& other) {
    rows += other.rows, sampled += other.sampled;
    nonzeros += other.nonzeros, bytes += other.bytes, columns += other.columns, tiles += other.tiles;
  }
};

/// Adds the tiles of a matrix of which half of the rows or more are sampled; the others would have looked
/// like those. sums(row): what the row counts to; sampled(row).
template <class Sums, class Sampled>
void add_tiles(const BlockMatrix& matrix, Sums&& sums, Sampled&& sampled) {
  const CsrMatrix csr = decode(matrix);
  for (const MatrixBlock& block : matrix.blocks) {
    for (std::uint32_t first = 0; first < block.row_count; first += block.tile_rows) {
      const std::uint32_t row = block.first_row + first;
      const std::uint32_t rows = std::min(block.tile_rows, block.row_count - first);
      std::uint32_t known = 0;
      for (std::uint32_t r = row; r < row + rows; ++r) known += sampled(r) ? 1 : 0;
      RowSums& sum = sums(row);
      sum.rows += rows;
      if (2 * known < rows || known == 0) continue;
      const std::uint32_t tile = first / block.tile_rows;
      const double columns = block.tile_offsets[tile + 1] - block.tile_offsets[tile];
      sum.sampled += rows;
      sum.nonzeros += double(csr.row_offsets[row + rows] - csr.row_offsets[row]) * rows / known;
      const double direction = block.directions.empty() ? 0.0 : double(sizeof(std::uint32_t));
      const double value = double(value_bytes(block.codec)) + direction;
      sum.bytes += columns * (2.0 + block.tile_rows * value) + 4.0 + 4.0 * rows;
      sum.columns += columns;
      sum.tiles += 1.0;
    }
  }
}

struct MatrixSums {
  RowSums clusters, lumels, sensors;
};

MatrixSums sums_of(const Model& sample, std::uint32_t every) {
  MatrixSums all;
  for (const System& system : sample.systems) {
    MatrixSums own;
    add_tiles(
        system.bounce, [&](std::uint32_t) -> RowSums& { return own.clusters; },
        [&](std::uint32_t row) { return in_sample(row, every); });
    const auto lumels = std::uint32_t(system.lumels.size());
    add_tiles(
        system.gather, [&](std::uint32_t row) -> RowSums& { return row < lumels ? own.lumels : all.sensors; },
        [&](std::uint32_t row) {
          if (row >= lumels) return system.sensors[row - lumels].name % every == 0;
          return in_sample(system.elements[system.lumels[row].element].cluster, every);
        });
    own.clusters.scale(), own.lumels.scale();
    all.clusters.add(own.clusters), all.lumels.add(own.lumels);
  }
  all.sensors.scale();
  return all;
}

double matrix_bytes(const Model& model) {
  double bytes = 0.0;
  for (const System& system : model.systems) {
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) {
      for (const MatrixBlock& block : matrix->blocks) bytes += double(block_bytes(block));
    }
  }
  return bytes;
}

struct SampledShare {
  double clusters = 0.0, elements = 0.0;
};

/// Of all clusters and elements.
SampledShare share_of(const Model& sample, std::uint32_t every) {
  double clusters = 0.0, elements = 0.0;
  SampledShare share;
  for (const System& system : sample.systems) {
    for (std::uint32_t c = 0; c < system.clusters.size(); ++c) {
      const double count = system.clusters[c].element_count;
      clusters += 1.0, elements += count;
      if (in_sample(c, every)) share.clusters += 1.0, share.elements += count;
    }
  }
  return {share.clusters / clusters, share.elements / elements};
}

/// Bytes of halvings, where rows of these shares are traced.
double halving_bytes(const Model& model, const SampledShare& share) {
  double bytes = 0.0;
  for (const System& system : model.systems)
    bytes += double(system.bounce_halvings.size()) / share.clusters +
             double(system.gather_halvings.size()) / share.elements;
  return bytes;
}

/// Of light probes, scaled from those of the sample to all.
struct ProbeSums {
  double entries = 0.0, bytes = 0.0;
  double missing_bytes = 0.0;  ///< those of `bytes` that the sample does not have
};

ProbeSums probe_sums(const Model& sample, const SampleFacts& facts) {
  if (sample.probe_names.empty()) return {};
  ProbeSums sums;
  for (const System& system : sample.systems) sums.entries += double(system.probe_senders.size());
  const double own =
      double(sizeof(ProbeSender)) * sums.entries + double(sizeof(Probe)) * double(sample.probe_names.size());
  const double factor = double(facts.probes) / double(sample.probe_names.size());
  sums.entries *= factor;
  sums.bytes = factor * own + double(facts.volume_bytes);
  sums.missing_bytes = sums.bytes - own;
  return sums;
}

/// Of clusters: in the largest system.
double largest_share(const Model& sample) {
  double all = 0.0, largest = 0.0;
  for (const System& system : sample.systems) {
    all += double(system.clusters.size());
    largest = std::max(largest, double(system.clusters.size()));
  }
  return largest / all;
}

/// What rows, tiles and the model of `model_bytes` that is made from them take where they take most.
double bytes_while_traced(const Model& sample, const MatrixSums& sums, const SampleFacts& facts,
                          const SampledShare& share, double model_bytes) {
  const double clusters =
      kEntryBytes * double(facts.counts.cluster_entries) / share.clusters + kRowBytes * sums.clusters.rows;
  const double moment = is_directional(sample) ? double(sizeof(glm::vec3)) : 0.0;
  const double lumels = (kEntryBytes + moment) * double(facts.counts.element_entries) / share.elements +
                        kRowBytes * sums.lumels.rows;
  if (!facts.cut) return clusters + lumels + kEntryBytes * sums.sensors.nonzeros + model_bytes;
  const double batch = lumels * std::min(1.0, double(kBatchElements) / std::max(sums.lumels.rows, 1.0));
  const double tiles = kTileEntryBytes * (sums.clusters.columns + sums.lumels.columns) +
                       kClustersOfTile * moment * sums.lumels.columns +
                       kTileBytes * (sums.clusters.tiles + sums.lumels.tiles);
  return tiles + kBatchSlack * (clusters * largest_share(sample) + batch) + model_bytes;
}

}  // namespace

std::uint32_t sample_every(std::uint32_t clusters) {
  return std::max(1u, clusters / (kClustersOfTile * kSampledTiles));
}

PrecomputeEstimate extrapolate(const Model& sample, const SampleFacts& facts) {
  const MatrixSums sums = sums_of(sample, facts.every);
  const SampledShare share = share_of(sample, facts.every);
  RowSums all = sums.clusters;
  all.add(sums.lumels), all.add(sums.sensors);
  PrecomputeEstimate estimate;
  const ProbeSums probes = probe_sums(sample, facts);
  estimate.rows = std::uint64_t(all.rows) + facts.probes;
  estimate.nonzeros = std::uint64_t(all.nonzeros + probes.entries);
  const double sampled_matrices = matrix_bytes(sample);
  const double halvings = halving_bytes(sample, share);
  const double rest = double(encode_model(sample).size()) - sampled_matrices + probes.missing_bytes +
                      halvings - halving_bytes(sample, {1.0, 1.0});
  estimate.file_bytes = std::uint64_t(rest + all.bytes);
  const double traced = double(facts.counts.rays + facts.counts.occlusion_rays);
  const double of_probes = double(facts.counts.probe_rays);
  const double more_probes = double(facts.probes) / std::max(1.0, double(sample.probe_names.size()));
  const double all_rays = (traced - of_probes) / share.elements + of_probes * more_probes;
  estimate.rays = std::uint64_t(all_rays);
  estimate.seconds = facts.seconds_before + facts.seconds_rows * all_rays / std::max(traced, 1.0) +
                     facts.seconds_after * (1.0 + all.bytes / std::max(sampled_matrices, 1.0)) / 2.0;
  const double model = rest + all.bytes;
  const double while_traced = bytes_while_traced(sample, sums, facts, share, model) + halvings;
  const double while_written = 2.0 * model + std::min(all.bytes, double(kMaxBlockBytes));
  estimate.memory_bytes =
      std::max(facts.peak_bytes, facts.resident_bytes + std::uint64_t(std::max(while_traced, while_written)));
  return estimate;
}

}  // namespace relume
