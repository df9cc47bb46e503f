// SPDX-License-Identifier: MIT
#include "precompute/rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "precompute/progress.h"
#include "precompute/sender_set.h"

namespace relume {
namespace {

/// Area-weighted mean of rows, gathered densely.
class RowMean {
 public:
  explicit RowMean(std::size_t senders) : sums_(senders, 0.0), touched_(senders) {}
  void add(const FormFactorRow& row, double weight) {
    weight_ += weight;
    for (std::size_t i = 0; i < row.senders.size(); ++i) {
      sums_[row.senders[i]] += weight * double(row.values[i]);
      touched_.insert(row.senders[i]);
    }
  }
  FormFactorRow finish() {
    FormFactorRow row;
    row.senders.reserve(touched_.size());
    row.values.reserve(touched_.size());
    touched_.drain([&](std::uint32_t sender) {
      row.senders.push_back(sender);
      row.values.push_back(float(sums_[sender] / weight_));
      sums_[sender] = 0.0;
    });
    weight_ = 0.0;
    return row;
  }

 private:
  std::vector<double> sums_;
  SenderSet touched_;
  double weight_ = 0.0;
};

struct Worker {
  explicit Worker(const RowScene& scene)
      : tracer(scene), mean(scene.cluster_count + 6 * scene.sky_resolution * scene.sky_resolution) {}
  RowTracer tracer;
  RowMean mean;
};
using Workers = tbb::enumerable_thread_specific<Worker>;

void add_counts(const Workers& workers, RowCounts& counts) {
  for (const Worker& worker : workers) {
    counts.rays += worker.tracer.rays();
    counts.occlusion_rays += worker.tracer.occlusion_rays();
  }
}

/// Row of one cluster, and those of its elements.
void trace_cluster(const RowScene& scene, const std::vector<Chart>& charts, const ClusteredSurface& system,
                   std::span<const std::uint32_t> members, const std::vector<bool>& own_element,
                   const SobolPoints& points, Worker& worker, FormFactorRow& cluster_row, SystemRows& rows) {
  std::vector<TracedRow> traced;
  bool any_valid = false;
  for (const auto e : members) {
    const Element& element = system.surface.elements[e];
    traced.push_back(worker.tracer.trace(
        Receiver::element(scene.geometry, scene.caster, system.surface, element, charts[element.chart].side),
        points));
    rows.element_back_face_share[e] = traced.back().back_face_share;
    any_valid = any_valid || traced.back().back_face_share <= kInvalidShare;
  }
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (any_valid && traced[i].back_face_share > kInvalidShare) continue;
    worker.mean.add(traced[i].row, system.surface.elements[members[i]].area);
  }
  cluster_row = worker.mean.finish();
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (own_element[members[i]]) rows.elements[members[i]] = std::move(traced[i].row);
  }
}

/// As many points as each node has rays.
class NodePoints {
 public:
  explicit NodePoints(const RowOptions& options) : options_(options) {
    points_.try_emplace(options.quality, options.quality);
    for (const auto quality : options.node_quality) points_.try_emplace(quality, quality);
  }
  const SobolPoints& of(std::uint32_t node) const {
    return points_.at(options_.node_quality.empty() ? options_.quality : options_.node_quality[node]);
  }

 private:
  const RowOptions& options_;
  std::map<std::uint32_t, SobolPoints> points_;  ///< by number of rays
};

/// Elements of each cluster, ascending.
std::vector<std::vector<std::uint32_t>> members_of_clusters(const ClusteredSurface& system) {
  std::vector<std::vector<std::uint32_t>> members(system.cluster_count);
  for (std::uint32_t e = 0; e < system.cluster.size(); ++e) members[system.cluster[e]].push_back(e);
  return members;
}

}  // namespace

Result<SystemRows> trace_system(const RowScene& scene, const std::vector<Chart>& charts,
                                const ClusteredSurface& system, const std::vector<bool>& own_element,
                                const RowOptions& options, RowCounts& counts,
                                const ProgressObserver& observer) {
  SystemRows rows;
  rows.clusters.resize(system.cluster_count);
  rows.elements.resize(system.surface.elements.size());
  rows.element_back_face_share.resize(system.surface.elements.size());
  const auto members = members_of_clusters(system);
  const NodePoints points(options);
  Workers workers([&] { return Worker(scene); });
  Progress progress(observer, "rays", system.cluster_count);
  tbb::parallel_for(std::uint32_t{0}, system.cluster_count, [&](std::uint32_t c) {
    if (progress.cancelled()) return;
    const std::uint32_t node = charts[system.surface.elements[members[c][0]].chart].node;
    trace_cluster(scene, charts, system, members[c], own_element, points.of(node), workers.local(),
                  rows.clusters[c], rows);
    progress.one_done();
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while tracing rays");
  add_counts(workers, counts);
  return rows;
}

Result<std::vector<FormFactorRow>> trace_sensors(const RowScene& scene, std::span<const SurfacePoint> points,
                                                 const RowOptions& options, RowCounts& counts,
                                                 const ProgressObserver& observer) {
  std::vector<FormFactorRow> rows(points.size());
  const SobolPoints samples(points.empty() ? 0 : options.sensor_quality);
  Workers workers([&] { return Worker(scene); });
  Progress progress(observer, "sensors", points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (progress.cancelled()) return;
    rows[i] = workers.local().tracer.trace(Receiver::point(points[i]), samples).row;
    progress.one_done();
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while tracing the rays of sensors");
  add_counts(workers, counts);
  return rows;
}

}  // namespace relume
