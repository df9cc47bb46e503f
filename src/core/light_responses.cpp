// SPDX-License-Identifier: MIT
#include "core/light_responses.h"

namespace relume {

std::vector<Rgb> combine_responses(std::span<const std::vector<Rgb>> responses, std::span<const Rgb> colors) {
  std::vector<Rgb> sum(responses.empty() ? 0 : responses[0].size(), Rgb(0.0));
  for (std::size_t light = 0; light < responses.size(); ++light) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += colors[light] * responses[light][i];
  }
  return sum;
}

}  // namespace relume
