// SPDX-License-Identifier: MIT
#include "precompute/rig.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "precompute/emitters.h"

namespace relume {
namespace {

constexpr double kMinEnclosedShare = 0.03;  ///< of the grid, for a scene to have rooms at all
constexpr std::size_t kMinRoomPoints = 8;
constexpr double kMinRoomShare = 0.1;  ///< of the enclosed points
constexpr std::size_t kMaxLights = 32;
constexpr double kRoomCandela = 1000.0;
constexpr float kBelowCeiling = 0.3f;
constexpr double kMostlyOpen = 0.5;
constexpr double kSunLux = 50000.0;
constexpr double kSkyRadiance = 1000.0;

/// How many rays from a point meet nothing.
std::size_t count_escapes(const RayCaster& caster, const glm::vec3& from,
                          std::span<const glm::vec3> directions) {
  std::size_t escaped = 0;
  for (std::size_t first = 0; first < directions.size(); first += kPacketSize) {
    RayPacket packet{};
    packet.far.fill(-1.0f);
    packet.direction_x.fill(1.0f);
    const std::size_t lanes = std::min<std::size_t>(kPacketSize, directions.size() - first);
    for (std::size_t l = 0; l < lanes; ++l) {
      const glm::vec3& d = directions[first + l];
      packet.origin_x[l] = from.x, packet.origin_y[l] = from.y, packet.origin_z[l] = from.z;
      packet.direction_x[l] = d.x, packet.direction_y[l] = d.y, packet.direction_z[l] = d.z;
      packet.far[l] = std::numeric_limits<float>::infinity();
    }
    caster.closest_hits(packet);
    for (std::size_t l = 0; l < lanes; ++l) escaped += packet.triangle[l] == kNoTriangle ? 1u : 0u;
  }
  return escaped;
}

/// Enclosed points that can be reached from `seed` through enclosed neighbours with free ways between them.
std::vector<std::size_t> flood(const EnclosedGrid& grid, const RayCaster& caster, std::size_t seed,
                               std::vector<std::uint8_t>& taken) {
  std::vector<std::size_t> room{seed};
  taken[seed] = 1;
  for (std::size_t next = 0; next < room.size(); ++next) {
    const int i = int(room[next]);
    const glm::ivec3 at{i % grid.size().x, i / grid.size().x % grid.size().y,
                        i / (grid.size().x * grid.size().y)};
    for (int axis = 0; axis < 3; ++axis) {
      for (const int way : {-1, 1}) {
        glm::ivec3 to = at;
        to[axis] += way;
        if (to[axis] < 0 || to[axis] >= grid.size()[axis]) continue;
        const auto j = std::size_t(to.x + grid.size().x * (to.y + grid.size().y * to.z));
        if (taken[j] != 0 || grid.enclosed[j] == 0 || caster.occluded(grid.point(room[next]), grid.point(j)))
          continue;
        taken[j] = 1;
        room.push_back(j);
      }
    }
  }
  return room;
}

/// How far it is straight up, or down, from points of the grid: infinity where nothing is.
std::vector<float> vertical_distances(const EnclosedGrid& grid, const RayCaster& caster,
                                      const std::vector<std::size_t>& points, float up) {
  std::vector<float> distances(points.size());
  for (std::size_t first = 0; first < points.size(); first += kPacketSize) {
    RayPacket packet{};
    packet.direction_y.fill(up);
    packet.far.fill(-1.0f);
    const std::size_t lanes = std::min<std::size_t>(kPacketSize, points.size() - first);
    for (std::size_t l = 0; l < lanes; ++l) {
      const glm::vec3 from = grid.point(points[first + l]);
      packet.origin_x[l] = from.x, packet.origin_y[l] = from.y, packet.origin_z[l] = from.z;
      packet.far[l] = std::numeric_limits<float>::infinity();
    }
    caster.closest_hits(packet, RaySpread::narrow);
    std::copy_n(packet.far.begin(), lanes, distances.begin() + std::ptrdiff_t(first));
  }
  return distances;
}

/// Places for a light under the highest ceiling over the points of a room.
std::vector<glm::vec3> light_places(const RayCaster& caster, const EnclosedGrid& grid,
                                    const std::vector<std::size_t>& room) {
  struct Place {
    float ceiling;
    glm::vec3 light;
  };
  std::vector<Place> places;
  float highest = std::numeric_limits<float>::lowest();
  const std::vector<float> above = vertical_distances(grid, caster, room, 1.0f),
                           below = vertical_distances(grid, caster, room, -1.0f);
  for (std::size_t i = 0; i < room.size(); ++i) {
    if (std::isinf(above[i])) continue;
    const glm::vec3 p = grid.point(room[i]);
    const float height = above[i] + (std::isinf(below[i]) ? grid.grid.step : below[i]);
    const float drop = height < 2.0f * kBelowCeiling ? 0.5f * height : kBelowCeiling;
    const float ceiling = p.y + above[i];
    places.push_back({ceiling, {p.x, ceiling - drop, p.z}});
    highest = std::max(highest, ceiling);
  }
  std::vector<glm::vec3> lights;
  for (const Place& place : places) {
    if (place.ceiling >= highest - 0.5f * grid.grid.step) lights.push_back(place.light);
  }
  return lights;
}

/// Which points of the grid a place sees.
std::vector<bool> points_seen(const EnclosedGrid& grid, const RayCaster& caster, const glm::vec3& place,
                              const std::vector<std::size_t>& points) {
  std::vector<bool> seen(points.size());
  for (std::size_t first = 0; first < points.size(); first += kPacketSize) {
    RayPacket packet{};
    packet.direction_x.fill(1.0f);
    packet.far.fill(-1.0f);
    const std::size_t lanes = std::min<std::size_t>(kPacketSize, points.size() - first);
    for (std::size_t l = 0; l < lanes; ++l) {
      const glm::vec3 way = grid.point(points[first + l]) - place;
      packet.origin_x[l] = place.x, packet.origin_y[l] = place.y, packet.origin_z[l] = place.z;
      packet.direction_x[l] = way.x, packet.direction_y[l] = way.y, packet.direction_z[l] = way.z;
      packet.far[l] = 1.0f;
    }
    const std::uint32_t hidden = caster.occluded(packet, AlphaTest::solid);
    for (std::size_t l = 0; l < lanes; ++l) seen[first + l] = (hidden >> l & 1u) == 0;
  }
  return seen;
}

/// Of the places that see nearly as much of the room as the best, the one nearest to its middle.
glm::vec3 best_place(const EnclosedGrid& grid, const RayCaster& caster, const std::vector<std::size_t>& room,
                     const std::vector<glm::vec3>& places) {
  constexpr std::size_t kTries = 64, kLooks = 256;
  constexpr double kNearly = 0.9;
  glm::vec3 middle(0.0f);
  for (const auto i : room) middle += grid.point(i) / float(room.size());
  if (places.empty()) return middle;
  const std::size_t place_step = (places.size() + kTries - 1) / kTries,
                    look_step = (room.size() + kLooks - 1) / kLooks;
  struct Tried {
    glm::vec3 place;
    float off_centre = 0.0f;
    std::size_t seen = 0;
  };
  std::vector<Tried> tried;
  for (std::size_t p = 0; p < places.size(); p += place_step)
    tried.push_back({places[p], glm::length(glm::vec2(places[p].x - middle.x, places[p].z - middle.z))});
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Tried& a, const Tried& b) { return a.off_centre < b.off_centre; });
  std::vector<std::size_t> looked_at;
  for (std::size_t i = 0; i < room.size(); i += look_step) looked_at.push_back(room[i]);
  std::size_t most = 0;
  for (Tried& t : tried) {
    const std::vector<bool> seen = points_seen(grid, caster, t.place, looked_at);
    t.seen = std::size_t(std::count(seen.begin(), seen.end(), true));
    most = std::max(most, t.seen);
    // Whatever the others see, the nearest one sees nearly as much.
    if (double(tried.front().seen) >= kNearly * double(looked_at.size())) break;
  }
  return std::find_if(tried.begin(), tried.end(),
                      [&](const Tried& t) { return double(t.seen) >= kNearly * double(most); })
      ->place;
}

/// Share of the surface that looks out into the open: more than kMaxEscapes of its hemisphere sees no
/// geometry.
double open_share(const Geometry& geometry, const RayCaster& caster) {
  constexpr std::size_t kPoints = 1024;
  std::array<glm::vec3, kLookDirections> directions;
  double total = 0.0, open = 0.0, next = 0.0;
  double area = 0.0;
  for (const float a : geometry.areas) area += a;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    total += geometry.areas[t];
    while (next < total) {
      next += area / kPoints;
      for (int i = 0; i < kLookDirections; ++i) {
        const glm::vec3 d = sphere_direction(i, kLookDirections);
        directions[std::size_t(i)] = glm::dot(d, geometry.normals[t]) < 0.0f ? -d : d;
      }
      const glm::vec3 from =
          geometry.point(t, 1.0f / 3.0f, 1.0f / 3.0f) + geometry.normals[t] * geometry.offset;
      const std::size_t escaped = count_escapes(caster, from, directions);
      open += double(escaped) > kMaxEscapes * kLookDirections ? 1.0 / kPoints : 0.0;
    }
  }
  return open;
}

bool scene_shines(const Scene& scene) {
  if (!scene.lights.empty()) return true;
  return std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                     [&](const SceneSurface& surface) { return shines(scene.materials[surface.material]); });
}

Light rig_light(const glm::dvec3& position, std::size_t number) {
  Light light;
  light.name = fmt::format("rig{}", number);
  light.intensity = Rgb(kRoomCandela);
  light.position = position;
  return light;
}

/// A light in each enclosed room, where that sees most of the room. Rooms are what sees each other.
std::vector<Light> room_lights(const Geometry& geometry, const RayCaster& caster, const EnclosedGrid& grid) {
  const auto enclosed = std::size_t(std::count(grid.enclosed.begin(), grid.enclosed.end(), std::uint8_t{1}));
  std::vector<Light> lights;
  if (double(enclosed) < kMinEnclosedShare * double(grid.enclosed.size())) return lights;
  std::vector<std::uint8_t> taken(grid.enclosed.size(), 0);
  for (std::size_t i = 0; i < grid.enclosed.size(); ++i) {
    if (taken[i] != 0 || grid.enclosed[i] == 0) continue;
    auto room = flood(grid, caster, i, taken);
    // What one light does not see, round a corner, is a room to itself.
    while (room.size() >= kMinRoomPoints && double(room.size()) >= kMinRoomShare * double(enclosed) &&
           lights.size() < kMaxLights) {
      const glm::vec3 light = best_place(grid, caster, room, light_places(caster, grid, room));
      lights.push_back(rig_light(geometry.origin + glm::dvec3(light), lights.size() + 1));
      const std::vector<bool> seen = points_seen(grid, caster, light, room);
      std::size_t next = 0;
      if (std::erase_if(room, [&](std::size_t) { return seen[next++]; }) == 0) break;
    }
  }
  return lights;
}

}  // namespace

void light_model(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
                 const EarlierLooks* earlier, Model& model, std::vector<std::string>& warnings,
                 EnclosedGrid* looked) {
  model.lights = scene.lights;
  model.lit_by_rig = !scene_shines(scene);
  if (!model.lit_by_rig) return;
  EnclosedGrid grid = find_enclosed(geometry, caster, earlier);
  model.lights = room_lights(geometry, caster, grid);
  if (looked != nullptr) *looked = std::move(grid);
  std::string rig;
  if (!model.lights.empty()) {
    rig = fmt::format("{} point light(s) of {} cd, {} m below the ceiling of each enclosed room",
                      model.lights.size(), kRoomCandela, kBelowCeiling);
  }
  if (model.lights.empty() || open_share(geometry, caster) > kMostlyOpen) {
    Light sun;
    sun.type = LightType::directional;
    sun.name = "rig sun";
    sun.intensity = Rgb(kSunLux);
    sun.direction = -glm::normalize(glm::dvec3(0.4, 1.0, 0.3));
    model.lights.push_back(sun);
    model.sky_radiance = Rgb(kSkyRadiance);
    rig += fmt::format("{}a sky of {} cd/m2 and a sun of {} lx from (0.4, 1, 0.3)", rig.empty() ? "" : ", ",
                       kSkyRadiance, kSunLux);
  }
  warnings.push_back(
      fmt::format("{}: no light and no emission; lit by the stated rig: {}", scene.file_name, rig));
}

}  // namespace relume
