// SPDX-License-Identifier: MIT
//
// What is right, as nearly as models can tell: indirect irradiance at the sensors of a TestScene from models
// far denser than anybody would use. Paths tell it without models (measure/path_irradiance.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"
#include "measure/test_lights.h"
#include "precompute/precompute.h"

namespace relume {

/// Irradiance at the sensors, per light of the test scene.
using SensorValues = std::vector<std::vector<Rgb>>;

/// The gather row of each sensor, in the order that they were given.
std::vector<std::uint32_t> sensor_rows(const Model& model);

struct SolvedModel {
  Model model;
  PrecomputeReport report;
  SensorValues values;
};

/// Precomputes and solves for all lights by the reference.
Result<SolvedModel> solve_model(const TestScene& test, const PrecomputeOptions& options,
                                const ProgressObserver& observer = {});

/// The room that each sensor sees most of, kNone: it sees mostly the backs of surfaces, or next to nothing.
std::vector<std::uint32_t> sensor_rooms(const Model& model);

struct AnswerSize {
  double clusters = 24000.0;    ///< of the densest model, about
  std::uint32_t quality = 256;  ///< rays per cluster
  std::uint32_t sensor_quality = 1u << 16;
};

/// The densest model of such an answer, in full rows: its clusters are as large as its lumels.
Result<SolvedModel> dense_model(const TestScene& test, const PrecomputeOptions& options,
                                const AnswerSize& size = {}, const ProgressObserver& observer = {});

struct ConvergedAnswer {
  SensorValues values;
  SensorValues densest;              ///< of the densest model alone, before extrapolation
  std::vector<std::uint32_t> rooms;  ///< sensor_rooms()
  std::uint32_t clusters = 0;        ///< of the densest model
};

/// Extrapolated over cluster size: twice the answer of small clusters less that of clusters of twice the
/// size. Full rows. `options` has the sensors, seed and threads.
Result<ConvergedAnswer> converged_answer(const TestScene& test, const PrecomputeOptions& options,
                                         const AnswerSize& size = {}, const ProgressObserver& observer = {});

/// |I - J| / |J| over the sensors that see a room. Sensors are spread evenly over all surfaces, so this is
/// weighted by area.
double sensor_error(const std::vector<std::uint32_t>& rooms, const std::vector<Rgb>& values,
                    const std::vector<Rgb>& reference);

double area_of(const Scene& scene);  ///< m2

}  // namespace relume
