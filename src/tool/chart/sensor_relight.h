// SPDX-License-Identifier: MIT
//
// Relighting by the reference as far as the sensors see it.
#pragma once

#include <functional>
#include <vector>

#include "core/reference_solver.h"
#include "measure/converged_answer.h"
#include "tool/chart/chart_data.h"

namespace relume {

/// A model's matrices with the rows of the sensors alone, in the order in which they were given.
struct SensorMatrices {
  SenderMatrix bounce;
  SenderMatrix sensors;
};
SensorMatrices sensor_matrices(const Model& model);

/// Lighting of each light of the test.
Result<std::vector<Lighting>> test_lightings(const Model& model, const TestScene& test);

struct SensorRelight {
  SensorValues converged;      ///< own solution
  std::uint32_t products = 0;  ///< plain bounces until every light is within kConverged of it
  SensorValues stopped;        ///< after so many
};
Result<SensorRelight> relight_sensors(const SensorMatrices& matrices, const std::vector<Lighting>& lightings,
                                      const std::vector<std::uint32_t>& rooms);

/// Over all lights.
MeasuredError measure_error(const std::vector<std::uint32_t>& rooms, const SensorValues& values,
                            const SensorValues& reference);

/// The least count up to `most` that `is_enough`, found by doubling and bisection to 5 %; nothing when none
/// is.
std::optional<std::uint32_t> least_count(std::uint32_t most,
                                         const std::function<Result<bool>(std::uint32_t)>& is_enough,
                                         Result<void>& failure);

}  // namespace relume
