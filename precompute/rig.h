// SPDX-License-Identifier: MIT
//
// The stated rig: what a scene is lit with that brings no light of its own.
#pragma once

#include <string>
#include <vector>

#include "core/model.h"
#include "precompute/enclosed_grid.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"
#include "scene/scene.h"

namespace relume {

/// Fills Model::lights from the scene, or, when the scene has neither light nor emission, from the rig: a
/// point light of 1000 cd in each enclosed room, 0.3 m below its highest free point, where that sees most of
/// the room (half-way up where the room is lower than 0.6 m); and where there is no enclosed room, or most of
/// the surface looks out into the open, a sun of 50 000 lx from (0.4, 1, 0.3) and a sky of 1000 cd/m2. Rooms
/// are found on a coarse grid of points: a point is enclosed when at most a fifth of the directions around it
/// escape; rooms are what sees each other. A warning names the rig. `earlier` may be missing; `looked`, if
/// any, gets the grid where rooms were looked for.
void light_model(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
                 const EarlierLooks* earlier, Model& model, std::vector<std::string>& warnings,
                 EnclosedGrid* looked = nullptr);

}  // namespace relume
