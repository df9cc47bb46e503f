// SPDX-License-Identifier: MIT
#include "precompute/adaptive_row.h"

#include <algorithm>
#include <cmath>

#include "precompute/cut.h"
#include "precompute/rows.h"

namespace relume {
namespace {

void add_light(const Probing& probing, const FormFactorRow& row, float sign, ProbingValues& sums) {
  for (std::size_t i = 0; i < row.senders.size(); ++i) {
    const ProbingValues& radiosity = probing.senders[row.senders[i]];
    const float factor = sign * row.values[i];
    for (std::size_t p = 0; p < kProbings; ++p) sums[p] += factor * radiosity[p];
  }
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
    add_light(probing, halves.first.row, 0.5f, difference);
    add_light(probing, halves.second.row, -0.5f, difference);
    const ProbingValues& weights = weights_of_room(probing, room_of(probing, halves.first.row));
    for (std::size_t p = 0; p < kProbings; ++p) {
      const double error = double(difference[p] * weights[p]);
      squares += error * error;
    }
  }
  return count > 0.0 ? std::sqrt(squares / (count * double(kProbings))) : 0.0;
}

}  // namespace relume
