// SPDX-License-Identifier: MIT
//
// Lightmaps for engines: a 2D image of one level in a KTX 2.0 file (Khronos Group, KTX File Format
// Specification 2.0, 2023; Data Format Specification 1.3, 2022), in the formats and with the rounding of the
// device's lightmaps.
#pragma once

#include <cstddef>
#include <vector>

#include "compute/lightmap_format.h"
#include "tool/image.h"

namespace relume {

/// Linear Rec.709, row 0 on top; not compressed. Values above the largest of the format are lowered to it.
std::vector<std::byte> encode_ktx2(const ColorImage& image, LightmapFormat format);

}  // namespace relume
