// SPDX-License-Identifier: MIT
#include "precompute/store_matrices.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <functional>
#include <tuple>

namespace relume {
namespace {

/// Rows that follow each other in a matrix, or their tiles.
struct RowGroup {
  std::vector<const FormFactorRow*> rows;
  const std::vector<CutTile>* tiles = nullptr;
};

/// All rows of a system.
struct SystemRowGroups {
  RowGroup clusters, lumels, sensors;
};

SystemRowGroups row_groups(const ModelParts& parts, std::size_t s) {
  SystemRowGroups groups;
  if (!parts.tiles.empty()) {
    const SystemTiles& tiles = parts.tiles[s];
    return {{{}, &tiles.clusters}, {{}, &tiles.lumels}, {{}, &tiles.sensors}};
  }
  for (const FormFactorRow& row : parts.rows[s].clusters) groups.clusters.rows.push_back(&row);
  for (const auto e : parts.element_orders[s]) {
    if (parts.own_elements[s][e]) groups.lumels.rows.push_back(&parts.rows[s].elements[e]);
  }
  // Sensors go to the first system: only there are their rows needed.
  if (s == 0) {
    for (const FormFactorRow& row : parts.sensors.rows) groups.sensors.rows.push_back(&row);
  }
  return groups;
}

/// The leaf nodes of the tree, per sender.
std::vector<std::uint32_t> leaf_nodes(const SenderTree& senders) {
  std::vector<std::uint32_t> leaves(senders.weights.size());
  for (std::uint32_t n = 0; n < senders.tree.nodes.size(); ++n) {
    if (senders.tree.nodes[n].count == 1) leaves[senders.tree.nodes[n].first] = n;
  }
  return leaves;
}

using TileVisitor = std::function<void(const CutTile&)>;

void visit_tiles(const RowGroup& group, const std::vector<std::uint32_t>& leaves, const TileVisitor& visit) {
  if (group.tiles != nullptr) {
    for (const CutTile& tile : *group.tiles) visit(tile);
    return;
  }
  CutTile tile;  // one for all rows: its memory serves again
  tile.values.resize(1);
  for (const FormFactorRow* row : group.rows) {
    tile.nodes.resize(row->senders.size());
    std::transform(row->senders.begin(), row->senders.end(), tile.nodes.begin(),
                   [&](std::uint32_t sender) { return leaves[sender]; });
    tile.values[0].assign(row->values.begin(), row->values.end());
    visit(tile);
  }
}

/// What senders the nodes of the tree are in the model; nodes that no tile keeps have no place there.
class NodeReferences {
 public:
  explicit NodeReferences(const ModelParts& parts)
      : parts_(parts), references_(parts.senders.tree.nodes.size(), {kUnused, 0}) {}

  /// Adds an inner node to the tree of its system, once.
  void use(std::uint32_t node, Model& model) {
    const TreeNodeRange& range = parts_.senders.tree.nodes[node];
    SenderRef& reference = references_[node];
    if (reference.system != kUnused) return;
    const bool sky = range.first >= parts_.cluster_count;
    std::uint32_t owner = 0;
    while (!sky && range.first >= parts_.surfaces[owner].first_cluster + parts_.surfaces[owner].cluster_count)
      ++owner;
    const std::uint32_t first =
        range.first - (sky ? parts_.cluster_count : parts_.surfaces[owner].first_cluster);
    reference = {sky ? kSkySystem : owner, first};
    if (range.count == 1) return;
    auto& tree = sky ? model.sky_tree : model.systems[owner].tree;
    const std::size_t leaves = sky ? parts_.senders.sky_cells.size() : parts_.surfaces[owner].cluster_count;
    reference.index = std::uint32_t(leaves + tree.size());
    tree.push_back({first, range.count});
  }
  const SenderRef& of(std::uint32_t node) const { return references_[node]; }

 private:
  static constexpr std::uint32_t kUnused = 0xfffffffeu;
  const ModelParts& parts_;
  std::vector<SenderRef> references_;
};

/// The nodes that some tiles of a system keep, as an import table, and the local column of each.
class ImportTable {
 public:
  explicit ImportTable(std::size_t nodes) : column_(nodes, kNone) {}
  void use(const CutTile& tile) {
    for (const auto node : tile.nodes) column_[node] = 0;
  }
  /// Imports in the order of the senders, so that columns ascend in every tile.
  std::vector<SenderRef> finish(const ClusterTree& tree, NodeReferences& references, Model& model) {
    std::vector<std::uint32_t> used;
    for (std::uint32_t n = 0; n < column_.size(); ++n) {
      if (column_[n] != kNone) used.push_back(n);
    }
    std::sort(used.begin(), used.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(tree.nodes[a].first, tree.nodes[a].count) <
             std::tie(tree.nodes[b].first, tree.nodes[b].count);
    });
    std::vector<SenderRef> imports;
    for (const auto node : used) {
      column_[node] = std::uint32_t(imports.size());
      references.use(node, model);
      imports.push_back(references.of(node));
    }
    return imports;
  }
  std::vector<std::uint16_t> columns(const CutTile& tile) const {
    std::vector<std::uint16_t> columns(tile.nodes.size());
    std::transform(tile.nodes.begin(), tile.nodes.end(), columns.begin(),
                   [&](std::uint32_t node) { return std::uint16_t(column_[node]); });
    return columns;
  }

 private:
  std::vector<std::uint32_t> column_;
};

void append(const ImportTable& imports, const CutTile& tile, bool shared, BlockMatrixBuilder& matrix) {
  std::vector<double> values;
  for (const auto& row : tile.values) values.insert(values.end(), row.begin(), row.end());
  if (shared) {
    matrix.append_tile(imports.columns(tile), values, std::uint32_t(tile.values.size()));
  } else {
    matrix.append_row(imports.columns(tile), values);
  }
}

Result<void> store_system(const ModelParts& parts, ValueCodec codec, const SystemRowGroups& groups,
                          const std::vector<std::uint32_t>& leaves, NodeReferences& references,
                          System& system, Model& model) {
  ImportTable imports(parts.senders.tree.nodes.size());
  for (const RowGroup* group : {&groups.clusters, &groups.lumels, &groups.sensors})
    visit_tiles(*group, leaves, [&](const CutTile& tile) { imports.use(tile); });
  system.imports = imports.finish(parts.senders.tree, references, model);
  if (system.imports.size() > kMaxImports) {
    return fail(ErrorCode::usage,
                fmt::format("system {} sees {} clusters, nodes and sky patches, more than the {} that its "
                            "columns can name; choose a larger cluster size",
                            system.name, system.imports.size(), kMaxImports));
  }
  const auto columns = std::uint32_t(system.imports.size());
  const bool shared = !parts.tiles.empty();
  BlockMatrixBuilder bounce(columns, codec), gather(columns, codec);
  tbb::parallel_invoke(
      [&] {
        visit_tiles(groups.clusters, leaves,
                    [&](const CutTile& tile) { append(imports, tile, shared, bounce); });
      },
      [&] {
        visit_tiles(groups.lumels, leaves,
                    [&](const CutTile& tile) { append(imports, tile, shared, gather); });
        visit_tiles(groups.sensors, leaves,
                    [&](const CutTile& tile) { append(imports, tile, false, gather); });
      });
  system.bounce = std::move(bounce).finish();
  system.gather = std::move(gather).finish();
  return {};
}

}  // namespace

Result<void> store_matrices(const ModelParts& parts, ValueCodec codec, Model& model) {
  const std::vector<std::uint32_t> leaves = leaf_nodes(parts.senders);
  NodeReferences references(parts);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const SystemRowGroups groups = row_groups(parts, s);
    if (auto stored = store_system(parts, codec, groups, leaves, references, model.systems[s], model);
        !stored)
      return stored;
  }
  return {};
}

}  // namespace relume
