// SPDX-License-Identifier: MIT
#include "tool/chart/split_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "measure/statistics.h"
#include "tool/chart/picture.h"

namespace relume {
namespace {

/// Full rows by two seeds.
using FullRows = std::array<SensorValues, 2>;

/// Kept by rays and cluster size.
class FullRowModels {
 public:
  explicit FullRowModels(const ChartTest& test) : test_(test) {}

  Result<FullRows> of(PrecomputeOptions options) {
    const auto key = std::pair(options.quality, options.cluster_size);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    options.budget = 0;
    options.sensors = test_.scene.sensors;
    FullRows rows;
    for (SensorValues& values : rows) {
      const auto solved =
          solve_model(test_.scene, options, [](std::string_view, double) { return !interrupted(); });
      if (!solved) return tl::unexpected(solved.error());
      values = solved->values;
      ++options.seed;
    }
    known_.emplace(key, rows);
    return rows;
  }

 private:
  const ChartTest& test_;
  std::map<std::pair<std::uint32_t, double>, FullRows> known_;
};

Result<ErrorCauses> measured_causes(const ChartTest& test, const StudiedModel& model,
                                    const Candidate& candidate, FullRowModels& full_rows) {
  const auto off = [&](const SensorValues& a, const SensorValues& b) {
    return measure_error(test.answer.rooms, a, b).all_lights;
  };
  const auto full = full_rows.of(model.plan.options);
  if (!full) return tl::unexpected(full.error());
  ErrorCauses causes;
  causes.bounces = off(candidate.relight.stopped, candidate.relight.converged);
  causes.precision = off(candidate.relight.converged, model.values);
  causes.cut = off(model.values, (*full)[0]);
  causes.rays = off((*full)[0], (*full)[1]) / std::sqrt(2.0);
  const double left = off((*full)[0], test.answer.values);
  causes.clusters = std::sqrt(std::max(0.0, left * left - causes.rays * causes.rays));
  return causes;
}

ErrorCauses estimated_causes(const ChartTest& test, const StudiedModel& model, const Candidate& candidate) {
  const ErrorEstimate& estimate = model.estimate;
  const double bounces =
      measure_error(test.answer.rooms, candidate.relight.stopped, candidate.relight.converged).all_lights;
  return {estimate.clusters, estimate.rays, estimate.cut, estimate.precision, bounces, true};
}

}  // namespace

Result<void> split_errors(const ChartTest& test, ChartProgress& progress, ModelStudy& study) {
  ChartSeries all;
  for (const Candidate& candidate : study.candidates)
    all.points.push_back({median(candidate.point.milliseconds), candidate.point.error.all_lights});
  const auto front = pareto_front({all});
  FullRowModels full_rows(test);
  for (std::size_t c = 0; c < study.candidates.size(); ++c) {
    const std::pair<double, double> place{all.points[c].x, all.points[c].y};
    if (std::find(front.begin(), front.end(), place) == front.end()) continue;
    Candidate& candidate = study.candidates[c];
    const StudiedModel& model = study.models[candidate.model];
    if (model.plan.options.error > 0.0) {
      candidate.point.causes = estimated_causes(test, model, candidate);
      continue;
    }
    const auto causes = measured_causes(test, model, candidate, full_rows);
    if (!causes) return tl::unexpected(causes.error());
    candidate.point.causes = *causes;
  }
  return progress.did(kGuessedSecondsOfSplit);
}

}  // namespace relume
