// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"
#include "core/methods/room_correction.h"

namespace relume {
namespace {

/// A correction may raise the weighted residual at first: it changes a whole room, and the largest change of
/// the next bounce may be at a door. Within so many bounces, each of which is corrected again, the residual
/// must be the smallest so far.
constexpr int kBouncesWithoutFall = 4;
/// After so many corrections in a row that were taken back, plain bounces go on.
constexpr int kMaxTakenBack = 3;

/// The corrections of one solve, channel by channel.
class Corrections {
 public:
  Corrections(const CertifiedSolve& solve, const RoomSolver& solver, const Rooms& rooms)
      : solve_(solve), solver_(solver), rooms_(rooms) {}

  /// `bounced` is the bounce of `x`: what to bounce next.
  std::vector<Rgb> next(const std::vector<Rgb>& x, std::vector<Rgb> bounced) {
    const std::vector<Rgb> irradiance = solver_.irradiance(difference(bounced, x));
    for (int channel = 0; channel < 3; ++channel) {
      if (must_take_back(channel)) {
        take_back(channel, bounced);
      } else {
        correct(channel, irradiance, bounced);
      }
    }
    return bounced;
  }

  bool given_up() const {
    return std::any_of(taken_back_.begin(), taken_back_.end(),
                       [](int times) { return times >= kMaxTakenBack; });
  }

 private:
  bool must_take_back(int channel) {
    const double change = solve_.weighted_change()[channel];
    const double best = std::max(solve_.best_weighted_change()[channel], solve_.rounding()[channel]);
    if (change <= best) {
      if (bounces_without_fall_[channel] == 0) taken_back_[channel] = 0;
      bounces_without_fall_[channel] = 0;
      return false;
    }
    return ++bounces_without_fall_[channel] >= kBouncesWithoutFall;
  }
  void take_back(int channel, std::vector<Rgb>& bounced) {
    ++taken_back_[channel];
    bounces_without_fall_[channel] = 0;
    for (std::size_t i = 0; i < bounced.size(); ++i) bounced[i][channel] = solve_.best()[i][channel];
  }
  void correct(int channel, const std::vector<Rgb>& irradiance, std::vector<Rgb>& bounced) const {
    const std::vector<Rgb>& albedo = solve_.problem().albedo;
    for (std::size_t i = 0; i < bounced.size(); ++i) {
      if (rooms_.of_cluster[i] == kNone) continue;
      double& value = bounced[i][channel];
      value = std::max(value + albedo[i][channel] * irradiance[rooms_.of_cluster[i]][channel], 0.0);
    }
  }

  const CertifiedSolve& solve_;
  const RoomSolver& solver_;
  const Rooms& rooms_;
  std::array<int, 3> bounces_without_fall_{};
  std::array<int, 3> taken_back_{};
};

}  // namespace

Result<Solution> solve_by_two_levels(const BounceProblem& problem, const Rooms& rooms, const StopRule& rule,
                                     const BounceObserver& observer) {
  const RoomWeights weights = room_weights(*problem.matrix, problem.areas, rooms);
  const RoomSolver solver(weights, problem.albedo);
  CertifiedSolve solve(problem, rule, observer);
  Corrections corrections(solve, solver, rooms);
  std::vector<Rgb> x = problem.source;
  while (!solve.done()) {
    std::vector<Rgb> bounced = solve.bounce(x);
    x = corrections.next(x, std::move(bounced));
    if (corrections.given_up()) {
      return std::move(solve).fall_back(fmt::format(
          "the correction of {} rooms raised the residual {} times in a row", rooms.count, kMaxTakenBack));
    }
  }
  return std::move(solve).finish();
}

}  // namespace relume
