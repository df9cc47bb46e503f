// SPDX-License-Identifier: MIT
#include "precompute/leak_meter.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>

#include "core/sender_leaves.h"
#include "precompute/arena_threads.h"
#include "precompute/leak_view.h"
#include "precompute/process_memory.h"

namespace relume {
namespace {

/// Clusters that a column stands for, by leaf number; none of the sky.
std::vector<WeightPart> clusters_of(const LeafNumbers& numbers, const SenderRef& sender) {
  if (sender.system == kSkySystem) return {};
  std::vector<WeightPart> parts;
  const SenderLeaves all = numbers.leaves_of(sender);
  for (const LeafRange& range : all.ranges) {
    for (std::uint32_t i = 0; i < range.count; ++i) parts.push_back({range.first + i, range.share_of(i)});
  }
  if (parts.size() <= kLeakClusters) return parts;
  std::vector<double> shares;
  for (const WeightPart& part : parts) shares.push_back(part.share);
  std::vector<WeightPart> chosen;
  for (const WeightPart& part : spread(shares, kLeakClusters))
    chosen.push_back({parts[part.index].index, (1.0 - all.missing_share) * part.share});
  return chosen;
}

/// What all rows share.
struct LeakScene {
  const Model& model;
  const RayCaster& caster;
  PointSpreader spreader;
  std::vector<std::uint32_t> first_cluster;  ///< per system, and the total
  std::vector<LeakPoints> points;            ///< per cluster of all systems
  float far = 0.0f;                          ///< m, beyond everything

  LeakScene(const Model& m, const RayCaster& c)
      : model(m), caster(c), spreader(m, c), first_cluster(cluster_offsets(m)), points(first_cluster.back()) {
    for (std::size_t s = 0; s < model.systems.size(); ++s) {
      const System& system = model.systems[s];
      tbb::parallel_for(std::size_t{0}, system.clusters.size(), [&](std::size_t i) {
        const Cluster& cluster = system.clusters[i];
        points[first_cluster[s] + i] = spreader.points(system, cluster.first_element, cluster.element_count);
      });
    }
    if (model.occluders.positions.empty()) return;
    glm::vec3 lower = model.occluders.positions[0], upper = lower;
    for (const glm::vec3& p : model.occluders.positions)
      lower = glm::min(lower, p), upper = glm::max(upper, p);
    far = glm::length(upper - lower);
  }

  SenderRef cluster_ref(std::uint32_t leaf) const {
    const auto after = std::upper_bound(first_cluster.begin(), first_cluster.end(), leaf);
    const auto system = std::uint32_t(after - first_cluster.begin() - 1);
    return {system, leaf - first_cluster[system]};
  }
};

/// The cluster that takes the largest part, of walled parts first.
struct WorstSender {
  std::uint32_t leaf = kNone;
  double hidden = 0.0, walled = 0.0;
  void offer(const WorstSender& other) {
    if (std::pair(other.walled, other.hidden) > std::pair(walled, hidden)) *this = other;
  }
};

/// Rows of one matrix while they are measured.
class MatrixLeaks {
 public:
  MatrixLeaks(const LeakScene& around, const System& system, const BlockMatrix& matrix)
      : around_(around), rows_(decode(matrix)) {
    const LeafNumbers numbers(around.model);
    for (const SenderRef& sender : system.imports) columns_.push_back(clusters_of(numbers, sender));
  }

  /// Fills in what `leak` receives by row `row`, through `points`.
  void measure(std::uint32_t row, const LeakPoints& points, RowLeak& leak) const {
    const LeakView view(around_.caster, points, 4.0f * around_.spreader.offset(), around_.far);
    WorstSender worst;
    for (auto e = rows_.row_offsets[row]; e < rows_.row_offsets[row + 1]; ++e) {
      for (const WeightPart& part : columns_[rows_.column_indices[e]]) {
        const WorstSender found = leak_of(view, part, rows_.values[e]);
        leak.hidden += found.hidden, leak.walled += found.walled;
        worst.offer(found);
      }
    }
    if (worst.leaf == kNone) return;
    leak.sender = around_.cluster_ref(worst.leaf);
    const Cluster& cluster = around_.model.systems[leak.sender.system].clusters[leak.sender.index];
    leak.sender_node = cluster.node;
    leak.sender_place = around_.model.origin + glm::dvec3(cluster.centroid);
  }

 private:
  WorstSender leak_of(const LeakView& view, const WeightPart& part, double form_factor) const {
    const LeakPoints& points = around_.points[part.index];
    const std::uint32_t seen = view.sees(points);
    const std::uint32_t unseen = kAllLeakPoints & ~seen;
    const int walled = std::popcount(unseen & ~view.joined(points, unseen));
    const double share = form_factor * part.share;
    return {part.index, seen == 0 ? share : 0.0, share * walled / kLeakPoints};
  }

  const LeakScene& around_;
  CsrMatrix rows_;
  std::vector<std::vector<WeightPart>> columns_;
};

/// `count` of `all`, evenly.
std::vector<RowLeak> thinned(const std::vector<RowLeak>& all, std::uint32_t count) {
  if (all.size() <= count) return all;
  std::vector<RowLeak> chosen;
  for (std::uint64_t k = 0; k < count; ++k) chosen.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return chosen;
}

std::vector<RowLeak> lumel_rows(const Model& model) {
  std::vector<RowLeak> rows;
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::uint32_t l = 0; l < system.lumels.size(); ++l) {
      if (system.lumels[l].flags & kLumelInvalid) continue;
      const SurfaceElement& element = system.elements[system.lumels[l].element];
      rows.push_back({LeakReceiver::lumel, s, l, system.clusters[element.cluster].node,
                      model.origin + glm::dvec3(element.position)});
    }
  }
  return rows;
}

std::vector<RowLeak> cluster_rows(const Model& model) {
  std::vector<RowLeak> rows;
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::uint32_t c = 0; c < system.clusters.size(); ++c) {
      rows.push_back({LeakReceiver::cluster, s, c, system.clusters[c].node,
                      model.origin + glm::dvec3(system.clusters[c].centroid)});
    }
  }
  return rows;
}

/// Measures those of `rows` that lie in system `s`, all of one kind.
void measure_rows(const LeakScene& around, std::uint32_t s, LeakReceiver kind, std::vector<RowLeak>& rows) {
  const System& system = around.model.systems[s];
  const auto in_system = [s](const RowLeak& row) { return row.system == s; };
  if (std::none_of(rows.begin(), rows.end(), in_system)) return;
  const bool lumels = kind == LeakReceiver::lumel;
  const MatrixLeaks leaks(around, system, lumels ? system.gather : system.bounce);
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    RowLeak& row = rows[i];
    if (!in_system(row)) return;
    const LeakPoints points = lumels ? around.spreader.points(system, system.lumels[row.index].element, 1)
                                     : around.points[around.first_cluster[s] + row.index];
    leaks.measure(row.index, points, row);
  });
}

LeakSummary summarise(const std::vector<RowLeak>& rows) {
  LeakSummary summary{rows.size()};
  for (const RowLeak& row : rows) {
    summary.mean_hidden += row.hidden / double(rows.size());
    summary.mean_walled += row.walled / double(rows.size());
    summary.largest_hidden = std::max(summary.largest_hidden, row.hidden);
    summary.largest_walled = std::max(summary.largest_walled, row.walled);
  }
  return summary;
}

}  // namespace

Result<LeakReport> measure_leaks(const Model& model, const LeakOptions& options) {
  try {
    Result<RayCaster> caster =
        RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
    if (!caster) return tl::unexpected(caster.error());
    std::vector<RowLeak> lumels = thinned(lumel_rows(model), options.rows);
    std::vector<RowLeak> clusters;
    if (options.clusters) clusters = thinned(cluster_rows(model), options.rows);
    tbb::task_arena arena(arena_threads(options.threads));
    arena.execute([&] {
      const LeakScene around(model, *caster);
      for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
        measure_rows(around, s, LeakReceiver::lumel, lumels);
        measure_rows(around, s, LeakReceiver::cluster, clusters);
      }
    });
    LeakReport report{summarise(lumels), summarise(clusters), std::move(lumels)};
    report.rows.insert(report.rows.end(), clusters.begin(), clusters.end());
    return report;
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::out_of_memory,
        fmt::format("memory ran out while leaks were measured: expected more than {:.0f} MB, found less",
                    1e-6 * double(peak_address_bytes())));
  }
}

std::vector<RowLeak> worst_leaks(const LeakReport& report, double RowLeak::*what, std::size_t count) {
  std::vector<RowLeak> worst;
  std::copy_if(report.rows.begin(), report.rows.end(), std::back_inserter(worst),
               [what](const RowLeak& row) { return row.*what > 0.0; });
  std::stable_sort(worst.begin(), worst.end(),
                   [what](const RowLeak& a, const RowLeak& b) { return a.*what > b.*what; });
  worst.resize(std::min(worst.size(), count));
  return worst;
}

}  // namespace relume
