// SPDX-License-Identifier: MIT
//
// The row of one light probe.
#pragma once

#include <vector>

#include "precompute/light_probes.h"

namespace relume {

/// Evenly distributed direction: the hemisphere's lift of the disc (sampling.h) with its polar angle doubled,
/// which keeps areas (J. H. Lambert's projection).
inline glm::vec3 sphere_direction(float u, float v) {
  const glm::vec3 half = cosine_direction(u, v);
  return {2.0f * half.z * half.x, 2.0f * half.z * half.y, 2.0f * half.z * half.z - 1.0f};
}

/// A ray from `from` along `way`, up to `far` times its length; below 0: none.
inline void set_ray(RayPacket& rays, std::size_t lane, const glm::vec3& from, const glm::vec3& way,
                    float far) {
  rays.origin_x[lane] = from.x, rays.origin_y[lane] = from.y, rays.origin_z[lane] = from.z;
  rays.direction_x[lane] = way.x, rays.direction_y[lane] = way.y, rays.direction_z[lane] = way.z;
  rays.near[lane] = 0.0f, rays.far[lane] = far;
}

/// Samples, or what was united before, as one entry for each sender, ascending; a sender that spreads far
/// around the probe as one for each part of the sphere that it is seen in.
std::vector<SeenSender> unite_senders(std::vector<SeenSender> samples);

/// One per thread.
class SphereTracer {
 public:
  explicit SphereTracer(const RowScene& scene);

  /// A ray for each of the points, whose number is a multiple of the size of a packet. `position` is relative
  /// to the origin of the geometry.
  ProbeRow trace(const glm::vec3& position, const SobolPoints& points);

  std::uint64_t rays() const { return rays_; }
  std::uint64_t occlusion_rays() const { return occlusion_rays_; }
  const RaySight& sight() const { return sight_; }

 private:
  struct Totals {
    std::uint32_t arrived = 0, back_faces = 0;
  };
  void choose_emitters(const glm::vec3& position);
  Totals trace_rays(const glm::vec3& position, const SobolPoints& points, std::uint64_t key);
  void add_hit(const RayPacket& packet, const PacketSight& seen, std::size_t lane, Totals& totals);
  double density_by_area(std::uint32_t emitter, double squared_distance, double cosine) const;
  void sample_emitters(const glm::vec3& position, std::uint64_t key);
  void add_connections(const glm::vec3& position, std::uint32_t first, std::uint64_t key);
  /// Both kinds of samples together are scaled to what the rays measured.
  void close(double solid_angle);

  const RowScene& scene_;
  RaySight sight_;
  SobolPoints emitter_points_;
  EmitterChoice choice_;
  std::uint32_t area_samples_ = 0;             ///< of all emitters together
  double density_by_ray_ = 0.0;                ///< rays per sr
  std::vector<SeenSender> counted_, emitted_;  ///< samples of solid angle
  std::uint64_t rays_ = 0, occlusion_rays_ = 0;
};

}  // namespace relume
