// SPDX-License-Identifier: MIT
#include "core/row_certificate.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/certificate.h"
#include "core/sender_product.h"

namespace relume {
namespace {

/// What is left open, as a part of the distance; and of the largest radiosity where the distance is nothing.
constexpr double kOpen = 0.05, kOpenOfLargest = 1e-9;

double root_mean_square(const std::vector<Rgb>& values) {
  double sum = 0.0;
  for (const Rgb& value : values) sum += glm::dot(value, value);
  return values.empty() ? 0.0 : std::sqrt(sum / double(values.size()));
}

std::vector<Rgb> distances(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  std::vector<Rgb> out;
  for (std::size_t i = 0; i < a.size(); ++i) out.push_back(glm::abs(a[i] - b[i]));
  return out;
}

}  // namespace

Result<RowCertificate> certify_against(const ReferenceMatrices& matrices, const Lighting& lighting,
                                       const std::vector<Rgb>& radiosity, const std::vector<Rgb>& irradiance,
                                       const std::function<bool()>& go_on) {
  if (auto checked = check_shapes(matrices.bounce, lighting); !checked)
    return tl::unexpected(checked.error());
  const ContractionBound contraction = contraction_bound(matrices.bounce, lighting.albedo);
  if (auto checked = check_contraction(contraction); !checked) return tl::unexpected(checked.error());

  RowCertificate result;
  std::vector<Rgb> before = radiosity;
  std::vector<Rgb> open;
  Rgb rounding(0.0);
  for (bool enough = false; !enough;) {
    if (go_on && !go_on()) return fail(ErrorCode::cancelled, "cancelled while the solution was certified");
    std::vector<Rgb> after = bounce(matrices.bounce, lighting, before);
    const Change change = measure_change(matrices.bounce, contraction, before, after);
    const Rgb series = Rgb(1.0) / (Rgb(1.0) - contraction.quotient);
    open.clear();
    for (const Rgb& weight : contraction.weights)
      open.push_back(weight * series * contraction.quotient * change.weighted);
    rounding = series * change.rounding;
    result.radiosity = distances(radiosity, after);
    const Rgb top = largest(after);
    const double least = kOpenOfLargest * std::max({top.x, top.y, top.z});
    enough = root_mean_square(open) <= std::max(kOpen * root_mean_square(result.radiosity), least);
    before = std::move(after);
    ++result.products;
  }
  result.irradiance = distances(irradiance, gather(matrices.gather, lighting, before));
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] += contraction.weights[i] * rounding;
    result.radiosity[i] += open[i];
  }
  const std::vector<Rgb> open_rows = cluster_product(matrices.gather, open);
  for (std::size_t row = 0; row < open_rows.size(); ++row) result.irradiance[row] += open_rows[row];
  return result;
}

}  // namespace relume
