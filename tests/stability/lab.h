// SPDX-License-Identifier: MIT
//
// The stability lab: cases in which methods are known to fail, with answers that come from elsewhere.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/methods/methods.h"

namespace relume::test {

struct Case {
  std::string name;
  SenderMatrix matrix;
  Lighting lighting;
  std::vector<double> areas;
  Rooms rooms;
  std::vector<double> exact;     ///< radiosity of the red channel; empty: there is none, since light grows
  double spectral_radius = 0.0;  ///< known from elsewhere where there is no answer, else 0
};

/// By name, made when it is asked for.
struct CaseMaker {
  std::string name;
  std::function<Case()> make;
};
const std::vector<CaseMaker>& all_cases();

/// The solution of (1 - rho K P) B = S in the red channel, by LU of the dense matrix (Eigen).
std::vector<double> dense_solution(const SenderMatrix& matrix, const Lighting& lighting);

/// |lambda| of the red channel by 4000 steps of the power method on the dense matrix (Eigen).
double power_method(const SenderMatrix& matrix, const Lighting& lighting);

/// Box rooms with one lamp under the ceiling of the first, walls of albedos around `albedo`.
Case box_case(const std::string& name, std::uint32_t rooms, double patch, double albedo);

enum class OutcomeKind {
  right,      ///< within the tolerance
  fell_back,  ///< within the tolerance, by plain bounces in the end
  bounded,    ///< the products ran out: the error is within the bound that is given
  refused,    ///< a sentence
  wrong       ///< none of these: light that is negative or not finite, or an error above the bound
};

struct Outcome {
  OutcomeKind kind = OutcomeKind::wrong;
  std::uint32_t products = 0;
  std::string sentence;  ///< of a refusal or of a fall-back
};

inline constexpr StopRule kLabRule{300, 1e-6};

/// Judges what a method returned by the exact answer.
Outcome judge(const Case& c, const Result<Solution>& solution, const StopRule& rule);

Outcome run_method(const Case& c, Method method);

/// "6", "27 fell back", "error within bound", "refused"
std::string describe(const Outcome& outcome);

}  // namespace relume::test
