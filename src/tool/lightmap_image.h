// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/model.h"
#include "tool/image.h"

namespace relume {

/// How many texels a chart grows beyond its border, so that bilinear filtering and one mip level stay inside.
inline constexpr int kDilation = 4;

/// The lightmap of a system from one value per lumel (lux or any other unit). Texels without a valid lumel
/// take the mean of their neighbours that have a value, ring by ring: kDilation rings around charts, and as
/// many as it takes for invalid lumels. The rest is black.
ColorImage lightmap_image(const System& system, std::span<const Rgb> lumel_values);

}  // namespace relume
