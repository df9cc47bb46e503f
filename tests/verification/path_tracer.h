// SPDX-License-Identifier: MIT
//
// The independent witness: a plain Monte Carlo path tracer in double precision on a Scene. It shares nothing
// with the precompute but the Scene: no Embree, no clusters, no form factors, a random number generator and a
// tree of its own.
//
// Surfaces are Lambert. The front of a single-sided surface reflects and emits, its back is opaque and black;
// both sides of a double-sided surface reflect and emit. Materials are constant: textures and vertex colours
// are refused.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/light.h"
#include "scene/scene.h"

namespace relume::test {

struct SurfacePoint3 {
  glm::dvec3 position{0.0};  ///< just above the surface
  glm::dvec3 normal{0.0};    ///< unit
};

/// A mean over batches and its standard error, from their scatter.
struct Estimate {
  Rgb mean{0.0};
  Rgb standard_error{0.0};
};

struct PathOptions {
  std::uint32_t batches = 16;
  std::uint32_t paths_per_batch = 256;  ///< rounded down to a square: first directions are stratified
  std::uint64_t seed = 1;
};

class PathTracer {
 public:
  /// Radiance (cd/m2) that arrives from a unit direction out of the scene; empty: black.
  using Sky = std::function<Rgb(const glm::dvec3&)>;

  /// `lights` replace those of the scene. Borrows nothing. Throws std::invalid_argument for textures.
  PathTracer(const Scene& scene, std::vector<Light> lights, Sky sky = {});

  /// lm/m2 from punctual lights, unreflected, with shadows: exact.
  Rgb direct(const SurfacePoint3& at) const;

  /// lm/m2 of all the rest: from emitting surfaces and the sky, and after any number of reflections (Russian
  /// roulette, no clamping). Emitters are sampled by area and by direction, combined by the balance heuristic
  /// (E. Veach, L. Guibas, 1995). Thread-safe; the same for the same seed.
  Estimate indirect(const SurfacePoint3& at, const PathOptions& options) const;

  /// Coefficients of the radiance that arrives at a point from all sides but from punctual lights themselves:
  /// real orthonormal harmonics Y00; y, z, x; xy, yz, 3z2 - 1, xz, x2 - y2. Directions are stratified over
  /// the sphere; emitters are sampled by area.
  std::array<Estimate, 9> incident(const glm::dvec3& position, const PathOptions& options) const;

  /// The same for many points, on all cores.
  std::vector<Estimate> indirect(std::span<const SurfacePoint3> points, const PathOptions& options) const;

 private:
  class Random;
  struct Triangle {
    glm::dvec3 corner, edge1, edge2, normal;
    Rgb albedo, exitance;
    bool double_sided;
  };
  struct Node {  ///< leaf when count > 0: triangles order_[first ... first + count)
    glm::dvec3 lower, upper;
    std::uint32_t first = 0, count = 0;
    std::uint32_t right = 0;  ///< inner: left child follows
  };
  struct Hit {
    double distance = 0.0;
    std::uint32_t triangle = 0;
  };
  struct EmittingSide {
    std::uint32_t triangle = 0;
    double sign = 1.0;     ///< of the triangle's normal
    double density = 0.0;  ///< probability per area of choosing a point on it
    double cumulative = 0.0;
  };
  void add_triangles(const Scene& scene);
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  void find_emitters();
  bool closest(const glm::dvec3& origin, const glm::dvec3& direction, double far, Hit& hit) const;
  bool blocked(const glm::dvec3& from, const glm::dvec3& to) const;
  struct EmitterPoint {
    const EmittingSide& side;
    glm::dvec3 position, normal;
  };
  /// By area. There must be an emitter.
  EmitterPoint choose_emitter(Random& random) const;
  Rgb emitted_by_area(const SurfacePoint3& at, Random& random) const;
  double emitter_density(std::uint32_t triangle, double sign) const;
  struct Seen {
    glm::dvec3 direction{0.0};
    Rgb light{0.0};  ///< radiance over the density of the direction
  };
  /// What a surface reflects, or the sky.
  Rgb radiance(const glm::dvec3& origin, const glm::dvec3& direction, Random& random) const;
  Seen seen_emitter(const glm::dvec3& origin, Random& random) const;
  Rgb path(SurfacePoint3 at, glm::dvec3 direction, Random& random) const;
  Rgb batch(const SurfacePoint3& at, std::uint32_t side, Random& random) const;

  std::vector<Light> lights_;
  Sky sky_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<EmittingSide> emitters_;
  std::vector<std::array<double, 2>> density_;  ///< per triangle: front, back
  double lift_ = 0.0;                           ///< m, off the surface before a ray starts
};

}  // namespace relume::test
