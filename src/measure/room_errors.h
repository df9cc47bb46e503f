// SPDX-License-Identifier: MIT
//
// How far models are from what paths say, room by room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/quantities.h"
#include "measure/path_irradiance.h"

namespace relume {

struct RoomTruth {
  PathIrradiance paths;
  std::vector<std::uint32_t> rooms;  ///< per sensor; kNone: in none
};

/// Rooms this much dimmer than the brightest count as dark.
inline constexpr double kDarkRoom = 1e-3;

/// Irradiance at the sensors against I* of a light: the worst over rooms of |I - I*| / |I*|, without the
/// noise of I*. Rooms with less than a fiftieth of the sensors, or less than `dark` of the irradiance of the
/// brightest, are left out. Sensors are spread evenly over all surfaces, so this is weighted by area.
double worst_room_error(const RoomTruth& truth, std::size_t light, const std::vector<Rgb>& values,
                        double dark = kDarkRoom);

/// The noise of I* itself, over I*: the worst over the same rooms. Of errors, far less of it is left.
double worst_room_noise(const RoomTruth& truth, std::size_t light);

/// Sensors in rooms whose I* of any light has more noise than this.
std::vector<std::uint32_t> noisy_sensors(const RoomTruth& truth, double noise);

}  // namespace relume
