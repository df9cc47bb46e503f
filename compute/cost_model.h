// SPDX-License-Identifier: MIT
//
// Form factors into time and back. The host measures frames (timestamps around what record_frame recorded)
// and fits; nothing of it happens while a frame is recorded.
#pragma once

#include <cstdint>
#include <span>

namespace relume {

/// A frame that was measured.
struct FrameTime {
  std::uint64_t form_factors = 0;  ///< FramePlan::cost
  double seconds = 0.0;
};

/// seconds = per_frame + per_form_factor * form factors.
struct CostModel {
  double per_frame = 0.0;
  double per_form_factor = 0.0;
};

/// Least squares over the samples, each weighted by 1 / seconds^2 (relative errors count), with neither
/// coefficient below 0. Samples without time are left out; when the rest cannot tell both coefficients apart
/// (fewer than two, or all of one size), per_frame is 0. All 0 without a sample.
CostModel fit_cost_model(std::span<const FrameTime> samples);

/// Form factors that fit into `seconds`; 0 when not even an empty frame does, all of them when the model
/// knows no cost.
std::uint64_t form_factors_within(const CostModel& model, double seconds);

}  // namespace relume
