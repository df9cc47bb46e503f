// SPDX-License-Identifier: MIT
//
// Which texels of a lightmap show which lumels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/model.h"

namespace relume {

/// How many texels a chart grows beyond its border, so that bilinear filtering and one mip level stay inside.
inline constexpr std::uint32_t kDilation = 4;

struct LightmapTexel {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
};

/// Texels that carry a value, each with the lumels whose mean it is. All others stay as they are.
struct LightmapTexels {
  std::vector<LightmapTexel> texels;       ///< row by row
  std::vector<std::uint32_t> first_lumel;  ///< per texel into `lumels`, and the end
  std::vector<std::uint32_t> lumels;  ///< indices into System::lumels, which are rows of the gather matrix
};

/// A valid lumel is its own texel. Charts grow by `dilation` rings, and invalid lumels are filled ring by
/// ring as far as they go. A texel that a ring adds takes, of the lumels that its neighbours of the rings
/// before show, the nearest; the mean of several at the same distance.
LightmapTexels lightmap_texels(const System& system, std::uint32_t dilation = kDilation);

}  // namespace relume
