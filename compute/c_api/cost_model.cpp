// SPDX-License-Identifier: MIT
#include "compute/cost_model.h"

#include <algorithm>
#include <vector>

#include "compute/relume.h"

relume_cost_model relume_fit_cost_model(const relume_frame_time* frames, uint32_t count) {
  std::vector<relume::FrameTime> samples;
  for (std::uint32_t i = 0; i < count; ++i) samples.push_back({frames[i].form_factors, frames[i].seconds});
  const relume::CostModel fitted = relume::fit_cost_model(samples);
  return {fitted.per_frame, fitted.per_form_factor};
}

uint64_t relume_form_factors_within(const relume_cost_model* model, double seconds) {
  const relume::CostModel known{model->per_frame, model->per_form_factor};
  return std::max<std::uint64_t>(relume::form_factors_within(known, seconds), 1);
}
