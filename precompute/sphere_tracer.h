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

/// One per thread.
class SphereTracer {
 public:
  explicit SphereTracer(const RowScene& scene);

  /// A ray for each of the points, whose number is a multiple of the size of a packet. `position` is relative
  /// to the origin of the geometry.
  ProbeRow trace(const glm::vec3& position, const SobolPoints& points);

  std::uint64_t rays() const { return rays_; }
  std::uint64_t occlusion_rays() const { return occlusion_rays_; }

 private:
  /// A sample of solid angle.
  struct Sample {
    std::uint32_t sender = 0, part = 0;
    double solid_angle = 0.0;
    glm::vec3 direction{0.0f};
  };
  struct Totals {
    std::uint32_t arrived = 0, back_faces = 0;
  };
  void choose_emitters(const glm::vec3& position);
  Totals trace_rays(const glm::vec3& position, const SobolPoints& points, std::uint64_t key);
  void add_hit(const RayPacket& packet, int lane, Totals& totals);
  double density_by_area(std::uint32_t emitter, double squared_distance, double cosine) const;
  void sample_emitters(const glm::vec3& position, std::uint64_t key);
  void add_connections(const glm::vec3& position, std::uint32_t first, std::uint64_t key);
  /// Both kinds of samples together are scaled to what the rays measured.
  void close(double solid_angle);
  std::vector<SeenSender> senders();

  const RowScene& scene_;
  SobolPoints emitter_points_;
  EmitterChoice choice_;
  std::uint32_t area_samples_ = 0;  ///< of all emitters together
  double density_by_ray_ = 0.0;     ///< rays per sr
  std::vector<Sample> counted_, emitted_;
  std::uint64_t rays_ = 0, occlusion_rays_ = 0;
};

}  // namespace relume
