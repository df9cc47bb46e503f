// SPDX-License-Identifier: MIT
//
// The level above the bounces: one irradiance per room.
//
// Let y be the bounce of x and r = y - x. The radiosity that y still lacks is e = rho c, where the irradiance
// c solves c = K (r + rho c). Taken as constant in each room, and asked to hold in the mean over each room g
// by area, that is
//   c_g - sum_h C_gh c_h = d_g,   C_gh = 1 / A_g sum over j in h of w_gj rho_j,   d_g = 1 / A_g sum_j w_gj
//   r_j, w_gj = sum over i in g of A_i K_ij.
// W = (w_gj) is a product of the matrix that albedo does not enter: it is found once, and C follows the
// albedo for g n multiplications. (Aggregation with prolongation of irradiance: it adds to a cluster no more
// than what it reflects.)
#pragma once

#include <cstdint>
#include <vector>

#include "core/methods/rgb_lu.h"
#include "core/rooms.h"

namespace relume {

/// W, by clusters: what a unit of radiosity of the cluster adds to each room, in lm.
struct RoomWeights {
  Rooms rooms;
  std::vector<double> areas;           ///< A_g, m2
  std::vector<std::uint64_t> offsets;  ///< clusters + 1 entries
  std::vector<std::uint32_t> rooms_reached;
  std::vector<double> weights;
};

/// Costs about as much as a product. `areas` per cluster, m2.
RoomWeights room_weights(const SenderMatrix& bounce_matrix, const std::vector<double>& areas,
                         const Rooms& rooms);

/// 1 - C of three channels, factored. A room whose light would not fade gets no correction.
class RoomSolver {
 public:
  RoomSolver(const RoomWeights& weights, const std::vector<Rgb>& albedo);

  /// c per room, lm/m2, from r per cluster.
  std::vector<Rgb> irradiance(const std::vector<Rgb>& change) const;

 private:
  const RoomWeights& weights_;
  RgbLu balance_;
};

/// x += rho c, each cluster with the irradiance of its room; channel by channel.
void add_correction(const Rooms& rooms, const std::vector<Rgb>& albedo, const std::vector<Rgb>& irradiance,
                    std::vector<Rgb>& x);

/// Rooms that suit the correction. A cavity that sees little of the room around it must not get the light of
/// that room: it would keep it for as many bounces as the room does. So small rooms stand alone, and what is
/// like no room is in none (then it is left to the bounces). Of these, the largest.
inline constexpr RoomScale kCorrectionScale{10, 0.9, 0.0002, 0.8, false};
inline constexpr std::uint32_t kMaxCorrectionRooms = 256;
Rooms correction_rooms(const Model& model, const SenderMatrix& bounce_matrix);

}  // namespace relume
