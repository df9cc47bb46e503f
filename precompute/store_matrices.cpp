// SPDX-License-Identifier: MIT
#include "precompute/store_matrices.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <span>
#include <tuple>

#include "core/quantities.h"
#include "precompute/coarsen_imports.h"
#include "precompute/node_references.h"

namespace relume {
namespace {

/// Rows that follow each other in a matrix, stored already or not, or their tiles.
struct RowGroup {
  std::vector<const FormFactorRow*> rows;
  std::vector<const StoredRow*> stored;
  const std::vector<CutTile>* tiles = nullptr;
};

/// All rows of a system.
struct SystemRowGroups {
  RowGroup clusters, lumels, sensors;
  std::vector<std::uint32_t> probes;  ///< indices into ModelParts::probes
};

SystemRowGroups row_groups(const ModelParts& parts, std::size_t s) {
  SystemRowGroups groups;
  for (std::uint32_t i = 0; i < parts.probes.rows.size(); ++i) {
    if (parts.probes.systems[i] == s) groups.probes.push_back(i);
  }
  if (!parts.tiles.empty()) {
    const SystemTiles& tiles = parts.tiles[s];
    groups.clusters.tiles = &tiles.clusters, groups.lumels.tiles = &tiles.lumels;
    groups.sensors.tiles = &tiles.sensors;
    return groups;
  }
  const SystemRows& rows = parts.rows[s];
  for (const FormFactorRow& row : rows.clusters) groups.clusters.rows.push_back(&row);
  for (const StoredRow& row : rows.stored_clusters) groups.clusters.stored.push_back(&row);
  for (const auto e : parts.element_orders[s]) {
    if (!parts.own_elements[s][e]) continue;
    if (rows.stored_elements.empty()) groups.lumels.rows.push_back(&rows.elements[e]);
    if (!rows.stored_elements.empty()) groups.lumels.stored.push_back(&rows.stored_elements[e]);
  }
  for (std::size_t i = 0; i < parts.sensors.rows.size(); ++i) {
    if (parts.sensor_systems[i] == s) groups.sensors.rows.push_back(&parts.sensors.rows[i]);
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

/// Rows as tiles of their leaves.
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
    tile.moments.clear();
    if (!row->moments.empty()) tile.moments.push_back(row->moments);
    visit(tile);
  }
}

/// The nodes that some tiles of a system keep, as an import table, and the local column of each.
class ImportTable {
 public:
  explicit ImportTable(std::size_t nodes) : column_(nodes, kNone) {}
  void use(const CutTile& tile) {
    for (const auto node : tile.nodes) column_[node] = 0;
  }
  void use(std::uint32_t node) { column_[node] = 0; }
  void use(const RowGroup& group, const std::vector<std::uint32_t>& leaves) {
    if (group.tiles != nullptr) {
      for (const CutTile& tile : *group.tiles) use(tile);
    }
    std::vector<std::uint8_t> seen(leaves.size(), 0);
    for (const FormFactorRow* row : group.rows) {
      for (const auto sender : row->senders) seen[sender] = 1;
    }
    for (std::size_t sender = 0; sender < seen.size(); ++sender) {
      if (seen[sender] != 0) use(leaves[sender]);
    }
  }
  void use(const RowStore& store, const std::vector<std::uint32_t>& leaves) {
    for (std::size_t sender = 0; sender < leaves.size(); ++sender) {
      if (store.seen()[sender] != 0) use(leaves[sender]);
    }
  }
  std::size_t count() const {
    return column_.size() - std::size_t(std::count(column_.begin(), column_.end(), kNone));
  }
  /// From now on coarser nodes stand for those that were used.
  void coarsen(CoarserImports coarser) {
    std::vector<std::uint32_t> columns(column_.size(), kNone);
    for (std::uint32_t n = 0; n < column_.size(); ++n) {
      if (column_[n] != kNone) columns[coarser.node[n]] = 0;
    }
    column_ = std::move(columns);
    stands_for_ = std::move(coarser.node);
  }
  /// The tile with the nodes that are left, values added up.
  CutTile coarsened(const CutTile& tile) const {
    CutTile result;
    result.values.resize(tile.values.size());
    result.moments.resize(tile.moments.size());
    for (std::size_t i = 0; i < tile.nodes.size(); ++i) {
      const std::uint32_t node = stands_for_[tile.nodes[i]];
      const bool same = !result.nodes.empty() && result.nodes.back() == node;
      if (!same) result.nodes.push_back(node);
      for (std::size_t r = 0; r < tile.values.size(); ++r) {
        if (!same) result.values[r].push_back(0.0f);
        result.values[r].back() += tile.values[r][i];
      }
      for (std::size_t r = 0; r < tile.moments.size(); ++r) {
        if (!same) result.moments[r].emplace_back(0.0f);
        result.moments[r].back() += tile.moments[r][i];
      }
    }
    return result;
  }
  bool is_coarsened() const { return !stands_for_.empty(); }
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
  /// After finish(), of what stands for a node.
  std::uint32_t column(std::uint32_t node) const {
    return column_[is_coarsened() ? stands_for_[node] : node];
  }
  void columns(const CutTile& tile, std::vector<std::uint16_t>& columns) const {
    columns.resize(tile.nodes.size());
    std::transform(tile.nodes.begin(), tile.nodes.end(), columns.begin(),
                   [&](std::uint32_t node) { return std::uint16_t(column_[node]); });
  }

 private:
  std::vector<std::uint32_t> column_;
  std::vector<std::uint32_t> stands_for_;  ///< per node, empty: each for itself
};

/// Appends tiles, or rows, to a matrix.
class Appender {
 public:
  Appender(const ImportTable& imports, const std::vector<std::uint32_t>& leaves, bool shared,
           BlockMatrixBuilder& matrix, HalvingList& halvings)
      : imports_(imports), leaves_(leaves), shared_(shared), matrix_(matrix), halvings_(halvings) {}

  void append(const RowGroup& group) {
    if (group.tiles == nullptr && !imports_.is_coarsened()) {
      append_rows(group);
      return;
    }
    visit_tiles(group, leaves_, [&](const CutTile& tile) {
      if (imports_.is_coarsened()) {
        append(imports_.coarsened(tile));
      } else {
        append(tile);
        halvings_.append(tile.halvings);
      }
    });
  }

 private:
  void append(const CutTile& tile) {
    imports_.columns(tile, columns_);
    values_.clear();
    for (const auto& row : tile.values) values_.insert(values_.end(), row.begin(), row.end());
    directions_.clear();
    for (std::size_t r = 0; r < tile.moments.size(); ++r)
      pack_directions(tile.values[r], tile.moments[r], directions_);
    if (shared_) {
      matrix_.append_tile(columns_, values_, std::uint32_t(tile.values.size()), directions_);
    } else {
      matrix_.append_row(columns_, values_, directions_);
    }
  }

  void append_rows(const RowGroup& group) {
    std::vector<std::uint16_t> column_of(leaves_.size());
    for (std::size_t sender = 0; sender < leaves_.size(); ++sender)
      column_of[sender] = std::uint16_t(imports_.column(leaves_[sender]));
    for (const StoredRow* row : group.stored) matrix_.append_stored(*row, column_of);
    for (const FormFactorRow* row : group.rows) {
      columns_.resize(row->senders.size());
      std::transform(row->senders.begin(), row->senders.end(), columns_.begin(),
                     [&](std::uint32_t sender) { return column_of[sender]; });
      directions_.clear();
      pack_directions(row->values, row->moments, directions_);
      matrix_.append_row(columns_, row->values, directions_);
    }
  }

  const ImportTable& imports_;
  const std::vector<std::uint32_t>& leaves_;
  bool shared_;
  BlockMatrixBuilder& matrix_;
  HalvingList& halvings_;  ///< of the matrix; none where rows see coarser nodes than they were cut to
  std::vector<std::uint16_t> columns_;  // their memory serves again
  std::vector<double> values_;
  std::vector<std::uint32_t> directions_;
};

std::size_t entry_count(const RowGroup& group) {
  std::size_t entries = 0;
  for (const FormFactorRow* row : group.rows) entries += row->senders.size();
  for (const StoredRow* row : group.stored) entries += row->columns.size();
  if (group.tiles == nullptr) return entries;
  for (const CutTile& tile : *group.tiles) entries += tile.nodes.size();
  return entries;
}

/// Joins what the rows of the system see least until its columns can name the rest.
void coarsen(const ModelParts& parts, const SystemRowGroups& groups, const std::vector<std::uint32_t>& leaves,
             const std::string& name, ImportTable& imports, PrecomputeReport& report) {
  std::vector<double> weight(parts.senders.tree.nodes.size(), -1.0);
  const auto add = [&](const CutTile& tile) {
    for (std::size_t i = 0; i < tile.nodes.size(); ++i) {
      double& sum = weight[tile.nodes[i]];
      sum = std::max(sum, 0.0);
      for (const auto& row : tile.values) sum += row[i];
    }
  };
  for (const RowGroup* group : {&groups.clusters, &groups.lumels, &groups.sensors})
    visit_tiles(*group, leaves, add);
  for (const auto p : groups.probes) {
    for (const SeenSender& seen : parts.probes.rows[p].senders) {
      double& sum = weight[seen.sender];
      sum = std::max(sum, 0.0) + double(seen.solid_angle) / kPi;
    }
  }
  const std::size_t before = imports.count();
  CoarserImports coarser = coarsen_imports(parts.senders.tree, weight, kMaxImports);
  report.warnings.push_back(
      fmt::format("system {} sees {} senders, more than the {} that its columns can name: those that it sees "
                  "least, {:.2g} % of "
                  "its form factors, were joined to nodes of the cluster trees",
                  name, before, kMaxImports, 100.0 * coarser.coarsened_share));
  imports.coarsen(std::move(coarser));
}

/// After the imports are finished.
void store_probes(const ModelParts& parts, const std::vector<std::uint32_t>& probes,
                  const ImportTable& imports, System& system) {
  for (const auto p : probes) {
    const ProbeRow& row = parts.probes.rows[p];
    system.probes.push_back({parts.probes.points[p].position, p,
                             row.back_face_share > kInvalidProbeShare ? std::uint32_t{kProbeInvalid} : 0u,
                             std::uint32_t(system.probe_senders.size()), std::uint32_t(row.senders.size())});
    for (const SeenSender& seen : row.senders)
      system.probe_senders.push_back({imports.column(seen.sender), seen.solid_angle, seen.direction});
    std::stable_sort(system.probe_senders.end() - std::ptrdiff_t(row.senders.size()),
                     system.probe_senders.end(),
                     [](const ProbeSender& a, const ProbeSender& b) { return a.column < b.column; });
  }
}

Result<void> store_system(const ModelParts& parts, ValueCodec codec, const SystemRowGroups& groups,
                          const std::vector<RowStore>& stores, const std::vector<std::uint32_t>& leaves,
                          NodeReferences& references, System& system, Model& model,
                          PrecomputeReport& report) {
  ImportTable imports(parts.senders.tree.nodes.size());
  for (const RowGroup* group : {&groups.clusters, &groups.lumels, &groups.sensors})
    imports.use(*group, leaves);
  for (const RowStore& store : stores) imports.use(store, leaves);
  for (const auto p : groups.probes) {
    for (const SeenSender& seen : parts.probes.rows[p].senders) imports.use(seen.sender);
  }
  if (imports.count() > kMaxImports) coarsen(parts, groups, leaves, system.name, imports, report);
  system.imports = imports.finish(parts.senders.tree, references, model);
  if (system.imports.size() > kMaxImports) {
    return fail(ErrorCode::usage,
                fmt::format("system {} sees {} clusters, nodes and sky patches, more than the {} that its "
                            "columns can name; choose a larger cluster size",
                            system.name, system.imports.size(), kMaxImports));
  }
  store_probes(parts, groups.probes, imports, system);
  const auto columns = std::uint32_t(system.imports.size());
  const bool shared = !parts.tiles.empty();
  BlockMatrixBuilder bounce(columns, codec, kMaxBlockBytes, entry_count(groups.clusters)),
      gather(columns, codec, kMaxBlockBytes, entry_count(groups.lumels) + entry_count(groups.sensors));
  HalvingList bounce_halvings, gather_halvings;
  tbb::parallel_invoke(
      [&] { Appender(imports, leaves, shared, bounce, bounce_halvings).append(groups.clusters); },
      [&] {
        Appender(imports, leaves, shared, gather, gather_halvings).append(groups.lumels);
        Appender(imports, leaves, false, gather, gather_halvings).append(groups.sensors);
      });
  system.bounce_halvings = bounce_halvings.bytes(), system.gather_halvings = gather_halvings.bytes();
  system.bounce = std::move(bounce).finish();
  system.gather = std::move(gather).finish();
  return {};
}

}  // namespace

Result<void> store_matrices(const ModelParts& parts, ValueCodec codec, Model& model,
                            PrecomputeReport& report) {
  const std::vector<std::uint32_t> leaves = leaf_nodes(parts.senders);
  NodeReferences references(parts.senders, parts.flux);
  for (const ProbePoint& point : parts.probes.points) model.probe_names.push_back(point.name);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const SystemRowGroups groups = row_groups(parts, s);
    if (auto stored = store_system(parts, codec, groups, parts.rows[s].stores, leaves, references,
                                   model.systems[s], model, report);
        !stored)
      return stored;
  }
  return {};
}

}  // namespace relume
