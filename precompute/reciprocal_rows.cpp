// SPDX-License-Identifier: MIT
#include "precompute/reciprocal_rows.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace relume {
namespace {

constexpr double kCloseEnough = 1e-7;  ///< of a row's sum; form factors are stored with 24 bits
constexpr double kMostScale = 2.0;
constexpr std::uint32_t kMostIterations = 1000;
constexpr double kMostLeft = 0.1;  ///< of the area

struct Entry {
  std::uint32_t cluster = 0;
  double value = 0.0;
};
using Rows = std::vector<std::vector<Entry>>;

template <class Body>
void for_each_row(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

/// S, without the sky.
Rows fluxes(std::span<const ProjectedRow> rows) {
  Rows out(rows.size());
  for_each_row(rows.size(), [&](std::size_t i) {
    const FormFactorRow& row = *rows[i].row;
    for (std::size_t e = 0; e < row.senders.size() && row.senders[e] < rows.size(); ++e)
      out[i].push_back({row.senders[e], rows[i].area * double(row.values[e])});
  });
  return out;
}

Rows transposed(const Rows& rows) {
  Rows out(rows.size());
  for (std::uint32_t i = 0; i < rows.size(); ++i) {
    for (const Entry& entry : rows[i]) out[entry.cluster].push_back({i, entry.value});
  }
  return out;
}

/// Calls `body` with the column and both values, 0 where one has none.
template <class Body>
void for_each_of_both(const std::vector<Entry>& a, const std::vector<Entry>& b, const Body& body) {
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    if (j == b.size() || (i < a.size() && a[i].cluster < b[j].cluster)) {
      body(a[i].cluster, a[i].value, 0.0);
      ++i;
    } else if (i == a.size() || b[j].cluster < a[i].cluster) {
      body(b[j].cluster, 0.0, b[j].value);
      ++j;
    } else {
      body(a[i].cluster, a[i].value, b[j].value);
      ++i, ++j;
    }
  }
}

/// S', and in `projection` how far S is from its transpose.
Rows averaged(std::span<const ProjectedRow> rows, const Rows& flux, Projection& projection) {
  const Rows other = transposed(flux);
  Rows out(rows.size());
  std::vector<double> differences(rows.size()), sums(rows.size());
  for_each_row(rows.size(), [&](std::size_t i) {
    for_each_of_both(flux[i], other[i], [&](std::uint32_t j, double mine, double theirs) {
      const double own = rows[i].rays / rows[i].area, its = rows[j].rays / rows[j].area;
      out[i].push_back({j, own + its > 0.0 ? (own * mine + its * theirs) / (own + its) : mine});
      differences[i] += (mine - theirs) * (mine - theirs);
      sums[i] += (mine + theirs) * (mine + theirs);
    });
  });
  double difference = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) difference += differences[i], sum += sums[i];
  projection.asymmetry = sum > 0.0 ? std::sqrt(difference / sum) : 0.0;
  return out;
}

double scaled_sum(const std::vector<Entry>& row, const std::vector<double>& scale) {
  double sum = 0.0;
  for (const Entry& entry : row) sum += entry.value * scale[entry.cluster];
  return sum;
}

bool at_limit(double scale) {
  return scale <= 1.0 / kMostScale || scale >= kMostScale;
}

/// D, such that the rows of D S D add up to `totals`, or lie at its limits.
std::vector<double> symmetric_scaling(const Rows& rows, const std::vector<double>& totals,
                                      Projection& projection) {
  std::vector<double> scale(rows.size(), 1.0), next(rows.size()), off(rows.size());
  for (; projection.iterations < kMostIterations; ++projection.iterations) {
    for_each_row(rows.size(), [&](std::size_t i) {
      const double found = scale[i] * scaled_sum(rows[i], scale);
      const double wanted = found > 0.0 ? scale[i] * std::sqrt(totals[i] / found) : scale[i];
      next[i] = std::clamp(wanted, 1.0 / kMostScale, kMostScale);
      off[i] = found > 0.0 && !at_limit(next[i]) ? std::abs(found - totals[i]) / found : 0.0;
    });
    if (off.empty() || *std::max_element(off.begin(), off.end()) <= kCloseEnough) break;
    scale.swap(next);
  }
  return scale;
}

/// Per row, what D S D is multiplied by so that its sum is that of `totals` where D did not reach it.
std::vector<double> repairs(std::span<const ProjectedRow> targets, const Rows& rows,
                            const std::vector<double>& totals, const std::vector<double>& scale,
                            Projection& projection) {
  std::vector<double> repair(rows.size(), 1.0);
  double left = 0.0, area = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double found = scale[i] * scaled_sum(rows[i], scale);
    area += targets[i].area;
    if (std::abs(found - totals[i]) <= 2.0 * kCloseEnough * found) continue;
    repair[i] = totals[i] / found;
    left += targets[i].area;
  }
  projection.left = area > 0.0 ? left / area : 0.0;
  return repair;
}

/// S'' into the rows; what changed of S, squared, into `change`.
void write_row(const ProjectedRow& target, std::size_t i, const std::vector<Entry>& row,
               const std::vector<Entry>& before, const std::vector<double>& scale, double repair,
               double& change) {
  FormFactorRow out;
  for_each_of_both(row, before, [&](std::uint32_t j, double value, double old) {
    const double flux = repair * scale[i] * value * scale[j];
    change += (flux - old) * (flux - old);
    if (flux <= 0.0) return;
    out.senders.push_back(j);
    out.values.push_back(static_cast<float>(flux / target.area));
  });
  const FormFactorRow& old = *target.row;
  for (std::size_t e = 0; e < old.senders.size(); ++e) {
    if (old.senders[e] < scale.size()) continue;
    out.senders.push_back(old.senders[e]);
    out.values.push_back(old.values[e]);
  }
  *target.row = std::move(out);
}

}  // namespace

Result<Projection> project_to_reciprocity(std::span<const ProjectedRow> rows) {
  Projection projection;
  const Rows flux = fluxes(rows);
  const Rows mean = averaged(rows, flux, projection);
  std::vector<double> totals(rows.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const Entry& entry : flux[i]) totals[i] += entry.value, squares += entry.value * entry.value;
  }
  const std::vector<double> scale = symmetric_scaling(mean, totals, projection);
  const std::vector<double> repair = repairs(rows, mean, totals, scale, projection);
  if (projection.left > kMostLeft) {
    return fail(
        ErrorCode::check_failed,
        fmt::format("no symmetric scaling of the form factors keeps their row sums: expected it for at "
                    "least {:.0f} % of the area, found {:.2g} %",
                    100.0 * (1.0 - kMostLeft), 100.0 * (1.0 - projection.left)));
  }
  std::vector<double> changes(rows.size());
  for_each_row(rows.size(),
               [&](std::size_t i) { write_row(rows[i], i, mean[i], flux[i], scale, repair[i], changes[i]); });
  double change = 0.0;
  for (const double of_row : changes) change += of_row;
  projection.change = squares > 0.0 ? std::sqrt(change / squares) : 0.0;
  return projection;
}

}  // namespace relume
