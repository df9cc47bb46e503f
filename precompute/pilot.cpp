// SPDX-License-Identifier: MIT
#include "precompute/pilot.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/quantities.h"
#include "precompute/adaptive_row.h"

namespace relume {
namespace {

constexpr std::uint32_t kPilotClusters = 256;
/// As many as go into a tile.
constexpr std::size_t kMostRows = 8;

struct PilotWorker {
  explicit PilotWorker(const RowScene& scene) : tracer(scene), mean(sender_count(scene)) {}
  RowTracer tracer;
  RowMean mean;
};

PilotRows trace_rows_of(std::span<const Receiver> receivers, const SobolPoints& points,
                        const Probing& probing, double mean_area, PilotWorker& worker) {
  constexpr std::uint32_t kHalf = kPilotRays / 2;
  PilotRows result;
  std::vector<RowHalves> halves;
  for (const Receiver& receiver : receivers) {
    halves.push_back({worker.tracer.trace(receiver, points, {0, kHalf}),
                      worker.tracer.trace(receiver, points, {kHalf, kHalf})});
    worker.mean.add(halves.back().first.row, 0.5);
    worker.mean.add(halves.back().second.row, 0.5);
    result.places.push_back(receiver.middle());
    result.rows.push_back(worker.mean.finish());
    const double radius = double(receiver.radius());
    result.weight += kPi * radius * radius / (mean_area * double(receivers.size()));
  }
  const double noise = row_noise(probing, halves);
  result.squared_noise = noise * noise;
  return result;
}

/// Mean square of the noise of all rows, with as many rays as the exchange gives them.
double noise_at(const std::vector<PilotRows>& pilot, const RayLimits& limits, double exchange) {
  double sum = 0.0, weights = 0.0;
  for (const PilotRows& part : pilot) {
    std::uint32_t rays = limits.least;
    const auto squared = [&] {
      return part.squared_noise * std::pow(double(kPilotRays) / double(rays), kNoiseExponent);
    };
    while (part.weight * squared() > exchange * double(rays) && 2 * rays <= limits.rays) rays *= 2;
    const double weight = part.weight * double(part.rows.size());
    sum += weight * squared();
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

/// The largest x in [low, high] at which `value`, which grows with it, is no larger than `target`.
template <class Value>
double largest_below(double low, double high, double target, Value&& value) {
  for (int k = 0; k < 60; ++k) {
    const double middle = std::sqrt(low * high);
    (value(middle) > target ? high : low) = middle;
  }
  return low;
}

}  // namespace

std::vector<PilotRows> trace_pilot(const RowScene& scene, const std::vector<Chart>& charts,
                                   const std::vector<ClusteredSurface>& systems, const Probing& probing,
                                   double mean_area, RowCounts& counts) {
  const std::uint32_t step = scene.cluster_count / kPilotClusters + 1;
  const SobolPoints points(kPilotRays, kPilotRays / 2);
  tbb::enumerable_thread_specific<PilotWorker> workers([&] { return PilotWorker(scene); });
  std::vector<PilotRows> pilot((scene.cluster_count + step - 1) / step);
  for (const ClusteredSurface& system : systems) {
    const std::vector<bool> none(system.surface.elements.size(), false);
    const auto members = members_of_clusters(system);
    tbb::parallel_for(std::uint32_t{0}, system.cluster_count, [&](std::uint32_t c) {
      const std::uint32_t number = system.first_cluster + c;
      if (number % step != 0) return;
      const auto some = std::span(members[c]).first(std::min(members[c].size(), kMostRows));
      pilot[number / step] = trace_rows_of(receivers_of(scene, {charts, system, none}, some), points, probing,
                                           mean_area, workers.local());
    });
  }
  for (const PilotWorker& worker : workers) add_rays(worker.tracer, counts);
  return pilot;
}

double find_exchange(const std::vector<PilotRows>& pilot, const RayLimits& limits, double noise) {
  return largest_below(1e-16, 1.0, noise * noise,
                       [&](double exchange) { return noise_at(pilot, limits, exchange); });
}

double find_node_error(const std::vector<PilotRows>& pilot, const ClusterTree& tree, const Probing& probing,
                       double error) {
  std::vector<std::vector<CutStep>> steps(pilot.size());
  tbb::enumerable_thread_specific<TileCutter> cutters(
      [&] { return TileCutter({.tree = tree, .probing = probing, .each_room_alone = false}); });
  tbb::parallel_for(std::size_t{0}, pilot.size(), [&](std::size_t i) {
    std::vector<CutRow> tile;
    for (std::size_t r = 0; r < pilot[i].rows.size(); ++r)
      tile.push_back({&pilot[i].rows[r], float(kPilotRays), 0.0f, pilot[i].places[r]});
    steps[i] = cutters.local().steps(tile);
  });
  const auto error_at = [&](double node_error) {
    double sum = 0.0, weights = 0.0;
    for (std::size_t i = 0; i < pilot.size(); ++i) {
      const auto enough = [&](const CutStep& step) { return double(step.node) <= node_error * node_error; };
      const auto reached = std::find_if(steps[i].begin(), steps[i].end(), enough);
      const double weight = pilot[i].weight * double(pilot[i].rows.size());
      if (reached != steps[i].end()) sum += weight * double(reached->tile);
      weights += weight;
    }
    return weights > 0.0 ? sum / weights : 0.0;
  };
  return largest_below(1e-9, 1.0, error * error, error_at);
}

}  // namespace relume
