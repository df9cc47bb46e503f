// SPDX-License-Identifier: MIT
#include "precompute/trace_rows.h"

#include "precompute/assemble_model.h"

namespace relume {
namespace {

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
  tiles.clusters = cut_clusters(senders, system, rows, plan.node_cuts);
  rows.clusters = {};
  return tiles;
}

Result<void> trace_systems(const RowScene& scene, const Surfaces& surfaces,
                           const std::optional<CutSenders>& senders, const RowPlan& plan, RowCounts& counts,
                           const ProgressObserver& observer, TracedRows& rows) {
  for (std::size_t s = 0; s < surfaces.systems.size(); ++s) {
    rows.orders.push_back(stored_order(surfaces.systems[s]));
    const TracedSystem system{surfaces.charts, surfaces.systems[s], surfaces.own_elements[s]};
    if (!senders) {
      auto traced = trace_system(scene, system, plan.lumels, plan.node_quality, counts, observer);
      if (!traced) return tl::unexpected(traced.error());
      rows.systems.push_back(std::move(*traced));
      continue;
    }
    auto tiles = trace_and_cut(scene, system, *senders, plan, counts, observer, rows.orders[s],
                               rows.systems.emplace_back());
    if (!tiles) return tl::unexpected(tiles.error());
    rows.tiles.push_back(std::move(*tiles));
  }
  return {};
}

Result<ProbeRows> trace_light_probes(const RowScene& scene, const SenderTree& senders, std::size_t systems,
                                     std::span<const ProbePoint> points, const RowPlan& plan,
                                     RowCounts& counts, const ProgressObserver& observer) {
  auto traced = trace_probes(scene, points, plan.probe_rays, counts, observer);
  if (!traced) return tl::unexpected(traced.error());
  ProbeRows probes{{points.begin(), points.end()}, std::move(*traced), {}};
  std::vector<FormFactorRow> seen(points.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (const SeenSender& sender : probes.rows[i].senders) {
      seen[i].senders.push_back(sender.sender);
      seen[i].values.push_back(sender.solid_angle);
    }
  }
  probes.systems = systems_of_sensors(senders, systems, seen);
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
    cut.emplace(CutSenders{senders.tree, *probing, &*rows.flux});
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
      trace_light_probes(scene, senders, surfaces.systems.size(), probes, plan, counts, observer);
  if (!probe_rows) return tl::unexpected(probe_rows.error());
  rows.probes = std::move(*probe_rows);
  return rows;
}

}  // namespace relume
