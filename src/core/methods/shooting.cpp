// SPDX-License-Identifier: MIT
#include <utility>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"
#include "core/methods/transposed.h"

namespace relume {
namespace {

/// The columns of K and P.
class Shooter {
 public:
  explicit Shooter(const BounceProblem& problem)
      : problem_(problem),
        senders_(transposed(problem.matrix->rows)),
        nodes_(transposed(problem.matrix->nodes)),
        first_node_(problem.matrix->rows.columns - problem.matrix->nodes.rows) {}

  /// As many shots as there are clusters, the one with the most unsent light each time. `unsent` light moves
  /// into `x`.
  void shoot(std::vector<Rgb>& unsent, std::vector<Rgb>& x) const {
    for (std::size_t shot = 0; shot < unsent.size(); ++shot) {
      const std::uint32_t cluster = brightest(unsent);
      const Rgb light = std::exchange(unsent[cluster], Rgb(0.0));
      x[cluster] += light;
      send(cluster, light, unsent);
      if (nodes_.rows == 0) continue;
      for (std::uint64_t entry = nodes_.row_offsets[cluster]; entry < nodes_.row_offsets[cluster + 1];
           ++entry)
        send(first_node_ + nodes_.column_indices[entry], nodes_.values[entry] * light, unsent);
    }
  }

 private:
  std::uint32_t brightest(const std::vector<Rgb>& unsent) const {
    std::uint32_t best = 0;
    double most = -1.0;
    for (std::uint32_t i = 0; i < unsent.size(); ++i) {
      const double power =
          problem_.areas[i] * (std::abs(unsent[i].x) + std::abs(unsent[i].y) + std::abs(unsent[i].z));
      if (power > most) most = power, best = i;
    }
    return best;
  }
  void send(std::uint32_t sender, const Rgb& light, std::vector<Rgb>& unsent) const {
    for (std::uint64_t entry = senders_.row_offsets[sender]; entry < senders_.row_offsets[sender + 1];
         ++entry) {
      const std::uint32_t row = senders_.column_indices[entry];
      unsent[row] += problem_.albedo[row] * senders_.values[entry] * light;
    }
  }

  const BounceProblem& problem_;
  CsrMatrix senders_;  ///< senders x rows
  CsrMatrix nodes_;    ///< leaves x nodes
  std::uint32_t first_node_;
};

}  // namespace

Result<Solution> solve_by_shooting(const BounceProblem& problem, const StopRule& rule,
                                   const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  const Shooter shooter(problem);
  const auto iterate = [&](std::vector<Rgb> x) {
    // What is unsent is what a bounce would add.
    std::vector<Rgb> unsent = difference(solve.bounce(x), x);
    while (solve.products_left() > 1 && !solve.would_do(unsent)) {
      shooter.shoot(unsent, x);
      solve.count_product();
    }
    return x;
  };
  return restart_while_it_helps(solve, "shooting", iterate);
}

}  // namespace relume
