// SPDX-License-Identifier: MIT
#include "precompute/store_matrices.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <functional>
#include <tuple>

#include "precompute/cut_rows.h"

namespace relume {
namespace {

constexpr std::uint32_t kTileRows = 8;
constexpr std::uint32_t kSensorShare = 4;  ///< budget of a sensor, which shares its nodes with no other row

/// Rows that follow each other in a matrix, and their tiles; without a budget there are none, and every row
/// is a tile of its leaves.
struct RowGroup {
  std::vector<const FormFactorRow*> rows;
  std::vector<std::uint32_t> budgets;  ///< per row; 0: no limit
  std::vector<CutTile> tiles;
};

/// All rows of a system.
struct SystemRowGroups {
  RowGroup clusters, lumels, sensors;
};

/// Per node of the scene: what its rows may keep.
std::vector<std::uint32_t> node_budgets(const Scene& scene, std::uint32_t budget) {
  std::vector<std::uint32_t> budgets;
  for (const SceneNode& node : scene.nodes) budgets.push_back(node.extras.budget.value_or(budget));
  return budgets;
}

SystemRowGroups row_groups(const ModelParts& parts, std::size_t s, const std::vector<std::uint32_t>& order,
                           const System& system, const std::vector<std::uint32_t>& budgets) {
  SystemRowGroups groups;
  for (const FormFactorRow& row : parts.rows[s].clusters) groups.clusters.rows.push_back(&row);
  for (const Cluster& cluster : system.clusters) groups.clusters.budgets.push_back(budgets[cluster.node]);
  for (const auto e : order) {
    if (!parts.own_elements[s][e]) continue;
    groups.lumels.rows.push_back(&parts.rows[s].elements[e]);
    groups.lumels.budgets.push_back(budgets[parts.charts[parts.surfaces[s].surface.elements[e].chart].node]);
  }
  // Sensors go to the first system: only there are their rows needed.
  if (s == 0) {
    for (const FormFactorRow& row : parts.sensor_rows) groups.sensors.rows.push_back(&row);
  }
  return groups;
}

void cut_groups(const ModelParts& parts, const PrecomputeOptions& options, SystemRowGroups& groups) {
  const std::size_t lumels = groups.lumels.rows.size();
  const std::size_t clusters = std::max<std::size_t>(groups.clusters.rows.size(), 1);
  const auto cluster_rays =
      std::uint32_t(double(options.quality) * std::max<double>(1.0, double(lumels) / double(clusters)));
  const std::uint32_t sensor_rays = options.sensor_quality > 0 ? options.sensor_quality : options.quality;
  groups.clusters.tiles =
      cut_rows(parts.senders, groups.clusters.rows, {kTileRows, 0, cluster_rays, groups.clusters.budgets});
  groups.lumels.tiles =
      cut_rows(parts.senders, groups.lumels.rows, {kTileRows, 0, options.quality, groups.lumels.budgets});
  groups.sensors.tiles =
      cut_rows(parts.senders, groups.sensors.rows, {1, kSensorShare * options.budget, sensor_rays});
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
  for (const CutTile& tile : group.tiles) visit(tile);
  if (!group.tiles.empty()) return;
  for (const FormFactorRow* row : group.rows) {
    CutTile tile;
    for (const auto sender : row->senders) tile.nodes.push_back(leaves[sender]);
    tile.values.push_back(row->values);
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
    std::vector<std::uint16_t> columns;
    for (const auto node : tile.nodes) columns.push_back(std::uint16_t(column_[node]));
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

double mean_spread(const RowGroup& group) {
  double sum = 0.0;
  for (const CutTile& tile : group.tiles) sum += tile.spread;
  return group.tiles.empty() ? 0.0 : sum / double(group.tiles.size());
}

Result<void> store_system(const ModelParts& parts, const PrecomputeOptions& options, bool shared,
                          const SystemRowGroups& groups, const std::vector<std::uint32_t>& leaves,
                          NodeReferences& references, System& system, Model& model) {
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
  BlockMatrixBuilder bounce(columns, options.codec), gather(columns, options.codec);
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

Result<void> store_matrices(const ModelParts& parts, const PrecomputeOptions& options,
                            const std::vector<std::vector<std::uint32_t>>& element_orders, Model& model,
                            PrecomputeReport& report) {
  const std::vector<std::uint32_t> leaves = leaf_nodes(parts.senders);
  NodeReferences references(parts);
  const std::vector<std::uint32_t> budgets = node_budgets(parts.scene, options.budget);
  const bool cut = std::any_of(budgets.begin(), budgets.end(), [](std::uint32_t b) { return b > 0; });
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    SystemRowGroups groups = row_groups(parts, s, element_orders[s], model.systems[s], budgets);
    if (cut) cut_groups(parts, options, groups);
    if (auto stored = store_system(parts, options, cut, groups, leaves, references, model.systems[s], model);
        !stored)
      return stored;
    report.cut_spread = std::max(report.cut_spread, mean_spread(groups.lumels));
  }
  return {};
}

}  // namespace relume
