// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace relume {

/// What a lightmap shows and how it stores it (kernels/shared/pack_texel.h).
enum class LightmapFormat : std::uint32_t {
  rgba16f,     ///< irradiance: VK_FORMAT_R16G16B16A16_SFLOAT, alpha 1; relative error up to 2^-11
  r11g11b10f,  ///< VK_FORMAT_B10G11R11_UFLOAT_PACK32; up to 2^-7 in red and green, 2^-6 in blue
  rgb9e5,      ///< VK_FORMAT_E5B9G9R9_UFLOAT_PACK32; up to 2^-9 of the largest channel
  /// No irradiance: dominant_direction() of the indirect irradiance (core/directional_irradiance.h), of a
  /// directional model; VK_FORMAT_R16G16B16A16_SFLOAT, alpha 1.
  direction_rgba16f,
};

}  // namespace relume
