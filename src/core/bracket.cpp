// SPDX-License-Identifier: MIT
#include "core/bracket.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <numeric>

#include "core/sender_product.h"

namespace relume {
namespace {

/// Intervals are made wider by this share before it is tried whether they hold.
constexpr double kWider = 0.005;
/// And by so much of the value, and of the largest, where they have no width.
constexpr double kOfValue = 1e-9, kOfLargest = 1e-12;
/// They are narrow enough when an iteration takes away no more than this share of all widths.
constexpr double kHardlyNarrower = 5e-4;
/// They grow without end when they are so many times as wide as the largest radiosity.
constexpr double kWithoutEnd = 1e4;

double sum_of(const Rgb& value) {
  return value.x + value.y + value.z;
}

/// What clusters and sky send at most to the rows.
std::vector<Rgb> most(const LooseRows& matrix, std::vector<Rgb> clusters, const std::vector<Rgb>& sky,
                      double sign) {
  clusters.insert(clusters.end(), sky.begin(), sky.end());
  for (Rgb& value : clusters) value *= sign;
  std::vector<Rgb> arriving = most_arriving(matrix, clusters);
  for (Rgb& value : arriving) value *= sign;
  return arriving;
}

Bracket arriving(const LooseRows& matrix, const Lighting& lighting, const Bracket& clusters) {
  Bracket irradiance{most(matrix, clusters.low, lighting.sky_radiosity, -1.0),
                     most(matrix, clusters.high, lighting.sky_radiosity, 1.0)};
  for (Rgb& value : irradiance.low) value = glm::max(value, Rgb(0.0));
  return irradiance;
}

Bracket bounced(const LooseRows& matrix, const Lighting& lighting, const Bracket& clusters) {
  Bracket radiosity = arriving(matrix, lighting, clusters);
  for (std::vector<Rgb>* ends : {&radiosity.low, &radiosity.high}) {
    for (std::size_t i = 0; i < ends->size(); ++i) {
      Rgb& value = (*ends)[i];
      value = lighting.exitance[i] + lighting.albedo[i] * (lighting.direct[i] + value);
    }
  }
  return radiosity;
}

Bracket widened(const Bracket& bracket, double largest) {
  Bracket wider = bracket;
  for (std::size_t i = 0; i < wider.low.size(); ++i) {
    const Rgb more =
        kWider * (bracket.high[i] - bracket.low[i]) + kOfValue * bracket.high[i] + kOfLargest * largest;
    wider.low[i] = glm::max(bracket.low[i] - more, Rgb(0.0));
    wider.high[i] = bracket.high[i] + more;
  }
  return wider;
}

bool lies_inside(const Bracket& inner, const Bracket& outer) {
  for (std::size_t i = 0; i < inner.low.size(); ++i) {
    if (!glm::all(glm::lessThanEqual(outer.low[i], inner.low[i])) ||
        !glm::all(glm::lessThanEqual(inner.high[i], outer.high[i])))
      return false;
  }
  return true;
}

double all_widths(const Bracket& bracket) {
  double sum = 0.0;
  for (std::size_t i = 0; i < bracket.low.size(); ++i) sum += sum_of(bracket.high[i] - bracket.low[i]);
  return sum;
}

/// Both hold the solution.
void intersect(const Bracket& other, Bracket& bracket) {
  for (std::size_t i = 0; i < bracket.low.size(); ++i) {
    bracket.low[i] = glm::max(bracket.low[i], other.low[i]);
    bracket.high[i] = glm::min(bracket.high[i], other.high[i]);
  }
}

/// max_i rho_i sum_j F_ij: below 1, bounces of whatever rows these come from converge.
Result<void> check_rows(const LooseRows& matrix, const std::vector<Rgb>& albedo) {
  double worst = 0.0;
  for (std::uint32_t row = 0; row < matrix.rows.rows; ++row) {
    const auto begin = matrix.rows.values.begin() + std::ptrdiff_t(matrix.rows.row_offsets[row]);
    const auto end = matrix.rows.values.begin() + std::ptrdiff_t(matrix.rows.row_offsets[row + 1]);
    const Rgb& rho = albedo[row];
    worst = std::max(worst, std::max({rho.x, rho.y, rho.z}) * std::accumulate(begin, end, 0.0));
  }
  if (worst < 1.0) return {};
  return fail(
      ErrorCode::check_failed,
      fmt::format("no bounds: the largest albedo x sum of a row, expected below 1, found {:.6g}", worst));
}

using GoOn = std::function<bool()>;

tl::unexpected<Error> cancelled() {
  return fail(ErrorCode::cancelled, "cancelled while bounds were iterated");
}

/// Intervals that an iteration maps into themselves, from the solution of the stored rows outwards.
Result<Bracket> grow(const LooseRows& matrix, const Lighting& lighting, const std::vector<Rgb>& start,
                     const GoOn& go_on, std::uint32_t& products) {
  const Rgb brightest = largest(start);
  const double top = std::max({brightest.x, brightest.y, brightest.z});
  Bracket inner{start, start};
  while (true) {
    if (go_on && !go_on()) return cancelled();
    const Bracket outer = widened(inner, top);
    inner = bounced(matrix, lighting, outer);
    ++products;
    if (lies_inside(inner, outer)) return inner;
    const double reached = std::max({largest(inner.high).x, largest(inner.high).y, largest(inner.high).z});
    if (!(reached <= kWithoutEnd * top)) {
      return fail(ErrorCode::check_failed,
                  fmt::format("no bounds: intervals, expected to hold what an iteration makes of them, found "
                              "to grow without end (after {} products)",
                              products));
    }
  }
}

Result<Bracket> narrow(const LooseRows& matrix, const Lighting& lighting, Bracket bracket, const GoOn& go_on,
                       std::uint32_t& products) {
  double before = 0.0, after = all_widths(bracket);
  do {
    if (go_on && !go_on()) return cancelled();
    intersect(bounced(matrix, lighting, bracket), bracket);
    ++products;
    before = after, after = all_widths(bracket);
  } while (after < (1.0 - kHardlyNarrower) * before);
  return bracket;
}

}  // namespace

Result<SolutionBracket> bracket_solution(const LooseMatrices& matrices, const Lighting& lighting,
                                         const std::vector<Rgb>& start, const GoOn& go_on) {
  const LooseRows& bounce = matrices.bounce;
  if (auto checked = check_shapes(bounce.rows, bounce.nodes, lighting); !checked)
    return tl::unexpected(checked.error());
  if (auto checked = check_rows(bounce, lighting.albedo); !checked) return tl::unexpected(checked.error());
  SolutionBracket result;
  auto grown = grow(bounce, lighting, start, go_on, result.products);
  if (!grown) return tl::unexpected(grown.error());
  auto narrowed = narrow(bounce, lighting, std::move(*grown), go_on, result.products);
  if (!narrowed) return tl::unexpected(narrowed.error());
  result.radiosity = std::move(*narrowed);
  result.irradiance = arriving(matrices.gather, lighting, result.radiosity);
  return result;
}

std::vector<double> relative_widths(const Bracket& bracket, const std::vector<Rgb>& values) {
  std::vector<double> widths;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = sum_of(values[i]);
    widths.push_back(value > 0.0 ? sum_of(bracket.high[i] - bracket.low[i]) / value : 0.0);
  }
  return widths;
}

}  // namespace relume
