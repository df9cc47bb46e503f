// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "precompute/probing.h"
#include "precompute/row_tracer.h"
#include "precompute/sender_set.h"

namespace relume {

/// Weighted mean of rows, gathered densely. All of its rows have moments or none.
class RowMean {
 public:
  explicit RowMean(std::size_t senders) : sums_(senders, 0.0), touched_(senders) {}
  void add(const FormFactorRow& row, double weight) {
    weight_ += weight;
    if (!row.moments.empty()) moments_.resize(sums_.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < row.senders.size(); ++i) {
      sums_[row.senders[i]] += weight * double(row.values[i]);
      touched_.insert(row.senders[i]);
    }
    for (std::size_t i = 0; i < row.moments.size(); ++i)
      moments_[row.senders[i]] += weight * glm::dvec3(row.moments[i]);
  }
  FormFactorRow finish();

 private:
  std::vector<double> sums_;
  std::vector<glm::dvec3> moments_;  ///< empty until a row has some
  SenderSet touched_;
  double weight_ = 0.0;
};

/// Two rows of one receiver, each of half of its rays: one half of the sequence after the other.
struct RowHalves {
  TracedRow first, second;
};

/// The variance of a row falls with this power of its rays: that of stratified points in two dimensions whose
/// light has edges (D. Mitchell, Consequences of Stratified Sampling in Graphics, 1996).
inline constexpr double kNoiseExponent = 1.5;

/// By how much the irradiance of the rows is uncertain, relative to that of their room: root mean square over
/// rows and probes of half the difference of the halves. Of points that avoid each other this is more than
/// the error of their mean.
double row_noise(const Probing& probing, std::span<const RowHalves> rows);

/// The same as a variance that other lights can be scaled from (core/ray_noise.h): that of the mean of both
/// halves, of `rays` in all, in the variance of as many independent rays; over all rows and probes. 1 where
/// there is no light to tell it by.
VarianceShares variance_shares(const Probing& probing, const Emitters& emitters,
                               std::span<const RowHalves> rows, std::uint32_t rays);

}  // namespace relume
