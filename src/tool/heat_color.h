// SPDX-License-Identifier: MIT
#pragma once

#include <glm/common.hpp>

#include "core/quantities.h"

namespace relume {

/// Display-linear colour of a share: black 0, through red and yellow to white 1 and above.
inline Rgb heat_color(double share) {
  return glm::clamp(Rgb(3.0 * share, 3.0 * share - 1.0, 3.0 * share - 2.0), Rgb(0.0), Rgb(1.0));
}

}  // namespace relume
