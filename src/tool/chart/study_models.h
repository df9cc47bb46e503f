// SPDX-License-Identifier: MIT
//
// Precomputes every model of the plan, measures its errors, and times whole relightings of all their variants
// in turn.
#pragma once

#include <deque>
#include <vector>

#include "compute/standalone/solver_session.h"
#include "tool/chart/chart_plan.h"
#include "tool/chart/chart_progress.h"
#include "tool/chart/sensor_relight.h"

namespace relume {

/// What the test measures against.
struct ChartTest {
  TestScene scene;
  ConvergedAnswer answer;
};

struct StudiedModel {
  ModelPlan plan;
  ErrorEstimate estimate;  ///< by the precompute
  SensorValues values;     ///< own solution of the values that the precompute gave
  PrecomputePoint point;
};

/// A variant of a model that is timed.
struct Candidate {
  RelightPoint point;
  SensorRelight relight;
  std::size_t model = 0;
  SolverSession* session = nullptr;
};

struct ModelStudy {
  std::vector<StudiedModel> models;
  std::vector<Candidate> candidates;
  std::deque<SolverSession> sessions;
  Model centre;  ///< as it is timed, with sensors
  std::vector<Lighting> centre_lightings;
};

/// Seconds that a precompute may take, for progress.
double guessed_seconds(const PrecomputeOptions& options);

/// Models that the scene cannot have become notes of `data`; the centre must be possible.
Result<ModelStudy> study_models(const ChartPlan& plan, const ChartTest& test, StandaloneDevice& device,
                                ChartProgress& progress, ChartData& data);

/// Further times of the precomputes.
Result<void> repeat_precomputes(std::uint32_t repetitions, const ChartTest& test, ChartProgress& progress,
                                ModelStudy& study);

/// Times of relightings, all candidates in turn.
Result<void> time_relights(std::uint32_t repetitions, ModelStudy& study);

}  // namespace relume
