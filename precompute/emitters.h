// SPDX-License-Identifier: MIT
//
// Possible emitters: small surfaces whose form factors hemisphere rays would estimate badly. They are also
// sampled over their area, with occlusion rays; both estimates are combined by the power heuristic (E.
// Veach, L. Guibas, Optimally Combining Sampling Techniques, 1995).
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/area_sampler.h"
#include "precompute/receiver.h"
#include "precompute/sender_lookup.h"
#include "scene/scene.h"

namespace relume {

/// Whether surfaces of a material send light of their own.
inline bool shines(const SceneMaterial& m) {
  return !m.unlit && (m.emission.r > 0.0 || m.emission.g > 0.0 || m.emission.b > 0.0);
}

/// One cluster that may emit.
struct Emitter {
  std::uint32_t cluster = 0;  ///< numbered through over all systems
  std::uint32_t material = 0;
  double area = 0.0;  ///< m2
  glm::vec3 centroid{0.0f};
  glm::vec3 normal{0.0f};  ///< mean, not unit: shorter the more the cluster bends
  float radius = 0.0f;     ///< of a sphere about the centroid that holds it
  AreaSampler points;
};

struct Emitters {
  std::vector<Emitter> list;
  std::vector<std::uint32_t> of_cluster;  ///< per cluster of all systems: index into `list`, or kNone

  /// Index into `list` of a sender, or kNone.
  std::uint32_t of(std::uint32_t sender) const { return list.empty() ? kNone : of_cluster[sender]; }
  bool contain(std::uint32_t sender) const { return of(sender) != kNone; }
};

/// Clusters of materials that may emit (`material_emits`, per material) or of nodes that may (`node_emits`).
Emitters find_emitters(const Geometry& geometry, const std::vector<Chart>& charts,
                       const std::vector<ClusteredSurface>& systems, const std::vector<bool>& material_emits,
                       const std::vector<bool>& node_emits);

/// Clusters have new numbers: `numbers` per old one.
void renumber(const std::vector<std::uint32_t>& numbers, Emitters& emitters);

/// Area samples go with every so many rays of a receiver, up to so many.
inline constexpr std::uint32_t kRaysPerAreaSample = 16, kMaxAreaSamples = 4096;

/// How often area samples go to each emitter: in proportion to an upper estimate of its unoccluded form
/// factor.
struct EmitterChoice {
  std::vector<double> probability;  ///< per emitter, sums to 1; 0 when it is behind, all 0 when all are
  std::vector<double> cumulative;   ///< of those up to and with each
  bool any() const { return !cumulative.empty() && cumulative.back() > 0.0; }

  /// The emitter that u in [0, 1) falls to; u is stretched to [0, 1) again.
  std::size_t choose(float& u) const;
};

/// Fills `choice`, which keeps its memory between calls.
void choose_emitters(const Emitters& emitters, const Receiver& receiver, EmitterChoice& choice);

}  // namespace relume
