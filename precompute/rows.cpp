// SPDX-License-Identifier: MIT
#include "precompute/rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>

#include "core/quantities.h"
#include "precompute/adaptive_row.h"
#include "precompute/progress.h"

namespace relume {
namespace {

/// Rays of a cluster in a survey, and the least that one of its elements gets.
constexpr std::uint32_t kSurveyRays = 512, kSurveyElementRays = 32;

struct Worker {
  explicit Worker(const RowScene& scene)
      : emitters(scene.emitters), tracer(scene), mean(sender_count(scene)), store(sender_count(scene)) {}
  const Emitters& emitters;
  RowTracer tracer;
  RowMean mean;
  RowStore store;
  std::uint64_t cluster_entries = 0, element_entries = 0;
};
using Workers = tbb::enumerable_thread_specific<Worker>;

void add_counts(const Workers& workers, RowCounts& counts) {
  for (const Worker& worker : workers) {
    add_rays(worker.tracer, counts);
    counts.cluster_entries += worker.cluster_entries;
    counts.element_entries += worker.element_entries;
  }
}

TracedRow mean_of(const RowHalves& halves, RowMean& mean) {
  mean.add(halves.first.row, 0.5);
  mean.add(halves.second.row, 0.5);
  return {mean.finish(), 0.5f * (halves.first.back_face_share + halves.second.back_face_share)};
}

/// So many points are traced at once, to begin with.
std::uint32_t first_stage(const RayLimits& limits) {
  return limits.exchange > 0.0 ? limits.least / 2 : limits.rays;
}

/// What the noise of receivers counts; points count as elements of average area.
double area_weight(std::span<const Receiver> receivers, const RayLimits& limits) {
  double sum = 0.0;
  for (const Receiver& receiver : receivers) {
    const double area = kPi * double(receiver.radius()) * double(receiver.radius());
    sum += area > 0.0 ? area / limits.area : 1.0;
  }
  return sum / double(receivers.size());
}

/// Rows of receivers that lie side by side, with as many rays each as all of them together ask for.
std::vector<TracedRow> trace_neighbours(std::span<const Receiver> receivers, const SobolPoints& points,
                                        const RayLimits& limits, Worker& worker, RowRays& rays) {
  std::vector<TracedRow> rows;
  rays = {limits.rays};
  worker.tracer.expect(receivers);
  if (limits.exchange <= 0.0) {
    for (const Receiver& receiver : receivers)
      rows.push_back(worker.tracer.trace(receiver, points, {0, limits.rays}));
    return rows;
  }
  std::vector<RowHalves> halves;
  rays.count = std::min(limits.least, limits.rays);
  for (const Receiver& receiver : receivers) {
    halves.push_back({worker.tracer.trace(receiver, points, {0, rays.count / 2}),
                      worker.tracer.trace(receiver, points, {rays.count / 2, rays.count / 2})});
  }
  rays.noise = float(row_noise(*limits.probing, halves));
  const double weight = area_weight(receivers, limits);
  const auto worth_more = [&] {
    return weight * double(rays.noise) * double(rays.noise) > limits.exchange * double(rays.count);
  };
  while (worth_more() && 2 * rays.count <= limits.rays) {
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      halves[i].first = mean_of(halves[i], worker.mean);
      halves[i].second = worker.tracer.trace(receivers[i], points, {rays.count, rays.count});
    }
    rays.count *= 2;
    rays.noise = float(row_noise(*limits.probing, halves));
  }
  rays.variance = variance_shares(*limits.probing, worker.emitters, halves, rays.count);
  for (const RowHalves& both : halves) rows.push_back(mean_of(both, worker.mean));
  return rows;
}

/// Area-weighted mean of the rows of the members that do not lie inside other geometry, or of all when all
/// do.
FormFactorRow cluster_row(const SystemSurface& surface, std::span<const std::uint32_t> members,
                          const std::vector<TracedRow>& traced, RowMean& mean) {
  const auto valid = [](const TracedRow& row) { return row.back_face_share <= kInvalidShare; };
  const bool any_valid = std::any_of(traced.begin(), traced.end(), valid);
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (!any_valid || valid(traced[i])) mean.add(traced[i].row, surface.elements[members[i]].area);
  }
  return mean.finish();
}

/// Puts a row where it belongs.
void put_row(FormFactorRow row, std::size_t at, const std::optional<ValueCodec>& codec, RowStore& store,
             std::vector<FormFactorRow>& rows, std::vector<StoredRow>& stored) {
  if (codec) {
    stored[at] = store.put(row, *codec);
  } else {
    rows[at] = std::move(row);
  }
}

/// Row of one cluster, and those of its elements.
void trace_cluster(const RowScene& scene, const TracedSystem& system, std::uint32_t cluster,
                   std::span<const std::uint32_t> members, const SobolPoints& points, const RayLimits& limits,
                   const StoreChoice& store, Worker& worker, SystemRows& rows) {
  RowRays rays;
  std::vector<TracedRow> traced =
      trace_neighbours(receivers_of(scene, system, members), points, limits, worker, rays);
  FormFactorRow row = cluster_row(system.surface.surface, members, traced, worker.mean);
  row.moments = {};  // only what is gathered has directions
  worker.cluster_entries += row.senders.size();
  put_row(std::move(row), cluster, store.clusters, worker.store, rows.clusters, rows.stored_clusters);
  for (std::size_t i = 0; i < members.size(); ++i) {
    rows.element_back_face_share[members[i]] = traced[i].back_face_share;
    rows.element_rays[members[i]] = rays;
    if (!system.own_elements[members[i]]) continue;
    worker.element_entries += traced[i].row.senders.size();
    put_row(std::move(traced[i].row), members[i], store.elements, worker.store, rows.elements,
            rows.stored_elements);
  }
}

/// Limits and points of the nodes that ask for rays of their own, and of all others.
class NodePoints {
 public:
  NodePoints(const RayLimits& limits, std::span<const std::uint32_t> node_quality)
      : node_quality_(node_quality), limits_(limits), points_(limits.rays, first_stage(limits)) {
    for (const auto quality : node_quality) {
      if (quality > 0) own_.try_emplace(quality, quality, quality);
    }
  }
  RayLimits limits(std::uint32_t node) const {
    const std::uint32_t quality = node_quality_[node];
    return quality > 0 ? RayLimits{quality, quality, 0.0, 0.0, nullptr} : limits_;
  }
  const SobolPoints& points(std::uint32_t node) const {
    return node_quality_[node] > 0 ? own_.at(node_quality_[node]) : points_;
  }

 private:
  std::span<const std::uint32_t> node_quality_;
  RayLimits limits_;
  SobolPoints points_;
  std::map<std::uint32_t, SobolPoints> own_;  ///< by number of rays
};

/// One past the last cluster of the batch that begins with `first`.
std::uint32_t batch_end(const std::vector<std::vector<std::uint32_t>>& members, std::uint32_t first) {
  std::size_t elements = 0;
  std::uint32_t last = first;
  while (last < members.size() && elements < kBatchElements) elements += members[last++].size();
  return last;
}

}  // namespace

std::vector<Receiver> receivers_of(const RowScene& scene, const TracedSystem& system,
                                   std::span<const std::uint32_t> members) {
  std::vector<Receiver> receivers;
  for (const auto e : members) {
    const Element& element = system.surface.surface.elements[e];
    receivers.push_back(Receiver::element(scene.geometry, system.surface.surface, element,
                                          system.charts[element.chart].side));
  }
  return receivers;
}

std::vector<std::vector<std::uint32_t>> members_of_clusters(const ClusteredSurface& system) {
  std::vector<std::vector<std::uint32_t>> members(system.cluster_count);
  for (std::uint32_t e = 0; e < system.cluster.size(); ++e) members[system.cluster[e]].push_back(e);
  return members;
}

Result<SystemRows> trace_system(const RowScene& scene, const TracedSystem& system, const RayLimits& limits,
                                std::span<const std::uint32_t> node_quality, RowCounts& counts,
                                const ProgressObserver& observer, const RowsTaker& taker,
                                const StoreChoice& store) {
  SystemRows rows;
  const std::uint32_t clusters = system.surface.cluster_count;
  const std::size_t elements = system.surface.surface.elements.size();
  if (store.clusters) rows.stored_clusters.resize(clusters);
  if (!store.clusters) rows.clusters.resize(clusters);
  if (store.elements) rows.stored_elements.resize(elements);
  if (!store.elements) rows.elements.resize(elements);
  rows.element_back_face_share.resize(elements);
  rows.element_rays.resize(elements, {limits.rays});
  const auto members = members_of_clusters(system.surface);
  const NodePoints nodes(limits, node_quality);
  Workers workers([&] { return Worker(scene); });
  Progress progress(observer, "rays", clusters);
  for (std::uint32_t first = 0; first < clusters && !progress.cancelled();) {
    const std::uint32_t last = taker ? batch_end(members, first) : clusters;
    tbb::parallel_for(first, last, [&](std::uint32_t c) {
      if (progress.cancelled() || !in_sample(c, limits.every)) return;
      const std::uint32_t node = system.node(members[c][0]);
      trace_cluster(scene, system, c, members[c], nodes.points(node), nodes.limits(node), store,
                    workers.local(), rows);
      progress.one_done();
    });
    if (taker && !progress.cancelled()) taker(last, rows);
    first = last;
  }
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while tracing rays");
  add_counts(workers, counts);
  for (Worker& worker : workers) rows.stores.push_back(std::move(worker.store));
  return rows;
}

Result<SurveyRows> trace_survey(const RowScene& scene, const std::vector<Chart>& charts,
                                const std::vector<ClusteredSurface>& systems, RowCounts& counts,
                                const ProgressObserver& observer) {
  SurveyRows rows;
  rows.first.resize(scene.cluster_count), rows.second.resize(scene.cluster_count);
  const SobolPoints points(kSurveyRays, kSurveyElementRays / 2);
  Workers workers([&] { return Worker(scene); });
  Progress progress(observer, "survey", scene.cluster_count);
  for (const ClusteredSurface& system : systems) {
    const std::vector<bool> none(system.surface.elements.size(), false);
    const auto members = members_of_clusters(system);
    tbb::parallel_for(std::uint32_t{0}, system.cluster_count, [&](std::uint32_t c) {
      if (progress.cancelled()) return;
      const auto share = std::bit_floor(kSurveyRays / std::uint32_t(members[c].size()));
      const std::uint32_t half = std::max(kSurveyElementRays, share) / 2;
      Worker& worker = workers.local();
      const auto receivers = receivers_of(scene, {charts, system, none}, members[c]);
      worker.tracer.expect(receivers);
      for (const std::uint32_t begin : {0u, half}) {
        std::vector<TracedRow> traced;
        for (const Receiver& receiver : receivers)
          traced.push_back(worker.tracer.trace(receiver, points, {begin, half}));
        (begin == 0 ? rows.first : rows.second)[system.first_cluster + c] =
            cluster_row(system.surface, members[c], traced, worker.mean);
      }
      progress.one_done();
    });
  }
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while looking around with few rays");
  add_counts(workers, counts);
  return rows;
}

std::vector<FormFactorRow> mean_rows(const SurveyRows& halves, std::size_t senders) {
  std::vector<FormFactorRow> rows(halves.first.size());
  tbb::enumerable_thread_specific<RowMean> means([&] { return RowMean(senders); });
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    RowMean& mean = means.local();
    mean.add(halves.first[i], 0.5);
    mean.add(halves.second[i], 0.5);
    rows[i] = mean.finish();
  });
  return rows;
}

Result<SensorRows> trace_sensors(const RowScene& scene, std::span<const SurfacePoint> points,
                                 const RayLimits& limits, RowCounts& counts,
                                 const ProgressObserver& observer) {
  SensorRows result;
  result.rows.resize(points.size());
  result.rays.resize(points.size());
  const SobolPoints samples(points.empty() ? 0 : limits.rays, first_stage(limits));
  Workers workers([&] { return Worker(scene); });
  Progress progress(observer, "sensors", points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (progress.cancelled() || i % limits.every != 0) return;
    const Receiver receiver = Receiver::point(points[i]);
    auto traced = trace_neighbours({&receiver, 1}, samples, limits, workers.local(), result.rays[i]);
    result.rows[i] = std::move(traced[0].row);
    progress.one_done();
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while tracing the rays of sensors");
  add_counts(workers, counts);
  return result;
}

}  // namespace relume
