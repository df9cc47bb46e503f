// SPDX-License-Identifier: MIT
#include "compute/test_models.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "core/packed_direction.h"
#include "core/sender_leaves.h"
#include "core/value_codec.h"

namespace relume::test {
namespace {

/// Columns of which any of the rows has something.
std::vector<std::uint16_t> used_columns(std::span<const std::vector<double>> rows) {
  std::vector<std::uint16_t> used;
  for (std::size_t column = 0; column < rows[0].size(); ++column) {
    if (std::any_of(rows.begin(), rows.end(), [column](const auto& row) { return row[column] != 0.0; }))
      used.push_back(static_cast<std::uint16_t>(column));
  }
  return used;
}

BlockMatrix to_blocks(const DenseMatrix& dense, std::uint32_t columns, const Storage& storage) {
  BlockMatrixBuilder builder(columns, storage.codec, storage.max_block_bytes);
  for (std::size_t first = 0; first < dense.size(); first += storage.tile_rows) {
    const auto rows =
        std::span(dense).subspan(first, std::min<std::size_t>(storage.tile_rows, dense.size() - first));
    const std::vector<std::uint16_t> indices = used_columns(rows);
    std::vector<double> values;
    for (const std::vector<double>& row : rows) {
      for (const std::uint16_t column : indices) values.push_back(row[column]);
    }
    if (storage.tile_rows == 1) {
      builder.append_row(indices, values);
    } else {
      builder.append_tile(indices, values, static_cast<std::uint32_t>(rows.size()));
    }
  }
  return std::move(builder).finish();
}

ClusterTreeNodes random_tree(Random& random, std::uint32_t nodes, std::uint32_t leaves) {
  ClusterTreeNodes tree;
  for (std::uint32_t i = 0; i < nodes && leaves >= 2; ++i) {
    const std::uint32_t first = random.below(leaves - 1), count = 2 + random.below(leaves - first - 1);
    tree.nodes.push_back({first, count, static_cast<std::uint32_t>(tree.shares.size())});
    std::vector<double> weights;
    for (std::uint32_t k = 0; k < count; ++k) weights.push_back(1.0 + random.below(100));
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (const double weight : weights) tree.shares.push_back(static_cast<float>(weight / sum));
  }
  return tree;
}

void add_spanning_nodes(Random& random, std::uint32_t nodes, Model& model) {
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const auto first_part = static_cast<std::uint32_t>(model.top_parts.size());
    for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
      if (s > 1 && random.below(3) == 0) continue;  // two parts at least
      const System& system = model.systems[s];
      const SenderRef sender{s,
                             random.below(std::uint32_t(system.clusters.size() + system.tree.nodes.size()))};
      model.top_parts.push_back({sender, 1.0f + static_cast<float>(random.below(7))});
    }
    const std::span parts(model.top_parts.begin() + first_part, model.top_parts.end());
    float sum = 0.0f;
    for (const SpannedPart& part : parts) sum += part.share;
    for (SpannedPart& part : parts) part.share /= sum;
    model.top_tree.push_back({first_part, static_cast<std::uint32_t>(model.top_parts.size()) - first_part});
  }
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

void add_directions(Random& random, BlockMatrix& gather) {
  for (MatrixBlock& block : gather.blocks) {
    block.directions.resize(block.columns.size() * block.tile_rows);
    for (std::size_t i = 0; i < block.directions.size(); ++i) {
      const glm::dvec3 direction(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
      const bool used = unscaled_value(block.codec, block.values, i) > 0.0;
      block.directions[i] = used ? pack_direction(2.0 * direction) : 0;
    }
  }
}

/// Lists of senders with directions of any length up to 1.
void add_probes(Random& random, const RandomShape& shape, Model& model, System& system) {
  for (std::uint32_t i = 0; i < shape.probes; ++i) {
    const auto first = static_cast<std::uint32_t>(system.probe_senders.size());
    const auto columns = static_cast<std::uint32_t>(system.imports.size());
    const std::uint32_t count = i % 5 == 4 ? 0 : 1 + random.below(shape.row_entries);
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto column = static_cast<std::uint32_t>(std::uint64_t{k} * columns / count);
      const glm::dvec3 direction(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
      system.probe_senders.push_back({column, static_cast<float>(0.1 + random.unit()), glm::vec3(direction)});
    }
    system.probes.push_back({{}, static_cast<std::uint32_t>(model.probe_names.size()), 0, first, count});
    model.probe_names.push_back(std::to_string(model.probe_names.size()));
  }
}

std::vector<SenderRef> all_senders(const RandomShape& shape) {
  std::vector<SenderRef> senders;
  const auto add = [&](std::uint32_t system, std::uint32_t leaves) {
    const std::uint32_t nodes = leaves >= 2 ? shape.nodes : 0;
    for (std::uint32_t i = 0; i < leaves + nodes; ++i) senders.push_back({system, i});
  };
  for (std::uint32_t system = 0; system < shape.clusters_of_system.size(); ++system)
    add(system, shape.clusters_of_system[system]);
  add(kSkySystem, shape.sky_patches);
  for (std::uint32_t i = 0; i < shape.spanning_nodes; ++i) senders.push_back({kSpanningNodes, i});
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
  Model model = drawn_model(systems, shape.sky_patches, storage);
  for (System& system : model.systems) {
    for (Cluster& cluster : system.clusters) cluster.area = static_cast<float>(0.1 + random.unit());
    add_probes(random, shape, model, system);
    if (shape.directional) add_directions(random, system.gather);
    system.tree = random_tree(random, shape.nodes, static_cast<std::uint32_t>(system.clusters.size()));
  }
  model.sky_tree = random_tree(random, shape.nodes, shape.sky_patches);
  add_spanning_nodes(random, shape.spanning_nodes, model);
  return model;
}

Model unloaded(Model model, std::size_t system) {
  const std::string name = model.systems[system].name;
  model.systems[system] = {};
  model.systems[system].name = name;
  model.systems[system].loaded = false;
  return model;
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
