// SPDX-License-Identifier: MIT
#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "core/reference_solver.h"

namespace relume {
namespace {

constexpr int kMaxProducts = 16;

Rgb row_product(const CsrMatrix& matrix, std::uint32_t row, const std::vector<Rgb>& v) {
  Rgb sum(0.0);
  for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry)
    sum += matrix.values[entry] * v[matrix.column_indices[entry]];
  return sum;
}

/// rho K_c P v: sky patches, and with them the nodes of the sky, do not feed back.
std::vector<Rgb> multiply(const SenderMatrix& matrix, const std::vector<Rgb>& albedo,
                          const std::vector<Rgb>& v) {
  std::vector<Rgb> b = v;
  b.resize(matrix.rows.columns - matrix.nodes.rows, Rgb(0.0));
  for (std::uint32_t node = 0; node < matrix.nodes.rows; ++node)
    b.push_back(row_product(matrix.nodes, node, b));
  std::vector<Rgb> product(matrix.rows.rows);
  for (std::uint32_t row = 0; row < product.size(); ++row)
    product[row] = albedo[row] * row_product(matrix.rows, row, b);
  return product;
}

Rgb largest(const std::vector<Rgb>& values) {
  Rgb result(0.0);
  for (const Rgb& value : values) result = glm::max(result, value);
  return result;
}

/// max_i (rho K_c P v)_i / v_i per channel.
Rgb upper_quotient(const std::vector<Rgb>& product, const std::vector<Rgb>& v) {
  Rgb quotient(0.0);
  for (std::size_t i = 0; i < v.size(); ++i) quotient = glm::max(quotient, product[i] / v[i]);
  return quotient;
}

/// Keeps, channel by channel, the weights of the smaller quotient.
void keep_better(const std::vector<Rgb>& v, const Rgb& quotient, ContractionBound& bound) {
  for (int channel = 0; channel < 3; ++channel) {
    if (quotient[channel] >= bound.quotient[channel]) continue;
    bound.quotient[channel] = quotient[channel];
    for (std::size_t i = 0; i < v.size(); ++i) bound.weights[i][channel] = v[i][channel];
  }
}

/// The next weights: the product, plus a quarter of the weights themselves (surfaces that face each other
/// make modes that swap sign and would not die away), brought to a largest entry of 1, plus a share of ones.
/// The share keeps weights of surfaces that the slowest mode does not reach from vanishing (their errors
/// would be divided by nothing); a tenth of the gap to 1 hardly blunts the quotient.
std::vector<Rgb> next_weights(const std::vector<Rgb>& product, const std::vector<Rgb>& v,
                              const Rgb& quotient) {
  constexpr double kKept = 0.25;
  const Rgb top = largest(product);
  std::vector<Rgb> next(product.size(), Rgb(1.0));
  for (int channel = 0; channel < 3; ++channel) {
    if (top[channel] <= 0.0) continue;
    const double share = std::clamp(0.1 * (1.0 - quotient[channel]), 1e-6, 0.1);
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i][channel] = product[i][channel] / top[channel] + kKept * v[i][channel] + share;
    }
  }
  const Rgb scale = 1.0 / largest(next);
  for (Rgb& weight : next) weight *= scale;
  return next;
}

/// min over i of (rho K_c P x)_i / x_i, x = the weights of clusters that reflect and are at least
/// `threshold`: a lower end of the spectral radius for any x >= 0 other than 0 (L. Collatz, 1942; H.
/// Wielandt, 1950).
Result<Rgb> lower_quotient(const ClusterProduct& multiply, const std::vector<Rgb>& albedo,
                           const std::vector<Rgb>& weights, double threshold) {
  std::vector<Rgb> x(weights.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      const bool counts = albedo[i][channel] > 0.0 && weights[i][channel] >= threshold;
      x[i][channel] = counts ? weights[i][channel] : 0.0;
    }
  }
  const auto product = multiply(x);
  if (!product) return tl::unexpected(product.error());
  Rgb result(0.0);
  for (int channel = 0; channel < 3; ++channel) {
    double lowest = -1.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (x[i][channel] <= 0.0) continue;
      const double quotient = (*product)[i][channel] / x[i][channel];
      lowest = lowest < 0.0 ? quotient : std::min(lowest, quotient);
    }
    result[channel] = std::max(lowest, 0.0);
  }
  return result;
}

std::uint64_t longest_row(const CsrMatrix& matrix) {
  std::uint64_t longest = 0;
  for (std::uint32_t row = 0; row < matrix.rows; ++row)
    longest = std::max(longest, matrix.row_offsets[row + 1] - matrix.row_offsets[row]);
  return longest;
}

/// How much the sums of positive terms in a product can be rounded, relatively.
double rounding_of(const SenderMatrix& matrix) {
  return static_cast<double>(longest_row(matrix.rows) + longest_row(matrix.nodes) + 4) *
         std::numeric_limits<double>::epsilon();
}

bool settled(const Rgb& quotient, const Rgb& previous) {
  return glm::all(glm::lessThanEqual(previous - quotient, 0.01 * glm::abs(1.0 - quotient)));
}

}  // namespace

Result<ContractionBound> contraction_bound(const ClusterProduct& multiply, const std::vector<Rgb>& albedo,
                                           double rounding) {
  ContractionBound bound;
  bound.weights.assign(albedo.size(), Rgb(1.0));
  auto product = multiply(bound.weights);
  if (!product) return tl::unexpected(product.error());
  bound.quotient = upper_quotient(*product, bound.weights);
  Rgb previous = bound.quotient;
  std::vector<Rgb> v = bound.weights;
  for (int k = 1; k < kMaxProducts; ++k) {
    v = next_weights(*product, v, bound.quotient);
    product = multiply(v);
    if (!product) return tl::unexpected(product.error());
    const Rgb quotient = upper_quotient(*product, v);
    keep_better(v, quotient, bound);
    if (k > 3 && settled(quotient, previous)) break;
    previous = quotient;
  }
  bound.quotient *= 1.0 + rounding;
  // Any part of the surfaces gives a lower end; the slowest mode may live on all of them or in one gap.
  for (const double threshold : {0.0, 0.1, 0.5}) {
    const auto lower = lower_quotient(multiply, albedo, bound.weights, threshold);
    if (!lower) return tl::unexpected(lower.error());
    bound.lower_quotient = glm::max(bound.lower_quotient, *lower * (1.0 - rounding));
  }
  return bound;
}

ContractionBound contraction_bound(const SenderMatrix& bounce_matrix, const std::vector<Rgb>& albedo) {
  const ClusterProduct product = [&](const std::vector<Rgb>& v) -> Result<std::vector<Rgb>> {
    return multiply(bounce_matrix, albedo, v);
  };
  // These products cannot fail.
  return *contraction_bound(product, albedo, rounding_of(bounce_matrix));
}

}  // namespace relume
