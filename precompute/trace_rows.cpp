// SPDX-License-Identifier: MIT
#include "precompute/trace_rows.h"

#include <algorithm>

#include "core/quantities.h"
#include "precompute/assemble_model.h"
#include "precompute/sphere_tracer.h"

namespace relume {
namespace {

void cut_rows_of_clusters(const CutSenders& senders, const TracedSystem& system, const RowPlan& plan,
                          SystemRows& rows, SystemTiles& tiles) {
  tiles.clusters = cut_clusters(senders, system, rows, plan.node_cuts);
  rows.clusters = {};
}

Result<SystemTiles> trace_and_cut(const RowScene& scene, const TracedSystem& system,
                                  const CutSenders& senders, const RowPlan& plan, RowCounts& counts,
                                  const ProgressObserver& observer, const std::vector<std::uint32_t>& order,
                                  SystemRows& rows) {
  LumelCutter cutter(senders, system, order, plan.node_cuts);
  auto traced = trace_system(scene, system, plan.lumels, plan.node_quality, counts, observer,
                             [&](std::uint32_t last, SystemRows& batch) { cutter.take(last, batch); });
  if (!traced) return tl::unexpected(traced.error());
  rows = std::move(*traced);
  SystemTiles tiles;
  tiles.lumels = cutter.finish(rows);
  if (!plan.reciprocal) cut_rows_of_clusters(senders, system, plan, rows, tiles);
  return tiles;
}

/// The rows of all clusters of all systems, projected together.
Result<Projection> project_clusters(const Surfaces& surfaces, std::vector<SystemRows>& systems) {
  std::vector<ProjectedRow> rows;
  for (std::size_t s = 0; s < systems.size(); ++s) {
    const ClusteredSurface& surface = surfaces.systems[s];
    const std::size_t first = rows.size();
    for (FormFactorRow& row : systems[s].clusters) rows.push_back({&row});
    for (std::size_t e = 0; e < surface.cluster.size(); ++e) {
      ProjectedRow& row = rows[first + surface.cluster[e]];
      row.area += surface.surface.elements[e].area;
      row.rays += systems[s].element_rays[e].count;
    }
  }
  return project_to_reciprocity(rows);
}

Result<void> trace_systems(const RowScene& scene, const Surfaces& surfaces,
                           const std::optional<CutSenders>& senders, const RowPlan& plan, RowCounts& counts,
                           const ProgressObserver& observer, TracedRows& rows) {
  StoreChoice store;
  if (!senders && sender_count(scene) <= kMaxImports) {
    store.elements = plan.codec;
    if (!plan.reciprocal) store.clusters = plan.codec;
  }
  for (std::size_t s = 0; s < surfaces.systems.size(); ++s) {
    rows.orders.push_back(stored_order(surfaces.systems[s]));
    const TracedSystem system{surfaces.charts, surfaces.systems[s], surfaces.own_elements[s]};
    if (!senders) {
      auto traced = trace_system(scene, system, plan.lumels, plan.node_quality, counts, observer, {}, store);
      if (!traced) return tl::unexpected(traced.error());
      rows.systems.push_back(std::move(*traced));
      continue;
    }
    auto tiles = trace_and_cut(scene, system, *senders, plan, counts, observer, rows.orders[s],
                               rows.systems.emplace_back());
    if (!tiles) return tl::unexpected(tiles.error());
    rows.tiles.push_back(std::move(*tiles));
  }
  if (!plan.reciprocal) return {};
  auto projected = project_clusters(surfaces, rows.systems);
  if (!projected) return tl::unexpected(projected.error());
  rows.projection = *projected;
  for (std::size_t s = 0; senders && s < surfaces.systems.size(); ++s) {
    const TracedSystem system{surfaces.charts, surfaces.systems[s], surfaces.own_elements[s]};
    cut_rows_of_clusters(*senders, system, plan, rows.systems[s], rows.tiles[s]);
  }
  return {};
}

/// Nodes of a probe where rows are not cut, but a survey is there to cut them by.
constexpr std::uint32_t kProbeBudget = 256;

/// The row of a probe as one of form factors, for a plane that faces all that it sees by half.
std::vector<FormFactorRow> half_facing_rows(std::span<const ProbeRow> probes) {
  std::vector<FormFactorRow> rows(probes.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const SeenSender& seen : probes[i].senders) {
      const auto factor = float(double(seen.solid_angle) / (2.0 * kPi));
      if (!rows[i].senders.empty() && rows[i].senders.back() == seen.sender) {
        rows[i].values.back() += factor;
        continue;
      }
      rows[i].senders.push_back(seen.sender);
      rows[i].values.push_back(factor);
    }
  }
  return rows;
}

/// In place of senders, the nodes that `tiles` keep, or their leaves.
void put_nodes(const ClusterTree& tree, const std::vector<CutTile>& tiles, std::vector<ProbeRow>& rows) {
  std::vector<std::uint32_t> node_of(tree.nodes.size());
  const auto put = [&](std::uint32_t node) {
    const TreeNodeRange& range = tree.nodes[node];
    for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) node_of[leaf] = node;
  };
  if (tiles.empty()) {
    for (std::uint32_t node = 0; node < tree.nodes.size(); ++node) {
      if (tree.nodes[node].count == 1) put(node);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!tiles.empty()) std::for_each(tiles[i].nodes.begin(), tiles[i].nodes.end(), put);
    for (SeenSender& seen : rows[i].senders) seen.sender = node_of[seen.sender];
    rows[i].senders = unite_senders(std::move(rows[i].senders));
  }
}

Result<ProbeRows> trace_light_probes(const RowScene& scene, const SenderTree& senders, std::size_t systems,
                                     std::span<const ProbePoint> points, const Probing* probing,
                                     const RowPlan& plan, RowCounts& counts,
                                     const ProgressObserver& observer) {
  auto traced = trace_probes(scene, points, plan.probe_rays, counts, observer);
  if (!traced) return tl::unexpected(traced.error());
  ProbeRows probes{{points.begin(), points.end()}, std::move(*traced), {}};
  const std::vector<FormFactorRow> seen = half_facing_rows(probes.rows);
  probes.systems = systems_of_sensors(senders, systems, seen);
  std::vector<CutTile> tiles;
  if (probing != nullptr) {
    std::vector<CutRow> rows;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const glm::vec3 position(points[i].position - scene.geometry.origin);
      rows.push_back({&seen[i], float(plan.probe_rays), 0.0f, {position, glm::vec3(0.0f)}});
    }
    const CutLimits limits = plan.cut ? plan.sensor_cut : CutLimits{kProbeBudget, 0.0};
    tiles = cut_rows({senders.tree, *probing}, rows, {1, {&limits, 1}});
  }
  put_nodes(senders.tree, tiles, probes.rows);
  return probes;
}

}  // namespace

Result<TracedRows> trace_rows(const RowScene& scene, const Surfaces& surfaces, const SenderTree& senders,
                              std::span<const SurfacePoint> sensors, std::span<const ProbePoint> probes,
                              const RowPlan& plan, const Probing* probing, RowCounts& counts,
                              const ProgressObserver& observer) {
  TracedRows rows;
  std::optional<CutSenders> cut;
  if (plan.cut) {
    rows.flux.emplace(senders.tree, double(surfaces.geometry.area));
    cut.emplace(CutSenders{senders.tree, *probing, &*rows.flux, plan.bounds ? &senders.places : nullptr});
  }
  if (auto traced = trace_systems(scene, surfaces, cut, plan, counts, observer, rows); !traced)
    return tl::unexpected(traced.error());
  auto sensor_rows = trace_sensors(scene, sensors, plan.sensors, counts, observer);
  if (!sensor_rows) return tl::unexpected(sensor_rows.error());
  rows.sensors = std::move(*sensor_rows);
  rows.sensor_systems = systems_of_sensors(senders, surfaces.systems.size(), rows.sensors.rows);
  for (std::uint32_t s = 0; s < rows.tiles.size(); ++s) {
    std::vector<CutRow> own;
    for (std::size_t i = 0; i < rows.sensors.rows.size(); ++i) {
      if (rows.sensor_systems[i] != s) continue;
      own.push_back({&rows.sensors.rows[i], float(rows.sensors.rays[i].count), 0.0f, sensors[i]});
    }
    rows.tiles[s].sensors = cut_rows(*cut, own, {1, {&plan.sensor_cut, 1}});
  }
  auto probe_rows =
      trace_light_probes(scene, senders, surfaces.systems.size(), probes, probing, plan, counts, observer);
  if (!probe_rows) return tl::unexpected(probe_rows.error());
  rows.probes = std::move(*probe_rows);
  return rows;
}

}  // namespace relume
