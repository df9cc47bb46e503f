// SPDX-License-Identifier: MIT
#include "precompute/probing_lights.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>

#include "core/quantities.h"
#include "core/sky.h"
#include "precompute/clearance.h"
#include "precompute/probing_dice.h"

namespace relume {
namespace {

/// Shares of the surface of a room: square of the distance that lamps keep, and area of what glows, at least.
constexpr float kLampStandOff = 1e-3f, kLeastPatch = 2e-3f;
/// Places tried for a lamp and for a spot light, which would light next to nothing from near.
constexpr int kLampTries = 4, kSpotTries = 8;
/// Half the angle of the cone of a spot light, at least and at most; it is as bright as can be to half of
/// that.
constexpr float kNarrowCone = 0.4f, kWideCone = 0.7f;

class Lamps {
 public:
  explicit Lamps(const ProbedPlaces& places) : places_(places) {}
  ProbingLights run();

 private:
  void light_room(std::uint32_t room, std::size_t probing);
  glm::vec3 free_place(const ProbedRoom& room, const Choices& choices, Dice& dice, int tries) const;
  void point_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing);
  void spot_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing);
  /// `intensity(direction)`: to a surface.
  template <class Intensity>
  void shine(const ProbedRoom& room, const glm::vec3& position, std::size_t probing, Intensity&& intensity);
  void glowing_patch(const ProbedRoom& room, const Choices& choices, std::size_t probing);
  /// Those of one material, by turns; false when there are none.
  bool emitters_of_room(std::uint32_t room, float strength, std::size_t probing);
  void sky(std::size_t probing);

  const ProbedPlaces& places_;
  ProbingLights result_;
};

ProbingLights Lamps::run() {
  result_.emitted.assign(places_.clusters.size(), ProbingValues{});
  result_.arriving.assign(places_.clusters.size(), ProbingValues{});
  result_.sky.assign(places_.scene.senders.sky_cells.size(), ProbingValues{});
  for (std::size_t p = 0; p < kProbings; ++p) {
    if (p % 4 == 0) sky(p);
    for (std::uint32_t room = 0; room < places_.rooms.size(); ++room) light_room(room, p);
  }
  return std::move(result_);
}

void Lamps::light_room(std::uint32_t index, std::size_t probing) {
  const ProbedRoom& room = places_.rooms[index];
  Dice dice(places_.scene.seed, 0x726f + index, probing);
  const Choices choices(places_.scene.seed, index, probing);
  const float kind = choices.kind;
  const float strength = 0.2f + 0.8f * dice.next();
  if (places_.lit.number[index] == kNone) {
    for (const auto c : room.clusters) result_.emitted[c][probing] = strength * dice.next();
  } else if ((kind < 0.2f && places_.rooms.size() > 1) ||  // dark, but for what comes from its neighbours
             (by_emitters(probing) && emitters_of_room(index, strength, probing))) {
    return;
  } else if (kind > 0.9f) {
    glowing_patch(room, choices, probing);
  } else if (kind > 0.65f) {
    spot_light(room, choices, dice, probing);
  } else {
    point_light(room, choices, dice, probing);
  }
}

/// Where a lamp may hang: of some places the one that is farthest from all surfaces.
glm::vec3 Lamps::free_place(const ProbedRoom& room, const Choices& choices, Dice& dice, int tries) const {
  glm::vec3 best(0.0f);
  float radius = -1.0f;
  for (int attempt = 0; attempt < tries; ++attempt) {
    const SurfacePoint& under = room.choose(attempt == 0 ? choices.place : dice.next());
    const glm::vec3 start = under.position + places_.scene.geometry.offset * under.normal;
    RayPacket up{};
    up.far.fill(-1.0f);
    up.origin_x[0] = start.x, up.origin_y[0] = start.y, up.origin_z[0] = start.z;
    up.direction_x[0] = under.normal.x, up.direction_y[0] = under.normal.y,
    up.direction_z[0] = under.normal.z;
    const float most = std::sqrt(room.area());
    up.far[0] = most;
    places_.scene.caster.closest_hits(up);
    const glm::vec3 place = start + std::min(up.far[0], most) * (0.1f + 0.8f * dice.next()) * under.normal;
    const float free = std::min(free_radius(places_.scene.caster, place), most);
    if (free > radius) best = place, radius = free;
  }
  return best;
}

template <class Intensity>
void Lamps::shine(const ProbedRoom& room, const glm::vec3& position, std::size_t probing,
                  Intensity&& intensity) {
  tbb::parallel_for(std::size_t{0}, places_.clusters.size(), [&](std::size_t c) {
    const SurfacePoint& at = places_.clusters[c].at;
    const glm::vec3 to = position - at.position;
    const float squared = glm::dot(to, to), cosine = glm::dot(to, at.normal);
    if (cosine <= 0.0f || squared <= 0.0f) return;
    const float distance = std::sqrt(squared), candela = intensity(to / -distance);
    if (candela <= 0.0f) return;
    if (places_.scene.caster.occluded(at.position + places_.scene.geometry.offset * at.normal, position))
      return;
    result_.arriving[c][probing] +=
        candela * (cosine / distance) / std::max(squared, kLampStandOff * room.area());
  });
}

void Lamps::point_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing) {
  // As much flux as would give the room one lux.
  const float candela = room.area() / float(4.0 * kPi);
  shine(room, free_place(room, choices, dice, kLampTries), probing,
        [candela](const glm::vec3&) { return candela; });
}

/// At any surface of the room.
void Lamps::spot_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing) {
  const glm::vec3 position = free_place(room, choices, dice, kSpotTries);
  const glm::vec3 way = room.choose(choices.target).position - position;
  const float angle = kNarrowCone + (kWideCone - kNarrowCone) * dice.next();
  if (glm::length(way) <= 0.0f) return;
  const glm::vec3 axis = glm::normalize(way);
  const float outer = std::cos(angle), inner = std::cos(0.5f * angle);
  const float candela = room.area() / (float(2.0 * kPi) * (1.0f - 0.5f * (inner + outer)));
  shine(room, position, probing, [=](const glm::vec3& direction) {
    const float share = std::clamp((glm::dot(direction, axis) - outer) / (inner - outer), 0.0f, 1.0f);
    return candela * share * share;
  });
}

void Lamps::glowing_patch(const ProbedRoom& room, const Choices& choices, std::size_t probing) {
  const SurfacePoint& middle = room.choose(choices.target);
  const float radius = 0.1f * std::sqrt(room.area());
  std::vector<std::uint32_t> patch;
  float area = 0.0f;
  for (const auto c : room.clusters) {
    const SurfacePoint& at = places_.clusters[c].at;
    if (glm::length(at.position - middle.position) > radius || glm::dot(at.normal, middle.normal) < 0.5f)
      continue;
    patch.push_back(c);
    area += places_.clusters[c].area;
  }
  for (const auto c : patch)
    result_.emitted[c][probing] += room.area() / std::max(area, kLeastPatch * room.area());
}

bool Lamps::emitters_of_room(std::uint32_t index, float strength, std::size_t probing) {
  std::map<std::uint32_t, float> areas;  // per material
  for (const Emitter& emitter : places_.scene.emitters.list) {
    if (places_.of_cluster[emitter.cluster] == index) areas[emitter.material] += float(emitter.area);
  }
  if (areas.empty()) return false;
  const auto [material, area] = *std::next(areas.begin(), std::ptrdiff_t(probing / 8 % areas.size()));
  for (const Emitter& emitter : places_.scene.emitters.list) {
    if (places_.of_cluster[emitter.cluster] == index && emitter.material == material)
      result_.emitted[emitter.cluster][probing] +=
          strength * places_.rooms[index].area() / std::max(area, kLeastPatch * places_.rooms[index].area());
  }
  return true;
}

void Lamps::sky(std::size_t probing) {
  Dice dice(places_.scene.seed, 0x736b, probing);
  const glm::vec3 bright = glm::normalize(glm::vec3(dice.next() - 0.5f, dice.next(), dice.next() - 0.5f));
  for (std::size_t i = 0; i < places_.scene.senders.sky_cells.size(); ++i) {
    const glm::vec3 direction(
        sky_cell_direction(places_.scene.senders.sky_cells[i], places_.scene.senders.sky_resolution));
    result_.sky[i][probing] = probing == 0 ? 1.0f : 1.0f + 0.9f * glm::dot(direction, bright);
  }
}

}  // namespace

ProbingLights probing_lights(const ProbedPlaces& places) {
  return Lamps(places).run();
}

}  // namespace relume
