// SPDX-License-Identifier: MIT
#include "verification/path_tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

namespace relume::test {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr std::uint32_t kCertainBounces = 3;  ///< before roulette begins

/// What a light gives to a point at `to_light` with unit normal n, unshadowed: KHR_lights_punctual.
Rgb unshadowed(const Light& light, const glm::dvec3& position, const glm::dvec3& n) {
  if (light.type == LightType::directional) {
    return light.intensity * std::max(0.0, -glm::dot(n, light.direction));
  }
  const glm::dvec3 to = light.position - position;
  const double distance = glm::length(to);
  double factor = std::max(0.0, glm::dot(n, to) / distance) / (distance * distance);
  if (light.type == LightType::spot) {
    const double cosine = -glm::dot(to, light.direction) / distance;
    const double outer = std::cos(light.outer_cone_angle), inner = std::cos(light.inner_cone_angle);
    const double a = std::clamp((cosine - outer) / std::max(0.001, inner - outer), 0.0, 1.0);
    factor *= a * a;
  }
  if (light.range > 0.0) factor *= std::clamp(1.0 - std::pow(distance / light.range, 4.0), 0.0, 1.0);
  return light.intensity * factor;
}

glm::dvec3 any_perpendicular(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

/// Cosine-distributed direction about n: a point of the disc, lifted.
glm::dvec3 cosine_about(const glm::dvec3& n, double u, double v) {
  const glm::dvec3 t = any_perpendicular(n), b = glm::cross(n, t);
  const double r = std::sqrt(u), phi = 2.0 * kPi * v;
  return r * std::cos(phi) * t + r * std::sin(phi) * b + std::sqrt(1.0 - u) * n;
}

double brightness(const Rgb& c) {
  return c.r + c.g + c.b;
}

}  // namespace

class PathTracer::Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double operator()() { return double(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

PathTracer::PathTracer(const Scene& scene, std::vector<Light> lights, Sky sky)
    : lights_(std::move(lights)), sky_(std::move(sky)) {
  add_triangles(scene);
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(0, std::uint32_t(order_.size()));
  find_emitters();
}

void PathTracer::add_triangles(const Scene& scene) {
  for (const SceneSurface& surface : scene.surfaces) {
    const SceneMaterial& material = scene.materials[surface.material];
    if (material.base_color_texture || material.emission_texture || surface.has_colors) {
      throw std::invalid_argument("path tracer: material " + material.name + " is not constant");
    }
    const bool dark = material.unlit;
    for (std::uint32_t t = surface.first_triangle; t < surface.first_triangle + surface.triangle_count; ++t) {
      const auto& p = scene.vertices.positions;
      const auto& corners = scene.triangles[t];
      const glm::dvec3 a = p[corners[0]], e1 = p[corners[1]] - a, e2 = p[corners[2]] - a;
      triangles_.push_back({a, e1, e2, glm::normalize(glm::cross(e1, e2)),
                            dark ? Rgb(0.0) : material.base_color, dark ? Rgb(0.0) : kPi * material.emission,
                            material.double_sided});
      for (const auto corner : corners) lift_ = std::max(lift_, 1e-10 * glm::length(p[corner]));
    }
  }
}

std::uint32_t PathTracer::build(std::uint32_t first, std::uint32_t count) {
  const auto index = std::uint32_t(nodes_.size());
  glm::dvec3 lower(std::numeric_limits<double>::max()), upper(-lower);
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[order_[i]];
    for (const glm::dvec3& p : {t.corner, t.corner + t.edge1, t.corner + t.edge2}) {
      lower = glm::min(lower, p);
      upper = glm::max(upper, p);
    }
  }
  nodes_.push_back({lower, upper, first, count, 0});
  if (count <= kLeafTriangles) return index;
  const glm::dvec3 size = upper - lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const auto middle = [&](std::uint32_t t) {
    return 3.0 * triangles_[t].corner[axis] + triangles_[t].edge1[axis] + triangles_[t].edge2[axis];
  };
  const std::uint32_t half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                   [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
  build(first, half);
  const std::uint32_t right = build(first + half, count - half);
  nodes_[index].count = 0;
  nodes_[index].right = right;
  return index;
}

void PathTracer::find_emitters() {
  density_.assign(triangles_.size(), {0.0, 0.0});
  double total = 0.0;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const double weight = brightness(triangles_[t].exitance);
    if (!(weight > 0.0)) continue;
    const double area = 0.5 * glm::length(glm::cross(triangles_[t].edge1, triangles_[t].edge2));
    for (int side = 0; side < (triangles_[t].double_sided ? 2 : 1); ++side) {
      total += weight * area;
      emitters_.push_back({t, side == 0 ? 1.0 : -1.0, weight, total});
    }
  }
  for (EmittingSide& emitter : emitters_) {
    emitter.density /= total;
    emitter.cumulative /= total;
    density_[emitter.triangle][emitter.sign > 0.0 ? 0 : 1] = emitter.density;
  }
}

bool PathTracer::closest(const glm::dvec3& origin, const glm::dvec3& direction, double far, Hit& hit) const {
  if (nodes_.empty()) return false;
  bool found = false;
  hit.distance = far;
  const glm::dvec3 inverse = 1.0 / direction;
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    const glm::dvec3 a = (node.lower - lift_ - origin) * inverse, b = (node.upper + lift_ - origin) * inverse;
    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
    const double enter = std::max({low.x, low.y, low.z, 0.0});
    if (!(enter <= std::min({high.x, high.y, high.z, hit.distance}))) continue;
    if (node.count == 0) {
      stack[depth++] = node.right;
      stack[depth++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      // T. Moeller, B. Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997.
      const Triangle& t = triangles_[order_[i]];
      const glm::dvec3 p = glm::cross(direction, t.edge2);
      const double determinant = glm::dot(t.edge1, p);
      if (determinant == 0.0) continue;
      const glm::dvec3 s = origin - t.corner;
      const double u = glm::dot(s, p) / determinant;
      if (u < 0.0 || u > 1.0) continue;
      const glm::dvec3 q = glm::cross(s, t.edge1);
      const double v = glm::dot(direction, q) / determinant;
      if (v < 0.0 || u + v > 1.0) continue;
      const double distance = glm::dot(t.edge2, q) / determinant;
      if (distance <= 0.0 || distance >= hit.distance) continue;
      hit = {distance, order_[i]};
      found = true;
    }
  }
  return found;
}

bool PathTracer::blocked(const glm::dvec3& from, const glm::dvec3& to) const {
  Hit hit;
  return closest(from, to - from, 1.0, hit);
}

Rgb PathTracer::direct(const SurfacePoint3& at) const {
  Rgb sum(0.0);
  for (const Light& light : lights_) {
    const Rgb arriving = unshadowed(light, at.position, at.normal);
    if (!(brightness(arriving) > 0.0)) continue;
    Hit hit;
    const bool dark =
        light.type == LightType::directional
            ? closest(at.position, -light.direction, std::numeric_limits<double>::infinity(), hit)
            : blocked(at.position, light.position);
    if (!dark) sum += arriving;
  }
  return sum;
}

double PathTracer::emitter_density(std::uint32_t triangle, double sign) const {
  return density_[triangle][sign > 0.0 ? 0 : 1];
}

PathTracer::EmitterPoint PathTracer::choose_emitter(Random& random) const {
  const double choice = random();
  const auto chosen = std::find_if(emitters_.begin(), emitters_.end() - 1,
                                   [&](const EmittingSide& e) { return choice < e.cumulative; });
  const Triangle& triangle = triangles_[chosen->triangle];
  const double root = std::sqrt(random()), v = random();
  const glm::dvec3 normal = chosen->sign * triangle.normal;
  return {*chosen,
          triangle.corner + root * (1.0 - v) * triangle.edge1 + root * v * triangle.edge2 + lift_ * normal,
          normal};
}

Rgb PathTracer::emitted_by_area(const SurfacePoint3& at, Random& random) const {
  if (emitters_.empty()) return Rgb(0.0);
  const EmitterPoint chosen = choose_emitter(random);
  const glm::dvec3 way = chosen.position - at.position;
  const double squared = glm::dot(way, way), distance = std::sqrt(squared);
  const double cos_receiver = glm::dot(way, at.normal) / distance,
               cos_emitter = -glm::dot(way, chosen.normal) / distance;
  if (cos_receiver <= 0.0 || cos_emitter <= 0.0 || blocked(at.position, chosen.position)) return Rgb(0.0);
  const double by_area = chosen.side.density * squared / cos_emitter, by_direction = cos_receiver / kPi;
  return triangles_[chosen.side.triangle].exitance * (cos_receiver / kPi) / (by_area + by_direction);
}

Rgb PathTracer::path(SurfacePoint3 at, glm::dvec3 direction, Random& random) const {
  Rgb sum(0.0), throughput(1.0);
  for (std::uint32_t bounce = 0;; ++bounce) {
    sum += throughput * emitted_by_area(at, random);
    Hit hit;
    if (!closest(at.position, direction, std::numeric_limits<double>::infinity(), hit)) {
      return sky_ ? sum + throughput * kPi * sky_(direction) : sum;
    }
    const Triangle& triangle = triangles_[hit.triangle];
    const double facing = -glm::dot(direction, triangle.normal);
    if (facing < 0.0 && !triangle.double_sided) return sum;
    const double sign = facing < 0.0 ? -1.0 : 1.0;
    const double by_direction = glm::dot(direction, at.normal) / kPi;
    const double by_area = emitter_density(hit.triangle, sign) * hit.distance * hit.distance /
                           std::max(std::abs(facing), 1e-300);
    if (by_direction > 0.0) sum += throughput * triangle.exitance * (by_direction / (by_direction + by_area));
    throughput *= triangle.albedo;
    if (bounce >= kCertainBounces) {
      const double survival = std::min(0.95, std::max({throughput.r, throughput.g, throughput.b}));
      if (!(random() < survival)) return sum;
      throughput /= survival;
    }
    const glm::dvec3 normal = sign * triangle.normal;
    at = {at.position + hit.distance * direction + lift_ * normal, normal};
    sum += throughput * direct(at);
    const double u = random();
    direction = cosine_about(normal, u, random());
  }
}

Rgb PathTracer::radiance(const glm::dvec3& origin, const glm::dvec3& direction, Random& random) const {
  Hit hit;
  if (!closest(origin, direction, std::numeric_limits<double>::infinity(), hit))
    return sky_ ? sky_(direction) : Rgb(0.0);
  const Triangle& triangle = triangles_[hit.triangle];
  const double facing = -glm::dot(direction, triangle.normal);
  if (facing < 0.0 && !triangle.double_sided) return Rgb(0.0);
  const glm::dvec3 normal = facing < 0.0 ? -triangle.normal : triangle.normal;
  const SurfacePoint3 at{origin + hit.distance * direction + lift_ * normal, normal};
  const double u = random();
  const Rgb irradiance = direct(at) + path(at, cosine_about(normal, u, random()), random);
  return triangle.albedo * irradiance / kPi;
}

PathTracer::Seen PathTracer::seen_emitter(const glm::dvec3& origin, Random& random) const {
  if (emitters_.empty()) return {};
  const EmitterPoint chosen = choose_emitter(random);
  const glm::dvec3 way = chosen.position - origin;
  const double squared = glm::dot(way, way), cosine = -glm::dot(way, chosen.normal) / std::sqrt(squared);
  if (cosine <= 0.0 || blocked(origin, chosen.position)) return {};
  return {glm::normalize(way),
          triangles_[chosen.side.triangle].exitance / kPi * (cosine / (squared * chosen.side.density))};
}

namespace {

std::array<double, 9> harmonics_of(const glm::dvec3& d) {
  return {std::sqrt(1.0 / (4.0 * kPi)),
          std::sqrt(3.0 / (4.0 * kPi)) * d.y,
          std::sqrt(3.0 / (4.0 * kPi)) * d.z,
          std::sqrt(3.0 / (4.0 * kPi)) * d.x,
          std::sqrt(15.0 / (4.0 * kPi)) * d.x * d.y,
          std::sqrt(15.0 / (4.0 * kPi)) * d.y * d.z,
          std::sqrt(5.0 / (16.0 * kPi)) * (3.0 * d.z * d.z - 1.0),
          std::sqrt(15.0 / (4.0 * kPi)) * d.x * d.z,
          std::sqrt(15.0 / (16.0 * kPi)) * (d.x * d.x - d.y * d.y)};
}

}  // namespace

std::array<Estimate, 9> PathTracer::incident(const glm::dvec3& position, const PathOptions& options) const {
  const auto side = std::max(1u, std::uint32_t(std::sqrt(double(options.paths_per_batch)) + 1e-9));
  Random random(options.seed);
  std::array<Rgb, 9> sum{}, squares{};
  for (std::uint32_t b = 0; b < options.batches; ++b) {
    std::array<Rgb, 9> batch{};
    for (std::uint32_t i = 0; i < side * side; ++i) {
      const double z = 2.0 * (i / side + random()) / side - 1.0;
      const double phi = 2.0 * kPi * (i % side + random()) / side;
      const double across = std::sqrt(1.0 - z * z);
      const glm::dvec3 direction(across * std::cos(phi), across * std::sin(phi), z);
      const Rgb reflected = radiance(position, direction, random) * (4.0 * kPi);
      const Seen emitted = seen_emitter(position, random);
      const auto at_direction = harmonics_of(direction), at_emitter = harmonics_of(emitted.direction);
      for (std::size_t h = 0; h < 9; ++h)
        batch[h] += (at_direction[h] * reflected + at_emitter[h] * emitted.light) / double(side * side);
    }
    for (std::size_t h = 0; h < 9; ++h) sum[h] += batch[h], squares[h] += batch[h] * batch[h];
  }
  const double n = options.batches;
  std::array<Estimate, 9> result;
  for (std::size_t h = 0; h < 9; ++h) {
    const Rgb mean = sum[h] / n;
    result[h] = {mean, glm::sqrt(glm::max(Rgb(0.0), squares[h] / n - mean * mean) / (n - 1.0))};
  }
  return result;
}

Rgb PathTracer::batch(const SurfacePoint3& at, std::uint32_t side, Random& random) const {
  Rgb sum(0.0);
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double u = (i / side + random()) / side;
    const double v = (i % side + random()) / side;
    sum += path(at, cosine_about(at.normal, u, v), random);
  }
  return sum / double(side * side);
}

Estimate PathTracer::indirect(const SurfacePoint3& at, const PathOptions& options) const {
  const auto side = std::max(1u, std::uint32_t(std::sqrt(double(options.paths_per_batch)) + 1e-9));
  Random random(options.seed);
  Rgb sum(0.0), squares(0.0);
  for (std::uint32_t b = 0; b < options.batches; ++b) {
    const Rgb value = batch(at, side, random);
    sum += value;
    squares += value * value;
  }
  const double n = options.batches;
  const Rgb mean = sum / n;
  const Rgb variance = glm::max(Rgb(0.0), squares / n - mean * mean) / (n - 1.0);
  return {mean, glm::sqrt(variance)};
}

std::vector<Estimate> PathTracer::indirect(std::span<const SurfacePoint3> points,
                                           const PathOptions& options) const {
  std::vector<Estimate> estimates(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    PathOptions own = options;
    own.seed = options.seed * 1000003 + i;
    estimates[i] = indirect(points[i], own);
  });
  return estimates;
}

}  // namespace relume::test
