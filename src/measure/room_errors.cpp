// SPDX-License-Identifier: MIT
#include "measure/room_errors.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "core/model.h"

namespace relume {
namespace {

/// A room with fewer of the sensors has no mean worth the name.
constexpr double kLeastSensors = 0.02;

/// Squares over the sensors of a room.
struct RoomSums {
  std::uint32_t room = kNone;
  double difference = 0.0, noise = 0.0, total = 0.0, count = 0.0;
};

/// Of the rooms that count. Noise is taken off `difference` and `total`.
std::vector<RoomSums> room_sums(const RoomTruth& truth, std::size_t light, const std::vector<Rgb>& values,
                                double dark = kDarkRoom) {
  std::map<std::uint32_t, RoomSums> sums;
  double counted = 0.0, brightest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (truth.rooms[i] == kNone) continue;
    RoomSums& room = sums[truth.rooms[i]];
    room.room = truth.rooms[i];
    const Rgb& exact = truth.paths.values[light][i];
    const double noise = truth.paths.noise[light][i];
    room.difference += glm::dot(values[i] - exact, values[i] - exact) - noise;
    room.noise += noise;
    room.total += glm::dot(exact, exact) - noise;
    room.count += 1.0, counted += 1.0;
  }
  for (const auto& [index, room] : sums) brightest = std::max(brightest, room.total / room.count);
  std::vector<RoomSums> rooms;
  for (const auto& [index, room] : sums) {
    if (room.count >= kLeastSensors * counted && room.total / room.count >= dark * dark * brightest)
      rooms.push_back(room);
  }
  return rooms;
}

}  // namespace

double worst_room_error(const RoomTruth& truth, std::size_t light, const std::vector<Rgb>& values,
                        double dark) {
  double worst = 0.0;
  for (const RoomSums& room : room_sums(truth, light, values, dark))
    worst = std::max(worst, std::sqrt(std::max(0.0, room.difference) / room.total));
  return worst;
}

double worst_room_noise(const RoomTruth& truth, std::size_t light) {
  double worst = 0.0;
  for (const RoomSums& room : room_sums(truth, light, truth.paths.values[light]))
    worst = std::max(worst, std::sqrt(room.noise / room.total));
  return worst;
}

std::vector<std::uint32_t> noisy_sensors(const RoomTruth& truth, double noise) {
  std::set<std::uint32_t> rooms;
  for (std::size_t l = 0; l < truth.paths.values.size(); ++l) {
    for (const RoomSums& room : room_sums(truth, l, truth.paths.values[l])) {
      if (room.noise > noise * noise * room.total) rooms.insert(room.room);
    }
  }
  std::vector<std::uint32_t> sensors;
  for (std::uint32_t i = 0; i < truth.rooms.size(); ++i) {
    if (rooms.count(truth.rooms[i]) > 0) sensors.push_back(i);
  }
  return sensors;
}

}  // namespace relume
