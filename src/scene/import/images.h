// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/result.h"
#include "core/sky.h"
#include "scene/scene.h"

namespace relume {

/// Decodes PNG or JPEG to 8-bit RGBA. Size is read and checked before any pixel is. `place` is used in
/// messages.
Result<SceneImage> decode_image(std::span<const std::byte> encoded, std::uint64_t max_pixels,
                                const std::string& file, const std::string& place);

/// Decodes Radiance .hdr to linear RGB. Values are as stored, not yet checked.
Result<EquirectangularSky> decode_hdr(std::span<const std::byte> encoded, std::uint64_t max_pixels,
                                      const std::string& file);

}  // namespace relume
