// SPDX-License-Identifier: MIT
//
// Probing emissions: lightings made from the geometry alone, that stand for those that the precompute does
// not know. What they leave on the surfaces tells which differences between senders matter and how many rays
// a row needs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "precompute/cluster_tree.h"
#include "precompute/emitters.h"
#include "precompute/number_senders.h"
#include "precompute/row_tracer.h"

namespace relume {

struct ElementRooms;
struct SurveyRows;

/// So many probing emissions at once, one channel each.
inline constexpr std::size_t kProbings = 16;
using ProbingValues = std::array<float, kProbings>;

/// No place counts as more wrong than this in estimates of errors, squared and of the mean of its room: where
/// a lamp happens to glow into a gap, few square centimetres would stand for the whole scene.
inline constexpr double kWhollyWrong = 1.0;

/// Whether rooms that have possible emitters are lit by these.
constexpr bool by_emitters(std::size_t probing) {
  return probing % 8 == 1;
}

/// Where the surface of a node lies.
struct NodeSurface {
  float area = 0.0f;       ///< m2
  float room_area = 0.0f;  ///< m2, of the room that it lies in
  glm::vec3 centroid{0.0f}, normal{0.0f};
};

/// What rooms get of the light of others, of those that are large enough for lights of their own.
struct LitRooms {
  std::vector<std::uint32_t> number;   ///< per room: among these, or kNone
  std::vector<ProbingValues> weights;  ///< [lit room]: as Probing::weights, but 0 where it is dark
  /// [lit room][lit room]: root mean square of irradiance, relative to that in the second, while all surfaces
  /// of that one glow and no others.
  std::vector<float> shares;

  std::uint32_t number_of(std::uint32_t room) const { return number.empty() ? kNone : number[room]; }
  float share(std::uint32_t own, std::uint32_t lit) const {
    return shares[std::size_t(own) * weights.size() + lit];
  }
};

/// Radiosities under the probing emissions. Numbers of senders are those of a SenderTree.
struct Probing {
  std::vector<ProbingValues>
      senders;                        ///< per sender, lm/m2; differing as textures and other lights make them
  std::vector<ProbingValues> nodes;   ///< per node of the tree: mean of its senders by weight
  std::vector<NodeSurface> surfaces;  ///< per node of the tree; of the sky without area
  std::vector<std::uint32_t> rooms;   ///< per cluster
  std::vector<ProbingValues> weights;  ///< per room: 1 / root mean square of its irradiance; of a room that
                                       ///< nothing lights, as if it had a hundredth of that of the brightest
  LitRooms lit;
  /// Of irradiance, relative to its root mean square in the room: what clusters of this size are estimated to
  /// cost, root mean square over rooms, of each the probings that err most.
  double cluster_error = 0.0;
};

/// What the rows of a survey are traced against, and where its clusters lie.
struct ProbedScene {
  const Geometry& geometry;
  const RayCaster& caster;
  const std::vector<ClusteredSurface>& surfaces;
  const Emitters& emitters;
  const SenderTree& senders;
  std::uint64_t seed = 0;
};

inline constexpr std::uint32_t kNoRoom = 0xffffffffu;

/// Probing::weights; all 0 of kNoRoom.
const ProbingValues& weights_of_room(const Probing& probing, std::uint32_t room);

/// Number of the room that a sender lies in among the lit ones, or kNone.
std::uint32_t lit_room(const Probing& probing, std::uint32_t sender);

/// What a room gets of the light of a lit one while no other is lit, a tenth at least. 1 of its own, of
/// kNone, and for rooms that are too small to be lit.
float lit_share(const Probing& probing, std::uint32_t room, std::uint32_t lit);

/// Of light that a room gets from senders in a lit one: 1 / root mean square of its irradiance, as if no
/// other were lit. weights_of_room() of its own light, of kNone, and under probings that leave the lit room
/// to the light of others.
ProbingValues weights_of_light(const Probing& probing, std::uint32_t room, std::uint32_t lit);

/// Each room (`of_cluster`: that of each cluster) is lit by turns by point and spot lights in its free space,
/// by its possible emitters, by patches of its surface, by the sky and by its neighbours only; materials take
/// albedos by chance. `rows`: per cluster, of few rays; errors are products of what both halves find, so that
/// noise cancels. In the calling task arena; the same for any number of threads.
Probing probe(const ProbedScene& scene, const SurveyRows& rows, const ElementRooms& rooms,
              std::vector<std::uint32_t> of_cluster);

}  // namespace relume
