// SPDX-License-Identifier: MIT
//
// Rooms: groups of clusters that exchange most of their light among themselves. Two clusters are in one room
// if light that ends at them came from the same places: that of a room has been all over it after a few
// bounces, and only little of it went through a door. How alike clusters are is the correlation of where
// light was some bounces ago; 64 random functions, averaged as often over what each cluster sees, estimate it
// (diffusion distance: R. Coifman, S. Lafon, Diffusion Maps, 2006; relaxed random vectors: A. Brandt,
// O. Livne, Lean Algebraic Multigrid, 2012). It does not depend on how large or how furnished the rest of the
// scene is.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

struct Rooms {
  std::vector<std::uint32_t> of_cluster;  ///< the room of each cluster or kNone, numbered from 0 in the order
                                          ///< of their first clusters
  std::uint32_t count = 0;
};

/// How loosely clusters may be coupled and still be one room.
struct RoomScale {
  /// Bounces. Inside a room differences shrink to about 0.6 at each, across a door to 0.96.
  int sweeps = 20;
  /// Least correlation to the first cluster of a room. Two rooms of one size through whose door a share e of
  /// their light passes have (1 - x) / (1 + x), x = (1 - 2e) to the power of twice the sweeps: they are two
  /// up to e = 2.6 %, and one that is smaller than the other up to more.
  double alike = 0.78;
  /// Less than this share of what it is joined to is no room.
  double least_share = 0.02;
  /// Clusters that are less like any room
  double barely_alike = 0.5;
  /// are part of the one that their light comes from, or else of none.
  bool adopts = true;
};

/// `centroids` and `areas` (m2, above 0) per cluster.
Rooms find_rooms(const SenderMatrix& bounce_matrix, const std::vector<glm::vec3>& centroids,
                 const std::vector<float>& areas, const RoomScale& scale = {});

/// Of the clusters of all systems.
Rooms find_rooms(const Model& model, const SenderMatrix& bounce_matrix, const RoomScale& scale = {});

/// The `most` largest of them by area, in the same order; clusters of the others are in no room.
Rooms largest_rooms(const Rooms& rooms, const std::vector<double>& areas, std::uint32_t most);

inline constexpr std::size_t kRoomFunctions = 32;
using RoomFunctions = std::array<float, kRoomFunctions>;

/// What finding rooms needs to know of the clusters, from whichever form the rows are in.
struct RoomSearch {
  std::vector<float> areas;  ///< m2
  std::vector<std::uint32_t>
      sets;  ///< equal where a chain of form factors joins clusters: the lowest of their numbers
  std::vector<std::uint64_t>
      keys;  ///< signs by chance: of each cluster others, the same whatever else is in the scene
};

/// Sets `means` of each cluster to the mean of `values` over the clusters that it sees, weighted by form
/// factors, and to its own value where it sees none.
using AverageOverView =
    std::function<void(const std::vector<RoomFunctions>& values, std::vector<RoomFunctions>& means)>;

/// That of a matrix; the sky counts as not seen.
void average_over_view(const SenderMatrix& matrix, const std::vector<RoomFunctions>& values,
                       std::vector<RoomFunctions>& means);

Rooms find_rooms(const RoomSearch& search, const AverageOverView& average, const RoomScale& scale = {});

/// Clusters that a chain of form factors joins have the same number, the lowest of theirs; nodes stand for
/// their leaves.
std::vector<std::uint32_t> joined_sets(const SenderMatrix& matrix);

/// Sets of clusters that are joined one pair after the other; the smallest number stands for the set.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count);
  std::uint32_t find(std::uint32_t i);
  void join(std::uint32_t a, std::uint32_t b);
  std::vector<std::uint32_t> all();

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace relume
