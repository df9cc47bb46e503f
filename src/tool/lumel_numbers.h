// SPDX-License-Identifier: MIT
//
// Debug views that are numbers: what they measure, and between which values they are drawn.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/result.h"

namespace relume {

enum class HeatScale { linear, square_root, logarithm };

/// A number for each lumel.
struct LumelNumbers {
  std::string unit;                         ///< what is counted, and in what
  std::vector<std::vector<double>> values;  ///< per system, per lumel; NaN: none
  std::string none;                         ///< what a lumel without a number is
  double black = 0.0, white = 1.0;          ///< drawn so
  HeatScale scale = HeatScale::linear;
};

/// Names of views that are numbers.
const std::vector<std::string>& number_view_names();

/// `at`: world space, m; read by form_factors only. Fails (usage) where the file does not tell what `view`
/// shows.
Result<LumelNumbers> lumel_numbers(const Model& model, const std::string& view, const glm::dvec3& at);

/// Where a number lies between black, 0, and white, 1.
double heat_of(const LumelNumbers& numbers, double value);

}  // namespace relume
