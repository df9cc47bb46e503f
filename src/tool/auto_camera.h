// SPDX-License-Identifier: MIT
#pragma once

#include "tool/preview.h"

namespace relume {

/// The scene's camera when it sees something, else one of many tried: eyes in the free space in front of
/// surfaces, and around the whole from outside; the view wins that shows the most lit, varied and deep
/// picture. The same model and lighting give the same camera.
Camera choose_camera(const ViewedScene& scene);

}  // namespace relume
