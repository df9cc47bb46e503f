// SPDX-License-Identifier: MIT
#include <algorithm>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"
#include "core/methods/transposed.h"
#include "core/sender_product.h"

namespace relume {
namespace {

/// Radiosity of all senders, kept up to date while clusters change one by one.
class LiveSenders {
 public:
  explicit LiveSenders(const SenderMatrix& matrix)
      : clusters_(matrix.rows.rows),
        nodes_(transposed(matrix.nodes)),
        first_node_(matrix.rows.columns - matrix.nodes.rows) {}

  void set(const SenderMatrix& matrix, const std::vector<Rgb>& x) {
    values_ = x;
    values_.resize(first_node_, Rgb(0.0));
    for (std::uint32_t node = 0; node < matrix.nodes.rows; ++node)
      values_.push_back(row_product(matrix.nodes, node, values_));
  }
  const std::vector<Rgb>& values() const { return values_; }
  std::vector<Rgb> clusters() const { return {values_.begin(), values_.begin() + clusters_}; }
  void change(std::uint32_t cluster, const Rgb& difference) {
    values_[cluster] += difference;
    if (nodes_.rows == 0) return;
    for (std::uint64_t entry = nodes_.row_offsets[cluster]; entry < nodes_.row_offsets[cluster + 1]; ++entry)
      values_[first_node_ + nodes_.column_indices[entry]] += nodes_.values[entry] * difference;
  }

 private:
  std::uint32_t clusters_;
  CsrMatrix nodes_;  ///< transposed: of each leaf
  std::uint32_t first_node_;
  std::vector<Rgb> values_;
};

/// One sweep; returns how much it changed each cluster.
std::vector<Rgb> sweep(const BounceProblem& problem, const Rgb& omega, LiveSenders& senders) {
  std::vector<Rgb> change(problem.size());
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    const Rgb arriving = row_product(problem.matrix->rows, i, senders.values());
    const Rgb aim = problem.source[i] + problem.albedo[i] * arriving;
    const Rgb now = senders.values()[i];
    const Rgb next = glm::max(now + omega * (aim - now), Rgb(0.0));
    change[i] = next - now;
    senders.change(i, change[i]);
  }
  return change;
}

}  // namespace

Rgb over_relaxation(const BounceProblem& problem) {
  const Rgb lambda = glm::min(problem.contraction.lower_quotient, Rgb(1.0));
  return 2.0 / (1.0 + glm::sqrt(1.0 - lambda * lambda));
}

Result<Solution> solve_by_over_relaxation(const BounceProblem& problem, const Rgb& omega,
                                          const StopRule& rule, const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  LiveSenders senders(*problem.matrix);
  const auto iterate = [&](const std::vector<Rgb>& x) {
    StallWatch watch;
    senders.set(*problem.matrix, solve.bounce(x));  // so that there is an answer to fall back on
    while (solve.products_left() > 1) {
      const std::vector<Rgb> change = sweep(problem, omega, senders);
      solve.count_product();
      if (solve.would_do(change) || watch.stalls(largest_size(change))) break;
    }
    return senders.clusters();
  };
  return restart_while_it_helps(solve, "over-relaxation", iterate);
}

}  // namespace relume
