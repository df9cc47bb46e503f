// SPDX-License-Identifier: MIT
#include "core/bracket.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "core/sender_product.h"

namespace relume {
namespace {

constexpr double kLeft = 1e-6;

struct Interval {
  Rgb low{0.0};
  Rgb high{0.0};
};

/// Rows and how far their values may be off, of one pattern.
struct LooseRows {
  const CsrMatrix& rows;
  const CsrMatrix& slack;
  const CsrMatrix& nodes;
};

Interval hull_of(const CsrMatrix& nodes, std::uint32_t node, const std::vector<Interval>& leaves) {
  const auto begin = nodes.row_offsets[node], end = nodes.row_offsets[node + 1];
  Interval hull = leaves[nodes.column_indices[begin]];
  for (std::uint64_t e = begin + 1; e < end; ++e) {
    hull.low = glm::min(hull.low, leaves[nodes.column_indices[e]].low);
    hull.high = glm::max(hull.high, leaves[nodes.column_indices[e]].high);
  }
  return hull;
}

/// Of all senders: leaves, then nodes.
std::vector<Interval> senders(const CsrMatrix& nodes, const std::vector<Interval>& clusters,
                              const std::vector<Rgb>& sky) {
  std::vector<Interval> all = clusters;
  for (const Rgb& patch : sky) all.push_back({patch, patch});
  for (std::uint32_t node = 0; node < nodes.rows; ++node) all.push_back(hull_of(nodes, node, all));
  return all;
}

/// The differences between stored and true values of a row sum to zero, so it is only the distance of senders
/// from any middle that they weigh.
Interval arriving(const LooseRows& matrix, std::uint32_t row, const std::vector<Interval>& b) {
  const CsrMatrix& rows = matrix.rows;
  const auto begin = rows.row_offsets[row], end = rows.row_offsets[row + 1];
  Interval sum;
  double total = 0.0;
  for (std::uint64_t e = begin; e < end; ++e) {
    sum.low += rows.values[e] * b[rows.column_indices[e]].low;
    sum.high += rows.values[e] * b[rows.column_indices[e]].high;
    total += rows.values[e];
  }
  if (total <= 0.0) return sum;
  const Rgb middle = (sum.low + sum.high) / (2.0 * total);
  Rgb loose(0.0);
  for (std::uint64_t e = begin; e < end; ++e) {
    const Interval& sender = b[rows.column_indices[e]];
    loose += matrix.slack.values[e] * glm::max(glm::abs(sender.high - middle), glm::abs(sender.low - middle));
  }
  return {glm::max(sum.low - loose, Rgb(0.0)), sum.high + loose};
}

/// Per cluster, what an iteration makes at most of a change of `change` in all interval ends.
std::vector<Rgb> grown(const LooseRows& matrix, const std::vector<Rgb>& albedo,
                       const std::vector<Rgb>& change) {
  std::vector<Interval> clusters;
  for (const Rgb& value : change) clusters.push_back({value, value});
  const std::size_t sky = matrix.nodes.columns - clusters.size();
  const std::vector<Interval> b = senders(matrix.nodes, clusters, std::vector<Rgb>(sky, Rgb(0.0)));
  std::vector<Rgb> next(change.size());
  for (std::uint32_t row = 0; row < next.size(); ++row) {
    // A middle changes by no more than the senders' mean: once for them, once for it.
    Rgb sum(0.0), middle(0.0);
    double total = 0.0, loose = 0.0;
    for (std::uint64_t e = matrix.rows.row_offsets[row]; e < matrix.rows.row_offsets[row + 1]; ++e) {
      const Rgb& sender = b[matrix.rows.column_indices[e]].high;
      middle += matrix.rows.values[e] * sender;
      total += matrix.rows.values[e];
      sum += (matrix.rows.values[e] + matrix.slack.values[e]) * sender;
      loose += matrix.slack.values[e];
    }
    next[row] = albedo[row] * (sum + (total > 0.0 ? loose / total : 0.0) * middle);
  }
  return next;
}

/// Weights w > 0, and the factor by which an iteration brings sets of intervals closer in the norm
/// max |x_i| / w_i, the worst channel: the map is monotone, homogeneous and subadditive, so max grown(w) / w
/// bounds it.
struct Contraction {
  std::vector<Rgb> weights;
  double factor = 0.0;
};

double largest_ratio(const std::vector<Rgb>& values, const std::vector<Rgb>& weights) {
  Rgb ratio(0.0);
  for (std::size_t i = 0; i < values.size(); ++i) ratio = glm::max(ratio, values[i] / weights[i]);
  return std::max({ratio.x, ratio.y, ratio.z});
}

Contraction contraction(const LooseRows& matrix, const std::vector<Rgb>& albedo) {
  constexpr int kTries = 20;
  constexpr double kEnough = 0.02, kLeast = 1e-3;
  Contraction best{std::vector<Rgb>(albedo.size(), Rgb(1.0)), 0.0};
  std::vector<Rgb> image = grown(matrix, albedo, best.weights);
  best.factor = largest_ratio(image, best.weights);
  for (int tries = 0; tries < kTries; ++tries) {
    const Rgb most = glm::max(largest(image), Rgb(1e-30));
    std::vector<Rgb> weights(image);
    for (Rgb& weight : weights) weight = glm::max(weight / most, Rgb(kLeast));
    image = grown(matrix, albedo, weights);
    const double factor = largest_ratio(image, weights);
    const bool settled = factor > best.factor - kEnough * (1.0 - factor);
    if (factor < best.factor) best = {std::move(weights), factor};
    if (settled && best.factor < 1.0) break;
  }
  return best;
}

std::vector<Interval> iterate(const LooseRows& matrix, const Lighting& lighting,
                              const std::vector<Interval>& clusters) {
  const std::vector<Interval> b = senders(matrix.nodes, clusters, lighting.sky_radiosity);
  std::vector<Interval> next(clusters.size());
  for (std::uint32_t row = 0; row < next.size(); ++row) {
    const Interval irradiance = arriving(matrix, row, b);
    const auto leaving = [&](const Rgb& arriving_light) {
      return lighting.exitance[row] + lighting.albedo[row] * (lighting.direct[row] + arriving_light);
    };
    next[row] = {leaving(irradiance.low), leaving(irradiance.high)};
  }
  return next;
}

std::vector<Rgb> changes(const std::vector<Interval>& before, const std::vector<Interval>& after) {
  std::vector<Rgb> change;
  for (std::size_t i = 0; i < after.size(); ++i)
    change.push_back(
        glm::max(glm::abs(after[i].low - before[i].low), glm::abs(after[i].high - before[i].high)));
  return change;
}

Bracket to_bracket(const std::vector<Interval>& intervals) {
  Bracket bracket;
  for (const Interval& interval : intervals) {
    bracket.low.push_back(interval.low);
    bracket.high.push_back(interval.high);
  }
  return bracket;
}

Bracket gathered(const LooseRows& matrix, const Lighting& lighting, const std::vector<Interval>& clusters) {
  const std::vector<Interval> b = senders(matrix.nodes, clusters, lighting.sky_radiosity);
  std::vector<Interval> rows(matrix.rows.rows);
  for (std::uint32_t row = 0; row < rows.size(); ++row) rows[row] = arriving(matrix, row, b);
  return to_bracket(rows);
}

}  // namespace

Result<SolutionBracket> bracket_solution(const ReferenceMatrices& matrices, const ReferenceMatrices& slack,
                                         const Lighting& lighting, const std::vector<Rgb>& start,
                                         const std::function<bool()>& go_on) {
  if (auto checked = check_shapes(matrices.bounce, lighting); !checked)
    return tl::unexpected(checked.error());
  const LooseRows rows{matrices.bounce.rows, slack.bounce.rows, matrices.bounce.nodes};
  const Contraction norm = contraction(rows, lighting.albedo);
  if (norm.factor >= 1.0) {
    return fail(
        ErrorCode::check_failed,
        fmt::format("no bounds: the factor by which an iteration brings intervals closer, with all that the "
                    "precision of form factors leaves open, expected below 1, found {:.6g}",
                    norm.factor));
  }
  std::vector<Interval> clusters;
  for (const Rgb& value : start) clusters.push_back({value, value});
  const Rgb brightest = largest(start);
  const double enough = kLeft * std::max({brightest.x, brightest.y, brightest.z});
  SolutionBracket result;
  double left = 0.0;
  do {
    if (go_on && !go_on()) return fail(ErrorCode::cancelled, "cancelled while bounds were iterated");
    std::vector<Interval> next = iterate(rows, lighting, clusters);
    left = largest_ratio(changes(clusters, next), norm.weights) * norm.factor / (1.0 - norm.factor);
    clusters = std::move(next);
    ++result.products;
  } while (left > enough);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    clusters[i].low = glm::max(clusters[i].low - left * norm.weights[i], Rgb(0.0));
    clusters[i].high += left * norm.weights[i];
  }
  result.radiosity = to_bracket(clusters);
  result.irradiance =
      gathered({matrices.gather.rows, slack.gather.rows, matrices.gather.nodes}, lighting, clusters);
  return result;
}

std::vector<double> relative_widths(const Bracket& bracket, const std::vector<Rgb>& values) {
  const auto sum = [](const Rgb& value) { return value.x + value.y + value.z; };
  std::vector<double> widths;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = sum(values[i]);
    widths.push_back(value > 0.0 ? sum(bracket.high[i] - bracket.low[i]) / value : 0.0);
  }
  return widths;
}

}  // namespace relume
