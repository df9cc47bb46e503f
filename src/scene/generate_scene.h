// SPDX-License-Identifier: MIT
//
// Relume's own small scenes: the demo, and those that tests and benchmarks know the answer of. Metres, cd and
// cd/m2. Rooms are single-sided and look inwards; one node per named surface, with a material of the same
// name.
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "scene/write_glb.h"

namespace relume {

/// All names that generate_scene knows:
///   demo              a furnished room of 5 x 2.7 x 6 m with a bright window, a lamp panel, a floor lamp and
///   a camera furnace_box       1 x 1 x 1, albedo 0.5, radiance 1 everywhere: B = 2 pi furnace_sphere    the
///   same for a sphere of radius 1, tessellated cap_sphere        a sphere of radius 1, albedo 0.5, of which
///   the upper cap of 40 degrees has radiance 10 two_rooms         a lit and a dark room with a doorway of
///   0.9 x 2 m, boxes, coloured walls, lamp panel and point light two_rooms_sealed  the same without the
///   doorway lamp_room         4 x 2.5 x 4, albedo 0.5, a lamp of 0.3 x 0.3 m and radiance 1000 flush in the
///   middle of the ceiling light_plane       a plane of 10 x 10 m that looks up, around the origin
std::vector<std::string> scene_names();

/// Error (usage) with all names when `name` is none of them.
Result<GlbScene> generate_scene(const std::string& name);

/// Appends a node with one mesh of one new material, all called `name`.
void add_surface(GlbScene& scene, const std::string& name, const Rgb& albedo, GlbPrimitive mesh,
                 const Rgb& radiance = Rgb(0.0), bool double_sided = false);

/// The scene `demo`.
GlbScene demo_scene();

}  // namespace relume
