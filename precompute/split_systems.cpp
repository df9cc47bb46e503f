// SPDX-License-Identifier: MIT
#include "precompute/split_systems.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relume {
namespace {

/// Of the cost, on either side of a cut.
constexpr double kLeastShare = 0.2;
/// Flux (as a share of all) that counts like no flux: between cuts of next to none, balance decides.
constexpr double kNoFlux = 0.01;
constexpr int kRefinements = 4;

/// A part below this share of what a system may hold looks for one to join: two below half fit together.
constexpr double kSmallPart = 0.5;

/// Where a chart lies along a direction.
struct Extent {
  float middle = 0.0f, half = 0.0f;
};

Extent along(const ChartCost& chart, const glm::vec3& direction) {
  return {glm::dot(0.5f * (chart.lower + chart.upper), direction),
          glm::dot(0.5f * (chart.upper - chart.lower), glm::abs(direction))};
}

struct Neighbor {
  std::uint32_t chart = 0;
  double flux = 0.0;
};

std::vector<std::vector<Neighbor>> neighbors_of(std::size_t charts, const std::vector<ChartLink>& links) {
  std::vector<std::vector<Neighbor>> neighbors(charts);
  for (const ChartLink& link : links) {
    neighbors[link.a].push_back({link.b, link.flux});
    neighbors[link.b].push_back({link.a, link.flux});
  }
  return neighbors;
}

std::array<glm::vec3, 9> cut_directions() {
  return {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, -1}, {1, 1, 0}, {1, -1, 0}, {0, 1, 1}, {0, 1, -1}}};
}

/// One group of charts while it is cut in two.
class Bisection {
 public:
  Bisection(const std::vector<ChartCost>& costs, const std::vector<std::vector<Neighbor>>& neighbors,
            const std::vector<std::uint32_t>& group, std::uint64_t most_lumels)
      : costs_(costs),
        neighbors_(neighbors),
        group_(group),
        most_lumels_(most_lumels),
        side_(costs.size(), Side::outside) {
    for (const auto c : group_) {
      side_[c] = Side::upper;
      total_cost_ += costs_[c].cost;
      total_lumels_ += costs_[c].lumels;
    }
    for (const auto c : group_) {
      for (const Neighbor& n : neighbors_[c])
        total_flux_ += side_[n.chart] != Side::outside ? 0.5 * n.flux : 0.0;
    }
  }

  /// Lower and upper part, none of them empty. `group` has two charts at least.
  std::array<std::vector<std::uint32_t>, 2> cut() {
    Candidate best;
    std::vector<std::uint32_t> best_order;
    glm::vec3 best_direction(0.0f);
    for (const glm::vec3& direction : cut_directions()) {
      const std::vector<std::uint32_t> order = sorted_along(direction);
      const Candidate candidate = best_cut(order);
      if (!best_order.empty() && !candidate.better_than(best)) continue;
      best = candidate, best_order = order, best_direction = direction;
    }
    for (std::size_t k = 0; k < best_order.size(); ++k)
      side_[best_order[k]] = k < best.position ? Side::lower : Side::upper;
    const float plane = 0.5f * (along(costs_[best_order[best.position - 1]], best_direction).middle +
                                along(costs_[best_order[best.position]], best_direction).middle);
    std::vector<std::uint32_t> on_plane;
    for (const auto c : group_) {
      const Extent extent = along(costs_[c], best_direction);
      if (std::abs(extent.middle - plane) < extent.half) on_plane.push_back(c);
    }
    for (int pass = 0; pass < kRefinements && refine(on_plane); ++pass) {
    }
    std::array<std::vector<std::uint32_t>, 2> parts;
    for (const auto c : group_) parts[side_[c] == Side::lower ? 0 : 1].push_back(c);
    return parts;
  }

 private:
  enum class Side : std::uint8_t { outside, lower, upper };

  struct Candidate {
    std::size_t position = 0;  ///< charts below the cut
    bool balanced = false;
    double score = 0.0;  ///< the less the better
    bool better_than(const Candidate& other) const {
      return balanced != other.balanced ? balanced : score < other.score;
    }
  };

  std::vector<std::uint32_t> sorted_along(const glm::vec3& direction) const {
    std::vector<std::uint32_t> order = group_;
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return along(costs_[a], direction).middle < along(costs_[b], direction).middle;
    });
    return order;
  }

  double flux_to(std::uint32_t chart, Side side) const {
    double sum = 0.0;
    for (const Neighbor& n : neighbors_[chart]) sum += side_[n.chart] == side ? n.flux : 0.0;
    return sum;
  }

  double systems_of(std::uint64_t lumels) const {
    const std::uint64_t systems = (lumels + most_lumels_ - 1) / most_lumels_;
    return double(systems);
  }

  Candidate best_cut(const std::vector<std::uint32_t>& order) {
    for (const auto c : order) side_[c] = Side::upper;
    Candidate best;
    double crossing = 0.0, cost = 0.0;
    std::uint64_t lumels = 0;
    for (std::size_t k = 1; k < order.size(); ++k) {
      const std::uint32_t c = order[k - 1];
      side_[c] = Side::lower;
      crossing += flux_to(c, Side::upper) - flux_to(c, Side::lower);
      cost += costs_[c].cost;
      lumels += costs_[c].lumels;
      const double share = cost / total_cost_, balance = share * (1.0 - share);
      Candidate candidate{k, share >= kLeastShare && share <= 1.0 - kLeastShare, -balance};
      if (candidate.balanced) {
        const double flux = total_flux_ > 0.0 ? std::max(crossing, 0.0) / total_flux_ : 0.0;
        const double systems = systems_of(lumels) + systems_of(total_lumels_ - lumels);
        candidate.score = (flux + kNoFlux) / balance * systems / systems_of(total_lumels_);
      }
      if (best.position == 0 || candidate.better_than(best)) best = candidate;
    }
    return best;
  }

  /// Moves charts that see more of the other side, as long as the balance stays; whether any moved.
  bool refine(const std::vector<std::uint32_t>& charts) {
    double lower = 0.0;
    for (const auto c : group_) lower += side_[c] == Side::lower ? costs_[c].cost : 0.0;
    bool moved = false;
    for (const auto c : charts) {
      const Side own = side_[c], other = own == Side::lower ? Side::upper : Side::lower;
      const double after = lower + (own == Side::lower ? -costs_[c].cost : costs_[c].cost);
      const double share = after / total_cost_;
      if (share < kLeastShare || share > 1.0 - kLeastShare) continue;
      if (flux_to(c, other) <= flux_to(c, own) * (1.0 + 1e-6)) continue;
      side_[c] = other;
      lower = after;
      moved = true;
    }
    return moved;
  }

  const std::vector<ChartCost>& costs_;
  const std::vector<std::vector<Neighbor>>& neighbors_;
  const std::vector<std::uint32_t>& group_;
  std::uint64_t most_lumels_;
  std::vector<Side> side_;
  double total_cost_ = 0.0, total_flux_ = 0.0;
  std::uint64_t total_lumels_ = 0;
};

using Parts = std::vector<std::vector<std::uint32_t>>;

std::uint64_t lumels_of(const std::vector<ChartCost>& costs, const std::vector<std::uint32_t>& part) {
  std::uint64_t lumels = 0;
  for (const auto c : part) lumels += costs[c].lumels;
  return lumels;
}

void split(const std::vector<ChartCost>& costs, const std::vector<std::vector<Neighbor>>& neighbors,
           const std::vector<std::uint32_t>& group, std::uint64_t most_lumels, Parts& parts) {
  if (lumels_of(costs, group) <= most_lumels || group.size() < 2) {
    if (!group.empty()) parts.push_back(group);
    return;
  }
  for (const auto& half : Bisection(costs, neighbors, group, most_lumels).cut())
    split(costs, neighbors, half, most_lumels, parts);
}

/// The part that `small` sees best among those that have room for it; itself: none.
std::size_t partner_of(const std::vector<ChartCost>& costs,
                       const std::vector<std::vector<Neighbor>>& neighbors, const Parts& parts,
                       std::size_t small, std::uint64_t most_lumels) {
  std::vector<std::size_t> part_of(costs.size(), parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const auto c : parts[p]) part_of[c] = p;
  }
  std::vector<double> flux(parts.size() + 1, 0.0);
  for (const auto c : parts[small]) {
    for (const Neighbor& n : neighbors[c]) flux[part_of[n.chart]] += n.flux;
  }
  std::size_t best = small;
  double most = 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (p == small || flux[p] <= most) continue;
    if (lumels_of(costs, parts[p]) + lumels_of(costs, parts[small]) <= most_lumels) best = p, most = flux[p];
  }
  return best;
}

void join_small_parts(const std::vector<ChartCost>& costs,
                      const std::vector<std::vector<Neighbor>>& neighbors, std::uint64_t most_lumels,
                      Parts& parts) {
  for (std::size_t p = 0; p < parts.size();) {
    const bool small = double(lumels_of(costs, parts[p])) < kSmallPart * double(most_lumels);
    const std::size_t partner = small ? partner_of(costs, neighbors, parts, p, most_lumels) : p;
    if (partner == p) {
      ++p;
      continue;
    }
    parts[partner].insert(parts[partner].end(), parts[p].begin(), parts[p].end());
    std::sort(parts[partner].begin(), parts[partner].end());
    parts.erase(parts.begin() + std::ptrdiff_t(p));
  }
}

}  // namespace

std::vector<std::vector<std::uint32_t>> split_charts(const std::vector<ChartCost>& costs,
                                                     const std::vector<ChartLink>& links,
                                                     const std::vector<std::uint32_t>& group,
                                                     std::uint64_t most_lumels) {
  if (lumels_of(costs, group) <= most_lumels) return {group};
  const auto neighbors = neighbors_of(costs.size(), links);
  Parts parts, large;
  std::vector<std::uint32_t> rest;
  for (const auto c : group) {
    if (costs[c].lumels >= most_lumels) {
      large.push_back({c});
    } else {
      rest.push_back(c);
    }
  }
  split(costs, neighbors, rest, most_lumels, parts);
  join_small_parts(costs, neighbors, most_lumels, parts);
  parts.insert(parts.end(), large.begin(), large.end());
  return parts;
}

}  // namespace relume
