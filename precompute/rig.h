// SPDX-License-Identifier: MIT
//
// The stated rig: what a scene is lit with that brings no light of its own.
#pragma once

#include <string>
#include <vector>

#include "core/model.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"
#include "scene/scene.h"

namespace relume {

/// A point light of 1000 cd in each enclosed room, 0.3 m below its highest free point, where that sees most
/// of the room (half-way up where the room is lower than 0.6 m). Empty when the scene has no enclosed room.
/// Rooms are found on a coarse grid of points: a point is enclosed when at most a fifth of the directions
/// around it escape; rooms are what sees each other.
std::vector<Light> room_lights(const Geometry& geometry, const RayCaster& caster);

/// Fills Model::lights from the scene, or, when the scene has neither light nor emission, from the rig:
/// room_lights; and where there are none, or most of the surface looks out into the open, a sun of 50 000 lx
/// from (0.4, 1, 0.3) and a sky of 1000 cd/m2. A warning names the rig.
void light_model(const Scene& scene, const Geometry& geometry, const RayCaster& caster, Model& model,
                 std::vector<std::string>& warnings);

}  // namespace relume
