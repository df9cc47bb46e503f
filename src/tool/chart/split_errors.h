// SPDX-License-Identifier: MIT
//
// How much of an error each cause has, by taking the causes away one after the other:
//   bounces    converged or not, the same matrices
//   precision  stored values or f32
//   cut        cut rows or all that the same rays found
//   rays       full rows by two seeds, over the square root of two
//   clusters   what is left of the error of full rows without that of rays (independent: squares add up)
#pragma once

#include "tool/chart/study_models.h"

namespace relume {

/// Sets RelightPoint::causes of the candidates on the Pareto front of milliseconds and error. Of models with
/// an error target they are what the precompute estimated.
Result<void> split_errors(const ChartTest& test, ChartProgress& progress, ModelStudy& study);

/// For progress: two precomputes of each kind of full rows that the front may need.
inline constexpr double kGuessedSecondsOfSplit = 25.0;

}  // namespace relume
