// SPDX-License-Identifier: MIT
#include "measure/path_irradiance.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>

#include "core/mix.h"
#include "precompute/arena_threads.h"
#include "precompute/geometry.h"
#include "precompute/lift_sensor.h"
#include "precompute/mutual_visibility.h"
#include "precompute/packet_lanes.h"
#include "precompute/punctual_light.h"
#include "precompute/ray_caster.h"
#include "precompute/sampling.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

constexpr std::uint32_t kBatches = 8;
constexpr std::uint32_t kCertainBounces = 3;  ///< before roulette begins

/// A light of one of the test's lightings, about the origin of the geometry.
struct OwnLight {
  std::size_t lighting = 0;
  Light light;
};

/// All that paths go through.
struct Surroundings {
  const TestScene& test;
  PathOptions options;
  Geometry geometry;
  RayCaster caster;
  std::vector<OwnLight> lights;
  std::vector<std::uint32_t> lamp_triangles;  ///< of one size
  std::vector<Rgb> plain;                     ///< albedo per triangle; negative: it changes over the triangle

  Rgb albedo(const SurfaceHit& hit) const {
    const Rgb& known = plain[hit.triangle];
    return known.r >= 0.0 ? known : color(hit.triangle, {hit.u, hit.v});
  }
  Rgb color(std::uint32_t triangle, const glm::vec2& at) const {
    return glm::clamp(mean_color(test.scene, triangle, {at, at, at}).albedo, Rgb(0.0),
                      Rgb(options.max_albedo));
  }
};

bool varies(const Scene& scene, const SceneSurface& surface) {
  return surface.has_colors || scene.materials[surface.material].base_color_texture.has_value();
}

Result<Surroundings> make_surroundings(const TestScene& test, const PathOptions& options) {
  Geometry geometry = make_geometry(test.scene);
  auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  Surroundings around{test, options, std::move(geometry), std::move(*caster), {}, {}, {}};
  for (std::size_t l = 0; l < test.lights.size(); ++l) {
    for (Light light : test.lights[l].lights) {
      light.position -= around.geometry.origin;
      around.lights.push_back({l, light});
    }
  }
  for (const SceneSurface& surface : test.scene.surfaces) {
    const bool lamp = surface.material == test.lamp_material;
    for (std::uint32_t t = surface.first_triangle; t < surface.first_triangle + surface.triangle_count; ++t) {
      if (lamp) around.lamp_triangles.push_back(t);
      around.plain.push_back(varies(test.scene, surface) ? Rgb(-1.0)
                                                         : around.color(t, glm::vec2(1.0f / 3.0f)));
    }
  }
  return around;
}

/// A path on its way, in its lane of the packets.
struct Path {
  SurfacePoint at;  ///< where it is, lifted
  Rgb throughput{0.0};
  SamplePoint first{};  ///< numbers for its first two directions
  std::uint64_t key = 0;
  std::uint32_t bounces = 0;
  bool alive = false;

  double random() {
    key = mix(key, 7);
    return double(key >> 11) * 0x1p-53;
  }
  glm::vec3 direction() {
    const bool known = bounces < 2;
    const float u = known ? first[2 * bounces] : float(random()),
                v = known ? first[2 * bounces + 1] : float(random());
    return frame_about(at.normal).to_world(
        cosine_direction(std::min(u, 0x1.fffffep-1f), std::min(v, 0x1.fffffep-1f)));
  }
  /// Whether it goes on.
  bool survives() {
    if (bounces < kCertainBounces) return true;
    const double chance = std::min(1.0, std::max({throughput.r, throughput.g, throughput.b}));
    if (random() >= chance) return false;
    throughput /= chance;
    return true;
  }
};

/// The paths of one sensor.
class SensorPaths {
 public:
  SensorPaths(const Surroundings& around, const SurfacePoint& sensor, std::uint64_t seed)
      : around_(around), sensor_(sensor), seed_(seed) {}

  /// Sums over the paths of a batch, per lighting.
  std::vector<Rgb> batch(const SobolPoints& points, std::uint32_t number) {
    sums_.assign(around_.test.lights.size(), Rgb(0.0));
    std::uint32_t next = 0;
    for (;;) {
      bool any = false;
      for (Path& path : paths_) {
        if (!path.alive && next < points.count()) start(path, points, number, next++);
        any = any || path.alive;
      }
      if (!any) return sums_;
      connect_lamp();
      for (const OwnLight& own : around_.lights) connect(own);
      go_on();
    }
  }

 private:
  void start(Path& path, const SobolPoints& points, std::uint32_t batch, std::uint32_t index) const {
    const std::uint64_t seed = mix(seed_, batch);
    path = {sensor_, Rgb(1.0), points.scrambled(index, seed), mix(seed, index + 1), 0, true};
  }

  static void aim(RayPacket& rays, std::size_t lane, const glm::vec3& from, const glm::vec3& way, float far) {
    rays.origin_x[lane] = from.x, rays.origin_y[lane] = from.y, rays.origin_z[lane] = from.z;
    rays.direction_x[lane] = way.x, rays.direction_y[lane] = way.y, rays.direction_z[lane] = way.z;
    rays.far[lane] = far;
  }

  /// Adds what lanes have to offer, where nothing is in the way.
  void add_unblocked(RayPacket& rays, const std::array<Rgb, kPacketSize>& offers, std::size_t lighting) {
    if (std::all_of(rays.far.begin(), rays.far.end(), [](float far) { return far < 0.0f; })) return;
    std::uint32_t lit = 0;
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) lit |= (rays.far[lane] >= 0.0f ? 1u : 0u) << lane;
    lit &= ~around_.caster.occluded(rays);
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      if (lit >> lane & 1u) sums_[lighting] += paths_[lane].throughput * offers[lane];
    }
  }

  void connect(const OwnLight& own) {
    RayPacket rays{};
    rays.far.fill(-1.0f);
    std::array<Rgb, kPacketSize> offers{};
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      const Path& path = paths_[lane];
      if (!path.alive || path.bounces == 0) continue;
      offers[lane] = irradiance_at_point(own.light, glm::dvec3(path.at.position), glm::dvec3(path.at.normal));
      if (offers[lane] == Rgb(0.0)) continue;
      const glm::vec3 way = glm::vec3(own.light.position) - path.at.position;
      const float gap = 4.0f * around_.geometry.offset / glm::length(way);
      aim(rays, lane, path.at.position, way, std::max(0.0f, 1.0f - gap));
    }
    add_unblocked(rays, offers, own.lighting);
  }

  void connect_lamp() {
    const std::vector<std::uint32_t>& lamp = around_.lamp_triangles;
    RayPacket rays{};
    rays.far.fill(-1.0f);
    std::array<Rgb, kPacketSize> offers{};
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      Path& path = paths_[lane];
      if (!path.alive) continue;
      const std::uint32_t t = lamp[std::size_t(path.random() * double(lamp.size()))];
      const glm::vec2 at = triangle_point(float(path.random()), float(path.random()));
      const glm::vec3& normal = around_.geometry.normals[t];
      const glm::vec3 way =
          around_.geometry.point(t, at.x, at.y) + around_.geometry.offset * normal - path.at.position;
      const double squared = glm::dot(way, way);
      const double facing = glm::dot(way, path.at.normal), leaving = -glm::dot(way, normal);
      if (facing <= 0.0 || leaving <= 0.0) continue;
      const double area = double(around_.geometry.areas[t]) * double(lamp.size());
      offers[lane] = around_.test.lamp_exitance * (facing * leaving * area / (kPi * squared * squared));
      aim(rays, lane, path.at.position, way, 1.0f);
    }
    for (std::size_t l = 0; l < around_.test.lights.size(); ++l) {
      if (around_.test.lights[l].lamp) add_unblocked(rays, offers, l);
    }
  }

  void go_on() {
    RayPacket rays{};
    rays.far.fill(-1.0f);
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      Path& path = paths_[lane];
      path.alive = path.alive && path.survives();
      if (path.alive) aim(rays, lane, path.at.position, path.direction(), 1e9f);
    }
    around_.caster.closest_hits(rays);
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      if (paths_[lane].alive) arrive(paths_[lane], rays, lane);
    }
  }

  void arrive(Path& path, const RayPacket& rays, std::size_t lane) {
    const std::uint32_t met = rays.triangle[lane];
    std::optional<SurfaceHit> seen;
    if (met != kNoTriangle)
      seen = seen_surface(around_.geometry, {met, rays.u[lane], rays.v[lane]}, direction_of(rays, lane));
    if (around_.options.sky ? met == kNoTriangle : seen.has_value()) glow(path);
    path.alive = seen.has_value();
    if (!seen) return;
    const glm::vec3 normal = around_.geometry.normal(seen->triangle, seen->side);
    path.at = {around_.geometry.point(seen->triangle, seen->u, seen->v) + around_.geometry.offset * normal,
               normal};
    path.throughput *= around_.albedo(*seen);
    ++path.bounces;
    path.alive = path.throughput != Rgb(0.0);
  }

  void glow(const Path& path) {
    for (std::size_t l = 0; l < around_.test.lights.size(); ++l) {
      if (around_.test.lights[l].ambient)
        sums_[l] +=
            path.throughput * (around_.options.sky ? exitance_from_radiance(kAmbientLight) : kAmbientLight);
    }
  }

  const Surroundings& around_;
  SurfacePoint sensor_;
  std::uint64_t seed_;
  std::array<Path, kPacketSize> paths_;
  std::vector<Rgb> sums_;
};

void trace_sensor(const Surroundings& around, const SobolPoints& points, std::uint32_t index,
                  PathIrradiance& result) {
  const SensorPoint& sensor = around.test.sensors[index];
  SensorPaths paths(around, lift_sensor(around.geometry, around.caster, sensor.position, sensor.normal),
                    mix(0x7061746873ull, index));
  const std::size_t lights = around.test.lights.size();
  std::vector<Rgb> means(lights, Rgb(0.0)), squares(lights, Rgb(0.0));
  for (std::uint32_t b = 0; b < kBatches; ++b) {
    const std::vector<Rgb> sums = paths.batch(points, b);
    for (std::size_t l = 0; l < lights; ++l) {
      const Rgb mean = sums[l] / double(points.count());
      means[l] += mean / double(kBatches), squares[l] += mean * mean / double(kBatches);
    }
  }
  for (std::size_t l = 0; l < lights; ++l) {
    const Rgb variance = squares[l] - means[l] * means[l];
    result.values[l][index] = means[l];
    result.noise[l][index] = std::max(0.0, variance.r + variance.g + variance.b) / double(kBatches - 1);
  }
}

}  // namespace

Result<PathIrradiance> path_irradiance(const TestScene& test, const PathOptions& options) {
  const auto around = make_surroundings(test, options);
  if (!around) return tl::unexpected(around.error());
  const std::size_t lights = test.lights.size(), sensors = test.sensors.size();
  PathIrradiance result;
  result.values.assign(lights, std::vector<Rgb>(sensors, Rgb(0.0)));
  result.noise.assign(lights, std::vector<double>(sensors, 0.0));
  std::vector<std::uint32_t> asked = options.sensors;
  if (asked.empty()) {
    asked.resize(sensors);
    std::iota(asked.begin(), asked.end(), 0u);
  }
  const SobolPoints points(std::max(1u, options.paths / kBatches));
  tbb::task_arena arena(arena_threads(options.threads));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, asked.size(),
                      [&](std::size_t i) { trace_sensor(*around, points, asked[i], result); });
  });
  return result;
}

}  // namespace relume
