// SPDX-License-Identifier: MIT
#include "precompute/emitter_connections.h"

#include <algorithm>
#include <cmath>

#include "core/quantities.h"

namespace relume {
namespace {

/// Of a sample that one technique draws with `own` density and the other with `other`: the power heuristic of
/// exponent 2. The balance heuristic would leave a small lamp's few hits by rays a share, and all of their
/// noise.
[[gnu::always_inline]] inline double weight(double own, double other) {
  return own * own / (own * own + other * other);
}

/// All lanes at once; the same numbers from either version, for neither contracts nor reorders.
[[gnu::target_clones("avx2", "default")]] void draw_points(const SobolPoints& points, std::uint64_t key,
                                                           std::uint32_t first, const AreaSampler& receiver,
                                                           const AreaSampler& emitter, PointLanes& origins,
                                                           PointLanes& targets) {
  SampleLanes samples;
  points.scrambled(first, key, samples);
  emitter.sample(samples.coordinate[0], samples.coordinate[1], targets);
  receiver.sample(samples.coordinate[2], samples.coordinate[3], origins);
}

void lift(const AreaSampler& sampler, float offset, PointLanes& points) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const glm::vec3& normal = sampler.patch(points.patch[lane]).frame.normal;
    points.x[lane] += offset * normal.x;
    points.y[lane] += offset * normal.y;
    points.z[lane] += offset * normal.z;
  }
}

}  // namespace

double ray_weight(const SampleCounts& counts, double emitter_area, double cos_receiver, double cos_emitter,
                  double distance) {
  const double by_ray = counts.rays * cos_receiver / kPi;
  return weight(by_ray, counts.area * distance * distance / (emitter_area * std::max(cos_emitter, 1e-9)));
}

void fill_connections(const Receiver& receiver, const Emitter& emitter, const SampleCounts& counts,
                      const SobolPoints& points, std::uint64_t key, std::uint32_t first, float offset,
                      ConnectionPacket& packet) {
  PointLanes from, to;
  draw_points(points, key, first, receiver.origins(), emitter.points, packet.origins, to);
  from = packet.origins;
  lift(receiver.origins(), offset, from);
  lift(emitter.points, offset, to);
  RayPacket& rays = packet.rays;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const glm::vec3 way(to.x[lane] - from.x[lane], to.y[lane] - from.y[lane], to.z[lane] - from.z[lane]);
    rays.origin_x[lane] = from.x[lane], rays.origin_y[lane] = from.y[lane],
    rays.origin_z[lane] = from.z[lane];
    rays.direction_x[lane] = way.x, rays.direction_y[lane] = way.y, rays.direction_z[lane] = way.z;
    const double squared = glm::dot(way, way);
    const double towards = glm::dot(way, receiver.origins().patch(packet.origins.patch[lane]).frame.normal);
    const double back = -glm::dot(way, emitter.points.patch(to.patch[lane]).frame.normal);
    const bool useful = first + lane < counts.area && squared > 0.0 && towards > 0.0 && back > 0.0;
    rays.near[lane] = 0.0f;
    rays.far[lane] = useful ? 1.0f : -1.0f;
    packet.form_factor[lane] = 0.0;
    if (!useful) continue;
    // Cosines are towards / d and back / d: all that is left of the distance is even powers.
    const double kernel = towards * back / (kPi * squared * squared);
    const double by_ray = counts.rays * towards / (kPi * std::sqrt(squared));
    const double by_area = counts.area * squared * std::sqrt(squared) / (emitter.area * back);
    packet.form_factor[lane] = emitter.area * kernel * weight(by_area, by_ray);
  }
}

}  // namespace relume
