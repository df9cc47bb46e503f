// SPDX-License-Identifier: MIT
//
// The cut: which nodes of the cluster tree a tile of neighbouring rows keeps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/halvings.h"
#include "core/model.h"
#include "precompute/cluster_tree.h"
#include "precompute/node_flux.h"
#include "precompute/probing.h"
#include "precompute/row_tracer.h"
#include "precompute/sender_set.h"

namespace relume {

/// Rows of a tile that share one column list.
struct CutTile {
  std::vector<std::uint32_t> nodes;  ///< of ClusterTree, ascending by first leaf, disjoint; their leaves hold
                                     ///< every form factor of the rows
  std::vector<std::vector<float>>
      values;  ///< [row][node]: sum of the row's form factors over the leaves of the node
  /// [row][node], of directional rows: the same sum of their moments; else empty.
  std::vector<std::vector<glm::vec3>> moments;
  std::vector<float> error;  ///< [row]: of its irradiance by what the nodes hide, relative to its room's,
                             ///< estimated from the probings
  /// Of all values that are not zero and nodes that lie in one system, row by row (core/halvings.h); empty
  /// unless they are asked for.
  HalvingList halvings;
};

struct CutLimits {
  std::uint32_t budget = 0;  ///< nodes per tile; 0 = as many as the error asks for. A tile that sees more
                             ///< roots than this keeps its roots.
  double node_error = 0.0;   ///< without a budget: refine until no node's error is larger
};

/// A row that is to be cut.
struct CutRow {
  const FormFactorRow* row = nullptr;
  float rays = 0.0f;
  float area = 0.0f;   ///< m2, of a point 0
  SurfacePoint place;  ///< its middle; of a light probe, without a normal
};

/// What rows are cut against; `flux`, if there is one, gets what they receive by way of the nodes that they
/// keep.
struct CutSenders {
  const ClusterTree& tree;
  const Probing& probing;
  NodeFlux* flux = nullptr;
  const std::vector<SenderRef>* places = nullptr;  ///< per sender: in the model; with them, halvings are kept
  bool each_room_alone = true;  ///< what nodes in a lit room hide counts as if no other were lit
};

/// How the error of a tile falls while it is refined: as long as a node's error is larger than `node`, the
/// tile's is `tile`. Both squared, mean over rows and probings.
struct CutStep {
  float node = 0.0f, tile = 0.0f;
};

/// One per thread: holds the sums that a tile is cut by.
class TileCutter {
 public:
  /// Borrows all.
  explicit TileCutter(const CutSenders& senders);

  /// Starts from the roots and refines the node whose mean radiosity, in place of those of its leaves,
  /// changes the irradiance of the rows most: sum_j F_j (b_j - b_n) for each row and probing, relative to the
  /// irradiance of the room that the row lies in, root mean square, less what the noise of the rays alone
  /// would make of it; and what it would hide of a light that no probing knows of, which lights a
  /// small spot somewhere in the room. Of nodes in other rooms, as if those alone were lit.
  CutTile cut(std::span<const CutRow> tile, const CutLimits& limits);

  /// All refinements down to the leaves.
  std::vector<CutStep> steps(std::span<const CutRow> tile);

 private:
  struct Candidate;
  void unite(std::span<const CutRow> tile);
  void sum_up();
  /// Refines until stop(error of the worst node, nodes) says so; returns what is kept.
  template <class Stop>
  std::vector<Candidate> refine(Stop&& stop);
  Candidate candidate(std::uint32_t node, std::size_t first, std::size_t last);
  /// End of those leaves in [first, last) that stand before the sender.
  std::size_t leaves_before(std::uint32_t sender, std::size_t first, std::size_t last) const;
  /// The lit room that a sender lies in, or kNone.
  std::uint32_t lit_room_of(std::uint32_t sender) const;
  /// [row], of senders in a lit room (weights_of_light).
  const std::vector<ProbingValues>& weights_of(std::uint32_t lit);
  /// Of all leaves in [first, last).
  float factor_sum(std::size_t first, std::size_t last, std::size_t row) const;
  /// What a node hides of a small light that shines somewhere in its room, relative to what the room of the
  /// rows gets of that: squared, mean over the places where it may shine. Its halves differ in what a row
  /// sees of their area as the cosine law says of their middles, or as the form factors do, if that is more:
  /// through a door, some of a wall is seen.
  float spot_error(const Candidate& c) const;
  /// Adds a node's errors to what the tile has so far, or (-1) takes them away.
  void book(const Candidate& candidate, float sign);
  /// Squared: errors of nodes count as independent, and as what they add up to if that is more.
  float tile_error() const;
  CutTile finish(std::vector<Candidate> kept) const;
  void append_halvings_of(const Candidate& kept, std::size_t row, HalvingList& list) const;
  std::vector<glm::vec3> moments_of(const std::vector<Candidate>& kept, std::size_t row) const;
  void add_flux(const Candidate& kept) const;

  const ClusterTree& tree_;
  const Probing& probing_;
  NodeFlux* flux_;
  const std::vector<SenderRef>* places_;
  bool each_room_alone_;
  SenderSet seen_;
  std::vector<std::uint32_t> leaves_;      ///< that any row of the tile sees, ascending
  std::vector<std::uint32_t> place_;       ///< per sender: in leaves_
  std::vector<float> factors_;             ///< [leaf][row]
  std::vector<glm::vec3> moments_;         ///< [leaf][row]; empty unless rows have moments
  std::vector<float> factor_sums_;         ///< [leaf][row]: of all leaves before
  std::vector<ProbingValues> light_sums_;  ///< [leaf][row]: of form factor x radiosity of all leaves before
  std::vector<ProbingValues>
      noise_sums_;                      ///< [leaf]: of form factor x (weight x radiosity)^2 / rays over rows
  std::vector<ProbingValues> weights_;  ///< [row]
  std::vector<std::vector<ProbingValues>>
      lit_weights_;  ///< [lit room][row], as weights_of(); empty until needed
  std::vector<CutRow> tile_;
  std::vector<std::uint32_t> row_rooms_;     ///< [row]
  std::vector<ProbingValues> added_errors_;  ///< [row]: of all nodes kept so far
  double squared_errors_ = 0.0;              ///< of all nodes kept so far, over rows and probings
  double spot_errors_ = 0.0;                 ///< the part of it that spots make
};

/// The room that a row lies in: the one that it sees most of; kNoRoom where it sees none.
std::uint32_t room_of(const Probing& probing, const FormFactorRow& row);

}  // namespace relume
