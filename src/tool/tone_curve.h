// SPDX-License-Identifier: MIT
//
// From radiance to what a screen shows: automatic exposure by the log-average of the luminance, and the curve
// of E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, Photographic Tone Reproduction for Digital Images, 2002,
// equation 4, on luminance.
#pragma once

#include <span>

#include "core/quantities.h"
#include "tool/image.h"

namespace relume {

struct ToneCurve {
  double exposure = 1.0;  ///< multiplies radiance (cd/m2)
  double white = 4.0;     ///< exposed luminance that becomes white
};

/// Exposure for what the samples show; black ones (below 1e-6 of the mean) do not count. Black all over gives
/// exposure 1.
ToneCurve fit_tone_curve(std::span<const Rgb> radiance);

/// Display-linear colour, 0..1.
Rgb tone_mapped(const ToneCurve& curve, const Rgb& radiance);

}  // namespace relume
