// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/lightmap_texels.h"
#include "core/model.h"
#include "tool/image.h"

namespace relume {

/// The lightmap of a system from one value per lumel (lux or any other unit), filled as lightmap_texels says.
/// The rest is black.
ColorImage lightmap_image(const System& system, std::span<const Rgb> lumel_values);

}  // namespace relume
