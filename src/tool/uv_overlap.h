// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/model.h"

namespace relume {

/// Per lumel of system `s`, 0 to 1: of the places of its texel that its surface covers (16 are looked at),
/// the share where two triangles lie one over the other in the lightmap, so that two surfaces share the light
/// of one. NaN of a lumel whose node has no TEXCOORD_1 in use: charts made by Relume do not overlap.
std::vector<double> uv_overlaps(const Model& model, std::size_t s);

}  // namespace relume
