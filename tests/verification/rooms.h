// SPDX-License-Identifier: MIT
//
// The rooms that the precompute is verified on, as values.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace relume::test {

/// One surface everywhere: `albedo` and emitted radiance in all channels.
struct UniformSurface {
  double albedo = 0.5;
  double radiance = 0.0;
};

/// Cube of 1 m, its faces as nodes "cube/-x" and so on.
Scene unit_cube(const UniformSurface& surface = {});

/// 5 x 2.5 x 4 m.
Scene box_room(const UniformSurface& surface);

/// An L of 5 x 4 m with a quarter missing, 2.5 m high; floor and ceiling are two quads each that share an
/// edge.
Scene l_room(const UniformSurface& surface);

/// Sphere of 1 m seen from inside, `rings` x 2 `rings` faces. Material 0 "wall", and where y > `cap_height`
/// material 1 "cap".
Scene sphere_room(std::uint32_t rings, double cap_height, const UniformSurface& wall,
                  const UniformSurface& cap);

/// A box room with a table on legs, a cabinet and a shelf on a wall, all of one material.
Scene furnished_room(const UniformSurface& surface);

/// Two rooms side by side, 4 + 3.5 m x 2.6 m x 3.2 m, joined by a door in a wall of 10 cm; boxes stand in
/// both, a lamp of 0.6 x 0.3 m hangs in each, walls are coloured (albedo 0.3 to 0.8).
Scene two_rooms();
/// Boxes that stand in two_rooms(): no place for sensors.
struct Footprint {
  double x0, x1, z0, z1;
};
std::vector<Footprint> two_rooms_footprints();
/// Other colours and lamps on the same geometry.
Scene two_rooms_recoloured();

/// Two closed rooms of 2 x 2 x 2 m and 3.1 x 2 x 2 m, side by side along x, that share one floor, one ceiling
/// and both side walls (one quad each); `thickness` metres of hollow wall between them. Lit: a lamp in the
/// room at x < 2. (Of two equal rooms, whatever halves surfaces would meet the wall by chance.)
Scene sealed_rooms(double thickness);

/// One room of 4 x 2.5 x 4 m with a square lamp of `size` m in the middle of its ceiling, 1 mm below it; the
/// lamp is material and node "lamp".
Scene lamp_room(double size, double albedo);

}  // namespace relume::test
