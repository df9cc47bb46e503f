// SPDX-License-Identifier: MIT
#include "core/certificate.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "core/sender_product.h"

namespace relume {
namespace {

double largest_channel(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

/// numerator / denominator per channel, the worst of them; a channel without light has no error.
double worst_ratio(const Rgb& numerator, const Rgb& denominator) {
  double worst = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    if (numerator[channel] > 0.0) worst = std::max(worst, numerator[channel] / denominator[channel]);
  }
  return worst;
}

/// Comparisons would pass over a value that is not a number.
Rgb finite_or_infinite(Rgb value) {
  for (int channel = 0; channel < 3; ++channel) {
    if (!std::isfinite(value[channel])) value[channel] = std::numeric_limits<double>::infinity();
  }
  return value;
}

}  // namespace

Change measure_change(const SenderMatrix& senders, const ContractionBound& contraction,
                      const std::vector<Rgb>& before, const std::vector<Rgb>& after) {
  Change change;
  const CsrMatrix& matrix = senders.rows;
  const auto beside_row = static_cast<double>(longest_row(senders.nodes)) + 4.0;
  double terms = beside_row;
  Rgb negative(0.0), brightest(0.0);
  for (std::uint32_t row = 0; row < matrix.rows; ++row) {
    const Rgb difference = finite_or_infinite(glm::abs(after[row] - before[row]));
    const auto row_terms =
        static_cast<double>(matrix.row_offsets[row + 1] - matrix.row_offsets[row]) + beside_row;
    const Rgb ulps = row_terms * (std::numeric_limits<double>::epsilon() * glm::abs(after[row]) +
                                  std::numeric_limits<double>::denorm_min());
    change.largest = glm::max(change.largest, difference);
    change.weighted = glm::max(change.weighted, difference / contraction.weights[row]);
    change.rounding = glm::max(change.rounding, ulps / contraction.weights[row]);
    negative = glm::max(negative, -before[row] / contraction.weights[row]);
    brightest = glm::max(brightest, glm::abs(after[row]));
    terms = std::max(terms, row_terms);
  }
  // Terms that cancel: K |b| = K b + 2 K (negative part of b), and rho K v <= q v.
  change.rounding += 2.0 * terms * std::numeric_limits<double>::epsilon() * contraction.quotient * negative;
  for (int channel = 0; channel < 3; ++channel) {
    if (brightest[channel] == 0.0 && change.largest[channel] == 0.0)
      change.rounding[channel] = 0.0;  // darkness is exact
  }
  return change;
}

Change measure_change(const ContractionBound& contraction, double rounding, const std::vector<Rgb>& before,
                      const std::vector<Rgb>& after) {
  Change change;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const Rgb difference = finite_or_infinite(glm::abs(after[i] - before[i]));
    change.largest = glm::max(change.largest, difference);
    change.weighted = glm::max(change.weighted, difference / contraction.weights[i]);
    change.rounding = glm::max(change.rounding, rounding * glm::abs(after[i]) / contraction.weights[i]);
  }
  return change;
}

void rate_solution(const Change& change, const Rgb& first, const Rgb& quotient, Solution& solution) {
  const Rgb top = largest(solution.radiosity);
  solution.relative_residual = worst_ratio(Rgb(largest_channel(change.largest)), Rgb(largest_channel(top)));
  solution.error_bound = worst_ratio((first * change.weighted + change.rounding) / (1.0 - quotient), top);
}

}  // namespace relume
