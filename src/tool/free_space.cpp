// SPDX-License-Identifier: MIT
#include "tool/free_space.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tool/view_rays.h"

namespace relume {
namespace {

constexpr int kEyesTried = 256;
constexpr int kEyesKept = 40;
constexpr int kProbeRays = 64;

/// Radical inverse of i in a prime base: evenly spread numbers in 0..1 (J. Halton, 1960).
double halton(std::uint32_t i, std::uint32_t base) {
  double value = 0.0;
  for (double digit = 1.0 / base; i > 0; i /= base, digit /= base) value += digit * (i % base);
  return value;
}

glm::vec3 sphere_direction(int i, int count) {
  const double y = 1.0 - (2.0 * i + 1.0) / count;
  const double angle = i * kPi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(1.0 - y * y);
  return {float(r * std::cos(angle)), float(y), float(r * std::sin(angle))};
}

/// Where the triangles are, along each axis, when the outer `share` of them on each end does not count.
Bounds bounds_without(const Occluders& occluders, double share) {
  Bounds bounds;
  std::vector<double> places(occluders.triangles.size());
  const auto left_out = static_cast<std::size_t>(share * double(places.size()));
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](std::uint32_t t, int k) {
      return double(occluder_corner(occluders, t, k)[axis]);
    };
    for (std::uint32_t t = 0; t < places.size(); ++t) {
      places[t] = std::min({coordinate(t, 0), coordinate(t, 1), coordinate(t, 2)});
    }
    std::sort(places.begin(), places.end());
    bounds.low[axis] = places[left_out];
    for (std::uint32_t t = 0; t < places.size(); ++t) {
      places[t] = std::max({coordinate(t, 0), coordinate(t, 1), coordinate(t, 2)});
    }
    std::sort(places.begin(), places.end());
    bounds.high[axis] = places[places.size() - 1 - left_out];
  }
  return bounds;
}

/// Cast rays without passing any backs: what is really there.
struct Surroundings {
  double front = 0.0;     ///< shares of the rays
  double back = 0.0;      ///< of single-sided surfaces
  double nearest = 0.0;   ///< distances; misses count as the diagonal
  double openness = 0.0;  ///< geometric mean distance of what is met
};

Surroundings look_around(const Model& model, const RayCaster& caster, const glm::vec3& eye, double diagonal) {
  Surroundings around;
  around.nearest = diagonal;
  double log_sum = 0.0;
  for (int first = 0; first < kProbeRays; first += kPacketSize) {
    ViewRays rays;
    for (int lane = 0; lane < kPacketSize; ++lane)
      rays[lane] = {eye, sphere_direction(first + lane, kProbeRays)};
    RayPacket packet = packet_of(rays);
    caster.closest_hits(packet);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const bool met = packet.triangle[lane] != kNoTriangle;
      const double distance = met ? std::min(double(packet.far[lane]), diagonal) : diagonal;
      around.nearest = std::min(around.nearest, distance);
      if (!met) continue;
      log_sum += std::log(std::max(distance, 1e-6 * diagonal));
      const SeenPoint point = seen_point(model, packet.triangle[lane], {}, rays[lane].direction);
      (hidden_back(model, point) ? around.back : around.front) += 1.0 / kProbeRays;
    }
  }
  const double share = around.front + around.back;
  around.openness = share > 0.0 ? std::exp(log_sum / (share * kProbeRays)) : 0.0;
  return around;
}

/// A place in the free space in front of a triangle: part of the way to whatever is opposite.
glm::vec3 place_before(const Model& model, const RayCaster& caster, std::uint32_t i, double diagonal) {
  const Occluders& occluders = model.occluders;
  const auto count = static_cast<std::uint32_t>(occluders.triangles.size());
  const auto triangle = std::min(static_cast<std::uint32_t>(halton(i, 2) * count), count - 1);
  const glm::vec3& a = occluder_corner(occluders, triangle, 0);
  const glm::vec3& b = occluder_corner(occluders, triangle, 1);
  const glm::vec3& c = occluder_corner(occluders, triangle, 2);
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const float root = std::sqrt(float(halton(i, 3)));
  const float along = float(halton(i, 5));
  const glm::vec3 start =
      (1.0f - root) * a + root * (1.0f - along) * b + root * along * c + float(1e-4 * diagonal) * normal;
  ViewRays rays;
  rays.fill({start, normal});
  const ViewHit hit = trace(model, caster, rays)[0];
  const double reach = hit.met ? std::min(double(hit.distance), 0.5 * diagonal) : 0.3 * diagonal;
  return start + float(reach * (0.15 + 0.7 * halton(i, 7))) * normal;
}

}  // namespace

Bounds interesting_bounds(const Occluders& occluders) {
  const Bounds all = bounds_without(occluders, 0.0);
  const Bounds busy = bounds_without(occluders, 0.05);
  return all.diagonal() > 2.0 * busy.diagonal() ? busy : all;
}

std::vector<Eye> eyes_in_free_space(const Model& model, const RayCaster& caster, double diagonal) {
  std::vector<Eye> eyes(kEyesTried);
  tbb::parallel_for(0, kEyesTried, [&](int i) {
    const glm::vec3 place = place_before(model, caster, static_cast<std::uint32_t>(i) + 1, diagonal);
    const Surroundings around = look_around(model, caster, place, diagonal);
    const bool usable = around.back < 0.4 && around.front > 0.3 && around.nearest > 0.01 * diagonal;
    eyes[i] = {glm::dvec3(place), usable ? around.openness * around.front : 0.0, around.front};
  });
  std::stable_sort(eyes.begin(), eyes.end(), [](const Eye& a, const Eye& b) { return a.worth > b.worth; });
  std::erase_if(eyes, [](const Eye& eye) { return eye.worth <= 0.0; });
  if (eyes.size() > kEyesKept) eyes.resize(kEyesKept);
  return eyes;
}

}  // namespace relume
