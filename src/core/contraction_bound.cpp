// SPDX-License-Identifier: MIT
#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "core/reference_solver.h"
#include "core/sender_product.h"

namespace relume {
namespace {

/// Products that make the upper end sharp.
constexpr std::uint32_t kMaxProducts = 16;
/// Products that find out whether it is below 1 at all.
constexpr std::uint32_t kMaxUndecidedProducts = 256;

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

/// How much the sums of positive terms in a product can be rounded, relatively.
double rounding_of(const SenderMatrix& matrix) {
  return static_cast<double>(longest_row(matrix.rows) + longest_row(matrix.nodes) + 4) *
         std::numeric_limits<double>::epsilon();
}

/// The best of several lower ends: any part of the surfaces gives one; the slowest mode may live on all of
/// them or in one gap.
Result<Rgb> best_lower_quotient(const ClusterProduct& multiply, const std::vector<Rgb>& albedo,
                                const std::vector<Rgb>& weights, double rounding) {
  Rgb best(0.0);
  for (const double threshold : {0.0, 0.1, 0.5}) {
    const auto lower = lower_quotient(multiply, albedo, weights, threshold);
    if (!lower) return lower;
    best = glm::max(best, *lower * (1.0 - rounding));
  }
  return best;
}

bool below_one(const Rgb& quotient) {
  return glm::all(glm::lessThan(quotient, Rgb(1.0)));
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
  for (std::uint32_t k = 1; k < kMaxUndecidedProducts; ++k) {
    if (k >= kMaxProducts && below_one(bound.quotient)) break;
    if (k % kMaxProducts == 0) {
      const auto lower = best_lower_quotient(multiply, albedo, bound.weights, rounding);
      if (!lower) return tl::unexpected(lower.error());
      if (!below_one(*lower)) break;
    }
    v = next_weights(*product, v, bound.quotient);
    product = multiply(v);
    if (!product) return tl::unexpected(product.error());
    const Rgb quotient = upper_quotient(*product, v);
    keep_better(v, quotient, bound);
    bound.products = k + 1;
    if (k > 3 && below_one(bound.quotient) && settled(quotient, previous)) break;
    previous = quotient;
  }
  bound.quotient *= 1.0 + rounding;
  const auto lower = best_lower_quotient(multiply, albedo, bound.weights, rounding);
  if (!lower) return tl::unexpected(lower.error());
  bound.lower_quotient = *lower;
  return bound;
}

ContractionBound contraction_bound(const SenderMatrix& bounce_matrix, const std::vector<Rgb>& albedo) {
  const ClusterProduct reflect = [&](const std::vector<Rgb>& v) -> Result<std::vector<Rgb>> {
    std::vector<Rgb> product = cluster_product(bounce_matrix, v);
    for (std::size_t i = 0; i < product.size(); ++i) product[i] *= albedo[i];
    return product;
  };
  // These products cannot fail.
  return *contraction_bound(reflect, albedo, rounding_of(bounce_matrix));
}

}  // namespace relume
