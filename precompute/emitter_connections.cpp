// SPDX-License-Identifier: MIT
#include "precompute/emitter_connections.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/quantities.h"

namespace relume {
namespace {

/// All lanes at once; the same numbers from either version, for neither contracts nor reorders.
[[gnu::target_clones("avx2", "default")]] void draw_origins(const SobolPoints& points, std::uint64_t key,
                                                            std::uint32_t first, const AreaSampler& receiver,
                                                            SampleLanes& samples, PointLanes& origins) {
  points.scrambled(first, key, samples);
  receiver.sample(samples.coordinate[2], samples.coordinate[3], origins);
}

/// Form factor over the chance of its sample.
double weighted_form_factor(const Connections& connections, std::size_t emitter, double squared,
                            double towards, double back) {
  const double area = connections.emitters.list[emitter].area,
               chance = connections.choice.probability[emitter];
  // `towards` and `back` are cosines times the distance: all that is left of it elsewhere is even powers.
  const double distance = std::sqrt(squared);
  const double by_ray = connections.ray_count * towards / (kPi * distance);
  const double by_area = connections.area_count * chance * squared * distance / (area * back);
  return area * towards * back / (kPi * squared * squared * chance) * power_heuristic(by_area, by_ray);
}

void set_ray(RayPacket& rays, std::size_t lane, const glm::vec3& from, const glm::vec3& way, bool useful) {
  rays.origin_x[lane] = from.x, rays.origin_y[lane] = from.y, rays.origin_z[lane] = from.z;
  rays.direction_x[lane] = way.x, rays.direction_y[lane] = way.y, rays.direction_z[lane] = way.z;
  rays.near[lane] = 0.0f;
  rays.far[lane] = useful ? 1.0f : -1.0f;
}

}  // namespace

double ray_weight(const SampleCounts& counts, double emitter_area, double cos_receiver, double cos_emitter,
                  double distance) {
  const double by_ray = counts.rays * cos_receiver / kPi;
  return power_heuristic(by_ray,
                         counts.area * distance * distance / (emitter_area * std::max(cos_emitter, 1e-9)));
}

RowScales close_row(double emitted, double counted, double row_sum) {
  const double difference = row_sum - emitted - counted;
  const double squares = emitted * emitted + counted * counted;
  if (!(squares > 0.0)) return {};
  return {1.0 + emitted * difference / squares, 1.0 + counted * difference / squares};
}

void fill_connections(const Connections& connections, const SobolPoints& points, std::uint64_t key,
                      std::uint32_t first, ConnectionPacket& packet) {
  const AreaSampler& receiver = connections.receiver.origins();
  SampleLanes samples;
  draw_origins(points, key, connections.area_first + first, receiver, samples, packet.origins);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    float u = samples.coordinate[0][lane];
    const std::size_t chosen = connections.choice.choose(u);
    const SurfacePoint target =
        connections.emitters.list[chosen].points.sample(u, samples.coordinate[1][lane]);
    const glm::vec3& normal = receiver.patch(packet.origins.patch[lane]).frame.normal;
    const glm::vec3 origin(packet.origins.x[lane], packet.origins.y[lane], packet.origins.z[lane]);
    const glm::vec3 from = origin + connections.offset * normal;
    const glm::vec3 way = target.position + connections.offset * target.normal - from;
    const double squared = glm::dot(way, way), towards = glm::dot(way, normal);
    const double back = -glm::dot(way, target.normal);
    const bool useful = first + lane < connections.area_count && squared > 0.0 && towards > 0.0 && back > 0.0;
    packet.emitter[lane] = std::uint32_t(chosen);
    packet.form_factor[lane] =
        useful ? weighted_form_factor(connections, chosen, squared, towards, back) : 0.0;
    set_ray(packet.rays, lane, from, way, useful);
  }
}

}  // namespace relume
