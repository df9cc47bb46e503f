// SPDX-License-Identifier: MIT
//
// One row of form factors: cosine-weighted rays from a receiver, and area samples of possible emitters.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "precompute/emitter_connections.h"
#include "precompute/emitters.h"
#include "precompute/geometry.h"
#include "precompute/hemisphere_rays.h"
#include "precompute/ray_caster.h"
#include "precompute/ray_sight.h"
#include "precompute/receiver.h"
#include "precompute/sampling.h"
#include "precompute/sender_lookup.h"
#include "precompute/sender_set.h"

namespace relume {

/// Senders numbered through: clusters of all systems, then sky cells (6 n^2 of them). Ascending.
struct FormFactorRow {
  std::vector<std::uint32_t> senders;
  std::vector<float> values;
  /// Per sender, in a directional scene: value x mean direction towards what is seen of it; else empty.
  std::vector<glm::vec3> moments{};
};

/// Points [first, first + count) of a sequence; both are multiples of the size of a packet.
struct PointRange {
  std::uint32_t first = 0, count = 0;
};

/// What a row was traced with.
struct RowRays {
  std::uint32_t count = 0;
  float noise = 0.0f;  ///< estimate, relative to the irradiance of the room; 0 where nobody asked
  VarianceShares variance{};
};

struct TracedRow {
  FormFactorRow row;
  float back_face_share = 0.0f;  ///< of its rays; they add nothing to the row
};

/// All that rows share.
struct RowScene {
  const Geometry& geometry;
  const RayCaster& caster;
  const SenderLookup& lookup;
  const Emitters& emitters;
  std::uint32_t cluster_count = 0;
  std::uint32_t sky_resolution = 0;
  std::vector<std::uint32_t> sky_senders;  ///< per cell of the sky: its number among the senders
  std::uint64_t seed = 0;
  bool directional = false;     ///< rows have moments
  RayMemory* memory = nullptr;  ///< knows rays that need not be traced; none: all are
};

/// Of RowScene: clusters and cells of the sky.
std::size_t sender_count(const RowScene& scene);

/// One per thread: holds the counters that a row is gathered in.
class RowTracer {
 public:
  explicit RowTracer(const RowScene& scene);

  /// A ray for each point of `range`. Form factors are shares of the rays; those of emitters are combined
  /// with area samples, one for every 16 rays, and the rest of the row is scaled so that the sum stays what
  /// the rays measured.
  TracedRow trace(const Receiver& receiver, const SobolPoints& points, const PointRange& range);

  /// These will be traced next: fetches what is known of their rays, which is faster for several at once.
  void expect(std::span<const Receiver> receivers);

  std::uint64_t rays() const { return rays_; }
  std::uint64_t occlusion_rays() const { return occlusion_rays_; }
  const RaySight& sight() const { return sight_; }

 private:
  struct Totals {
    std::uint32_t traced = 0, arrived = 0, arrived_at_emitters = 0, back_faces = 0;
  };
  Totals trace_hemisphere(const Receiver& receiver, const SobolPoints& points, const PointRange& range,
                          std::uint64_t key);
  /// Counts what is known, and lists the points that are not.
  void count_known(const Receiver& receiver, const SobolPoints& points, const PointRange& range,
                   std::uint64_t key, Totals& totals);
  /// Doubtful points are counted, or open.
  void settle_doubts(const Receiver& receiver, const SobolPoints& points, std::uint64_t key);
  std::uint32_t count_arrival(std::uint32_t place, std::uint32_t sender, Totals& totals);
  std::uint32_t count_place(std::uint32_t place, std::uint32_t sender, Totals& totals);
  /// Of the packet, directions and origins of lanes that see a possible emitter, or of all in a directional
  /// scene.
  void count_hit(const Receiver& receiver, const HemispherePacket& packet, const PacketSight& seen, int lane,
                 std::uint32_t ray_count, Totals& totals);
  void add_emitter_hit(std::uint32_t emitter, const RayPacket& packet, const PacketSight& seen, int lane,
                       const glm::vec3& normal, std::uint32_t ray_count);
  void sample_emitters(const Receiver& receiver, const PointRange& range, std::uint32_t traced,
                       std::uint64_t key);
  /// How many samples of the packet belong to the receiver.
  std::uint32_t add_connections(const Receiver& receiver, std::uint32_t start, std::uint32_t first,
                                ConnectionPacket& packet);
  FormFactorRow finish_row(const Totals& totals);
  /// Value x mean direction of a sender, whose emitter is `emitter`, or kNone.
  glm::vec3 finish_moment(std::uint32_t sender, std::uint32_t emitter, const RowScales& scales,
                          std::uint32_t traced);

  const RowScene& scene_;
  RaySight sight_;
  SobolPoints emitter_points_;
  RayTally tally_;                  ///< of rays that arrived, except those counted in emitter_sums_
  std::uint32_t area_samples_ = 0;  ///< of all emitters together
  EmitterChoice choice_;
  std::vector<double> emitter_sums_;  ///< per emitter: form factor
  std::vector<double> area_sums_;     ///< per emitter: what area samples add up to
  // The same sums of directions, each times what it counts; empty unless the scene is directional.
  std::vector<glm::dvec3> direction_sums_;   ///< per sender
  std::vector<glm::dvec3> emitter_moments_;  ///< per emitter
  std::vector<glm::dvec3> area_moments_;     ///< per emitter
  std::vector<std::uint64_t> expected_;      // its memory serves again
  std::uint64_t rays_ = 0;
  std::uint64_t occlusion_rays_ = 0;
};

}  // namespace relume
