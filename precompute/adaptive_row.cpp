// SPDX-License-Identifier: MIT
#include "precompute/adaptive_row.h"

#include <algorithm>
#include <cmath>

#include "precompute/cut.h"
#include "precompute/rows.h"
#include "precompute/weighted_sums.h"

namespace relume {
namespace {

/// Two halves that together fill the hemisphere more evenly than each: the square of half their difference is
/// on average so many times the variance of their mean (1 for independent points, as which the few samples of
/// emitters count).
const double kHalvesOverMean = std::exp2(kNoiseExponent) - 1.0;

/// What one row makes of each probing: sums of form factor x radiosity, and of form factor x its square.
struct ProbedLight {
  ProbingValues light{}, squares{};
};

/// Of senders that are no possible emitters, and of those that are.
std::array<ProbedLight, 2> probed_light(const Probing& probing, const Emitters& emitters,
                                        const FormFactorRow& row) {
  std::array<ProbedLight, 2> sums{};
  const std::size_t clusters = emitters.of_cluster.size();  // cells of the sky come after them
  for (std::size_t i = 0; i < row.senders.size(); ++i) {
    ProbedLight& own = sums[row.senders[i] < clusters && emitters.contain(row.senders[i]) ? 1 : 0];
    const ProbingValues& radiosity = probing.senders[row.senders[i]];
    for (std::size_t p = 0; p < kProbings; ++p) {
      const float light = row.values[i] * radiosity[p];
      own.light[p] += light;
      own.squares[p] += light * radiosity[p];
    }
  }
  return sums;
}

}  // namespace

FormFactorRow RowMean::finish() {
  FormFactorRow row;
  row.senders.reserve(touched_.size());
  row.values.reserve(row.senders.capacity());
  touched_.drain([&](std::uint32_t sender) {
    row.senders.push_back(sender);
    row.values.push_back(float(sums_[sender] / weight_));
    sums_[sender] = 0.0;
    if (moments_.empty()) return;
    row.moments.emplace_back(moments_[sender] / weight_);
    moments_[sender] = glm::dvec3(0.0);
  });
  weight_ = 0.0;
  return row;
}

double row_noise(const Probing& probing, std::span<const RowHalves> rows) {
  double squares = 0.0, count = 0.0;
  for (const RowHalves& halves : rows) {
    if (halves.first.back_face_share + halves.second.back_face_share > 2.0f * kInvalidShare) continue;
    count += 1.0;
    ProbingValues difference{};
    add_weighted(halves.first.row.senders, halves.first.row.values, probing.senders, difference);
    for (float& value : difference) value = -value;
    add_weighted(halves.second.row.senders, halves.second.row.values, probing.senders, difference);
    const ProbingValues& weights = weights_of_room(probing, room_of(probing, halves.first.row));
    for (std::size_t p = 0; p < kProbings; ++p) {
      const double error = 0.5 * double(difference[p] * weights[p]);
      squares += error * error;
    }
  }
  return count > 0.0 ? std::sqrt(squares / (count * double(kProbings))) : 0.0;
}

VarianceShares variance_shares(const Probing& probing, const Emitters& emitters,
                               std::span<const RowHalves> rows, std::uint32_t rays) {
  std::array<double, 2> found{}, independent{};
  for (const RowHalves& halves : rows) {
    if (halves.first.back_face_share + halves.second.back_face_share > 2.0f * kInvalidShare) continue;
    const auto first = probed_light(probing, emitters, halves.first.row);
    const auto second = probed_light(probing, emitters, halves.second.row);
    const ProbingValues& weights = weights_of_room(probing, room_of(probing, halves.first.row));
    for (std::size_t kind = 0; kind < first.size(); ++kind) {
      for (std::size_t p = 0; p < kProbings; ++p) {
        const double weight = double(weights[p]) * double(weights[p]);
        const double mean = 0.5 * (double(first[kind].light[p]) + double(second[kind].light[p]));
        const double half = 0.5 * (double(first[kind].light[p]) - double(second[kind].light[p]));
        const double squares = 0.5 * (double(first[kind].squares[p]) + double(second[kind].squares[p]));
        found[kind] += weight * half * half;
        independent[kind] += weight * std::max(0.0, squares - mean * mean) / double(rays);
      }
    }
  }
  const auto share = [&](std::size_t kind, double halves_over_mean) {
    return independent[kind] > 0.0 ? float(found[kind] / (halves_over_mean * independent[kind])) : 1.0f;
  };
  return {share(0, kHalvesOverMean), share(1, 1.0)};
}

}  // namespace relume
