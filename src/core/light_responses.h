// SPDX-License-Identifier: MIT
//
// Light adds up. As long as albedo, geometry and the places of lights stay, irradiance is linear in what they
// emit:
//
//   I = sum_k c_k R_k
//
// R_k, the *response* to light k: irradiance when it alone shines, white and with an intensity of 1; c_k: its
// colour times its intensity, channel by channel. A light is anything that is switched together: a lamp, a
// group of emissive surfaces, the sky.
#pragma once

#include <span>
#include <vector>

#include "core/quantities.h"

namespace relume {

/// Per gather row, or per cluster (then of radiosity). `responses` are of equal size; one colour for each.
std::vector<Rgb> combine_responses(std::span<const std::vector<Rgb>> responses, std::span<const Rgb> colors);

}  // namespace relume
