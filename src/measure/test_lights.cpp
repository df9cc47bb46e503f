// SPDX-License-Identifier: MIT
#include "measure/test_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/sky.h"
#include "precompute/clearance.h"
#include "precompute/direct_irradiance.h"
#include "precompute/find_hollows.h"
#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

constexpr const char* kLampName = "test lamp";
/// For a sensor that is in no solid.
constexpr int kMostTries = 1000;

/// Points of the scene's surfaces by area, always the same ones.
class SurfaceDraw {
 public:
  explicit SurfaceDraw(const Geometry& geometry) : geometry_(geometry) {
    double sum = 0.0;
    for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
      const glm::vec3 a = geometry.point(t, 0, 0), b = geometry.point(t, 1, 0), c = geometry.point(t, 0, 1);
      area_up_to_.push_back(sum += 0.5 * double(glm::length(glm::cross(b - a, c - a))));
    }
  }
  double random() {
    state_ = mix(state_, 7);
    return double(state_ >> 11) / double(std::uint64_t{1} << 53);
  }
  /// Relative to the origin of the geometry; front side.
  SurfacePoint next() {
    const double target = random() * area_up_to_.back();
    const auto found = std::upper_bound(area_up_to_.begin(), area_up_to_.end() - 1, target);
    const auto t = std::uint32_t(found - area_up_to_.begin());
    const glm::vec2 at = triangle_point(float(random()), float(random()));
    return {geometry_.point(t, at.x, at.y), geometry_.normals[t]};
  }

 private:
  const Geometry& geometry_;
  std::vector<double> area_up_to_;
  std::uint64_t state_ = 0x4c414d50;
};

float free_distance(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& at,
                    const glm::vec3& direction, std::uint32_t& triangle) {
  RayPacket packet{};
  packet.far.fill(-1.0f);
  const glm::vec3 start = at.position + geometry.offset * at.normal;
  packet.origin_x[0] = start.x, packet.origin_y[0] = start.y, packet.origin_z[0] = start.z;
  packet.direction_x[0] = direction.x, packet.direction_y[0] = direction.y,
  packet.direction_z[0] = direction.z;
  packet.far[0] = 1e9f;
  caster.closest_hits(packet);
  triangle = packet.triangle[0];
  return packet.far[0];
}

struct FreePlace {
  glm::vec3 position{0.0f}, down{0.0f};  ///< towards the surface that it hangs over
  float radius = 0.0f;                   ///< m, to the nearest surface
};

/// Of all directions, the share in which a place (a normal lifts it off its surface) sees a triangle that
/// `counts`, as it meets it.
template <class Counts>
double share_seen(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& place,
                  Counts&& counts) {
  constexpr int kDirections = 64;
  int seen = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / kDirections, around = 2.399963 * i;
    const glm::vec3 way(std::sqrt(1.0 - y * y) * std::cos(around), y,
                        std::sqrt(1.0 - y * y) * std::sin(around));
    std::uint32_t triangle = 0;
    free_distance(geometry, caster, place, way, triangle);
    if (triangle != kNoTriangle) seen += counts(triangle, glm::dot(geometry.normals[triangle], way)) ? 1 : 0;
  }
  return double(seen) / kDirections;
}

double enclosure(const Geometry& geometry, const RayCaster& caster, const glm::vec3& place) {
  return share_seen(geometry, caster, {place, glm::vec3(0.0f)},
                    [](std::uint32_t, float facing) { return facing < 0.0f; });
}

/// Whether a front sticks into a solid.
bool in_a_hollow(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& at) {
  constexpr double kQuarter = 0.25;  // half of what is before it
  if (geometry.hollow.empty()) return false;
  return share_seen(geometry, caster, at, [&](std::uint32_t triangle, float facing) {
           return facing >= 0.0f && geometry.hollow[triangle];
         }) > kQuarter;
}

/// Over what faces up, where anything does, with something opposite that faces it. Of a few such places, one
/// that is inside a room (all around are fronts), if any is, and of those the farthest from all surfaces.
FreePlace free_place(const Geometry& geometry, const RayCaster& caster, SurfaceDraw& draw) {
  constexpr double kInside = 0.8;
  FreePlace best;
  bool best_inside = false;
  for (int tries = 0, inside = 0; tries < 2000 && inside < 6; ++tries) {
    const SurfacePoint at = draw.next();
    if (at.normal.y < 0.7f && tries < 500) continue;
    const double share = 0.2 + 0.6 * draw.random();
    std::uint32_t triangle = 0;
    const float distance = free_distance(geometry, caster, at, at.normal, triangle);
    if (triangle != kNoTriangle && glm::dot(geometry.normals[triangle], at.normal) >= 0.0f) continue;
    const float room = std::min(distance, 0.25f * glm::length(geometry.upper - geometry.lower));
    const glm::vec3 place = at.position + room * float(share) * at.normal;
    const float radius = std::min(free_radius(caster, place), room);
    const bool is_inside = enclosure(geometry, caster, place) >= kInside;
    inside += is_inside ? 1 : 0;
    if (is_inside < best_inside || (is_inside == best_inside && radius <= best.radius)) continue;
    best = {place, -at.normal, radius};
    best_inside = is_inside;
  }
  return best;
}

void add_lamp(const FreePlace& place, const glm::dvec3& origin, Scene& scene) {
  const glm::dvec3 centre = origin + glm::dvec3(place.position);
  const double half = 0.1 * double(place.radius);
  const auto material = std::uint32_t(scene.materials.size()), node = std::uint32_t(scene.nodes.size());
  SceneMaterial lamp;
  lamp.name = kLampName;
  lamp.base_color = Rgb(0.5);
  lamp.emission = Rgb(1000.0);
  scene.materials.push_back(lamp);
  scene.nodes.push_back({kLampName, {}, true});
  const auto first = std::uint32_t(scene.triangles.size());
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const double sign = face % 2 == 0 ? 1.0 : -1.0;
    const auto base = std::uint32_t(scene.vertices.positions.size());
    for (const glm::dvec2 corner :
         {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1), glm::dvec2(-1, 1)}) {
      glm::dvec3 p(0.0);
      p[axis] = sign, p[(axis + 1) % 3] = sign * corner.x, p[(axis + 2) % 3] = corner.y;
      scene.vertices.positions.push_back(centre + half * p);
    }
    scene.triangles.push_back({base, base + 1, base + 2});
    scene.triangles.push_back({base, base + 2, base + 3});
  }
  const std::size_t vertices = scene.vertices.positions.size();
  scene.vertices.uv0.resize(vertices), scene.vertices.uv1.resize(vertices);
  scene.vertices.colors.resize(vertices, glm::vec4(1.0f));
  scene.surfaces.push_back({node, material, first, 12, false, false, false});
}

Light light_at(const FreePlace& place, const glm::dvec3& origin, LightType type) {
  Light light;
  light.type = type;
  light.intensity = Rgb(1000.0 * double(place.radius) * double(place.radius));
  light.position = origin + glm::dvec3(place.position);
  light.direction = glm::dvec3(place.down);
  light.inner_cone_angle = 0.4, light.outer_cone_angle = 0.7;
  return light;
}

}  // namespace

Result<TestScene> test_scene(Scene scene, std::size_t sensors) {
  TestScene result;
  Geometry geometry = make_geometry(scene);
  const auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  if (may_have_hollows(geometry)) geometry.hollow = find_hollows(scene, geometry, *caster, {});
  SurfaceDraw draw(geometry);
  result.lights.push_back({"ambient", {}, 0.0, false, true});
  result.lights.push_back({"lamp", {}, 0.0, true, false});
  const FreePlace lamp = free_place(geometry, *caster, draw);
  for (const LightType type : {LightType::point, LightType::point, LightType::spot}) {
    const FreePlace place = free_place(geometry, *caster, draw);
    result.lights.push_back({fmt::format("light {}", result.lights.size()),
                             {light_at(place, geometry.origin, type)},
                             double(place.radius)});
  }
  for (std::size_t i = 0; i < sensors; ++i) {
    SurfacePoint at = draw.next();
    for (int tries = 0; tries < kMostTries && in_a_hollow(geometry, *caster, at); ++tries) at = draw.next();
    result.sensors.push_back({std::to_string(i), geometry.origin + glm::dvec3(at.position), at.normal});
  }
  add_lamp(lamp, geometry.origin, scene);
  result.lamp_material = std::uint32_t(scene.materials.size() - 1);
  result.lamp_exitance = exitance_from_radiance(scene.materials.back().emission);
  result.scene = std::move(scene);
  return result;
}

Result<LampPlace> lamp_place(const Scene& scene) {
  const Geometry geometry = make_geometry(scene);
  const auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  SurfaceDraw draw(geometry);
  const FreePlace place = free_place(geometry, *caster, draw);
  return LampPlace{geometry.origin + glm::dvec3(place.position), double(place.radius)};
}

Result<Lighting> test_lighting(const Model& model, const TestLight& light) {
  Lighting lighting = stored_lighting(model);
  const auto lamp = std::find_if(model.materials.begin(), model.materials.end(),
                                 [](const MaterialRecord& m) { return m.name == kLampName; });
  std::size_t next = 0;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) {
      Rgb& exitance = lighting.exitance[next++];
      const bool is_lamp = cluster.material == std::uint32_t(lamp - model.materials.begin());
      if (!(light.lamp && is_lamp)) exitance = Rgb(0.0);
      if (light.ambient && model.sky_cells.empty()) exitance = kAmbientLight;
    }
  }
  if (light.ambient)
    lighting.sky_radiosity = sky_radiosity(kAmbientLight, model.sky_cells, model.sky_resolution);
  if (!light.lights.empty()) {
    auto direct = direct_irradiance(model, light.lights);
    if (!direct) return tl::unexpected(direct.error());
    lighting.direct = std::move(direct->clusters);
  }
  return lighting;
}

}  // namespace relume
