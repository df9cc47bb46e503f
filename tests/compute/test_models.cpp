// SPDX-License-Identifier: MIT
#include "compute/test_models.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace relume::test {
namespace {

BlockMatrix to_blocks(const DenseMatrix& dense, std::uint32_t columns, const Storage& storage) {
  BlockMatrixBuilder builder(columns, storage.codec, storage.max_block_bytes);
  for (const std::vector<double>& row : dense) {
    std::vector<std::uint16_t> indices;
    std::vector<double> values;
    for (std::size_t column = 0; column < row.size(); ++column) {
      if (row[column] == 0.0) continue;
      indices.push_back(static_cast<std::uint16_t>(column));
      values.push_back(row[column]);
    }
    builder.append_row(indices, values);
  }
  return std::move(builder).finish();
}

DenseMatrix random_rows(Random& random, std::uint32_t rows, std::uint32_t columns, const RandomShape& shape) {
  DenseMatrix dense(rows, std::vector<double>(columns, 0.0));
  for (std::uint32_t row = 0; row < rows; ++row) {
    if (row % 7 == 6) continue;
    double sum = 0.0;
    const std::uint32_t entries = 1 + random.below(std::min(shape.row_entries, columns));
    for (std::uint32_t i = 0; i < entries; ++i) {
      double& value = dense[row][random.below(columns)];
      if (value > 0.0) continue;
      value = 0.01 + random.unit();
      sum += value;
    }
    for (double& value : dense[row]) value *= shape.row_sum / sum;
  }
  return dense;
}

std::vector<SenderRef> all_senders(const RandomShape& shape) {
  std::vector<SenderRef> senders;
  for (std::uint32_t system = 0; system < shape.clusters_of_system.size(); ++system) {
    for (std::uint32_t i = 0; i < shape.clusters_of_system[system]; ++i) senders.push_back({system, i});
  }
  for (std::uint32_t i = 0; i < shape.sky_patches; ++i) senders.push_back({kSkySystem, i});
  return senders;
}

void shuffle(std::vector<SenderRef>& senders, Random& random) {
  for (std::size_t i = senders.size(); i > 1; --i) {
    std::swap(senders[i - 1], senders[random.below(static_cast<std::uint32_t>(i))]);
  }
}

}  // namespace

Model drawn_model(const std::vector<DrawnSystem>& systems, std::uint32_t sky_patches,
                  const Storage& storage) {
  Model model;
  model.sky_resolution = sky_patches;
  for (std::uint32_t i = 0; i < sky_patches; ++i) model.sky_cells.push_back(i);
  for (const DrawnSystem& drawn : systems) {
    System& system = model.systems.emplace_back();
    system.name = "system " + std::to_string(model.systems.size());
    system.clusters.resize(drawn.bounce.size());
    system.imports = drawn.imports;
    const auto columns = static_cast<std::uint32_t>(drawn.imports.size());
    system.bounce = to_blocks(drawn.bounce, columns, storage);
    system.gather = to_blocks(drawn.gather, columns, storage);
    system.lumels.resize(drawn.gather.size());
  }
  return model;
}

Model random_model(const RandomShape& shape, std::uint64_t seed, const Storage& storage) {
  Random random(seed);
  std::vector<DrawnSystem> systems;
  for (const std::uint32_t clusters : shape.clusters_of_system) {
    DrawnSystem system;
    system.imports = all_senders(shape);
    shuffle(system.imports, random);
    const auto columns = static_cast<std::uint32_t>(system.imports.size());
    system.bounce = random_rows(random, clusters, columns, shape);
    system.gather = random_rows(random, shape.gather_rows, columns, shape);
    systems.push_back(std::move(system));
  }
  return drawn_model(systems, shape.sky_patches, storage);
}

Lighting random_lighting(const Model& model, std::uint64_t seed) {
  Random random(seed);
  const auto rgb = [&random](double top) {
    const double r = random.unit();
    const double g = random.unit();
    const double b = random.unit();
    return top * Rgb(r, g, b);
  };
  Lighting lighting;
  for (std::uint32_t i = 0; i < cluster_offsets(model).back(); ++i) {
    lighting.albedo.push_back(rgb(0.9));
    lighting.exitance.push_back(i % 5 == 0 ? rgb(2000.0) : Rgb(0.0));
    lighting.direct.push_back(i % 3 == 0 ? rgb(500.0) : Rgb(0.0));
  }
  for (std::size_t i = 0; i < model.sky_cells.size(); ++i) lighting.sky_radiosity.push_back(rgb(3000.0));
  return lighting;
}

Model furnace_model(std::uint32_t clusters, std::uint32_t entries) {
  DrawnSystem system;
  system.bounce.assign(clusters, std::vector<double>(clusters, 0.0));
  for (std::uint32_t row = 0; row < clusters; ++row) {
    system.imports.push_back({0, row});
    for (std::uint32_t i = 0; i < entries; ++i)
      system.bounce[row][(row + 1 + i * 3) % clusters] = 1.0 / entries;
  }
  system.gather = system.bounce;
  return drawn_model({system}, 0);
}

}  // namespace relume::test
