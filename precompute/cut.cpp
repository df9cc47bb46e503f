// SPDX-License-Identifier: MIT
#include "precompute/cut.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace relume {
namespace {

/// All leaves that any row of the tile sees, ascending, with the rows' values side by side.
struct Union {
  std::vector<std::uint32_t> leaves;
  std::vector<float> values;  ///< [leaf * rows + row]
  std::size_t rows = 0;
};

Union unite(std::span<const FormFactorRow* const> rows) {
  Union u;
  u.rows = rows.size();
  for (const FormFactorRow* row : rows)
    u.leaves.insert(u.leaves.end(), row->senders.begin(), row->senders.end());
  std::sort(u.leaves.begin(), u.leaves.end());
  u.leaves.erase(std::unique(u.leaves.begin(), u.leaves.end()), u.leaves.end());
  u.values.assign(u.leaves.size() * rows.size(), 0.0f);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < rows[r]->senders.size(); ++i) {
      while (u.leaves[at] != rows[r]->senders[i]) ++at;
      u.values[at * rows.size() + r] = rows[r]->values[i];
    }
  }
  return u;
}

/// Mean absolute deviation of a Poisson count: exact in both limits.
double mean_deviation(double mean) {
  return std::min(2.0 * mean, 0.798 * std::sqrt(mean));
}

struct Candidate {
  double spread = 0.0;
  std::uint32_t node = 0;
  std::size_t first = 0, last = 0;  ///< its leaves in the union
  friend bool operator<(const Candidate& a, const Candidate& b) {
    return a.spread != b.spread ? a.spread < b.spread : a.node > b.node;
  }
};

class TileCutter {
 public:
  TileCutter(const ClusterTree& tree, std::span<const double> leaf_area,
             std::span<const FormFactorRow* const> rows, std::uint32_t rays)
      : tree_(tree),
        leaf_area_(leaf_area),
        union_(unite(rows)),
        pooled_(union_.leaves.size(), 0.0),
        rays_(double(rays) * double(rows.size())) {
    for (std::size_t i = 0; i < pooled_.size(); ++i) {
      for (std::size_t r = 0; r < rows.size(); ++r) pooled_[i] += value(i, r) / double(rows.size());
    }
  }

  CutTile cut(const CutLimits& limits) {
    std::priority_queue<Candidate> open;
    std::vector<Candidate> kept;
    for (const auto root : tree_.roots) push(root, 0, union_.leaves.size(), open, kept);
    const double enough = limits.error * total();
    while (!open.empty()) {
      const Candidate worst = open.top();
      if (limits.budget > 0 ? open.size() + kept.size() >= limits.budget : worst.spread <= enough) break;
      if (worst.spread <= 0.0) break;
      open.pop();
      const std::uint32_t left = tree_.nodes[worst.node].left;
      push(left, worst.first, worst.last, open, kept);
      push(left + 1, worst.first, worst.last, open, kept);
    }
    for (; !open.empty(); open.pop()) kept.push_back(open.top());
    return finish(std::move(kept));
  }

 private:
  double total() const {
    double sum = 0.0;
    for (const double v : pooled_) sum += v;
    return sum;
  }

  /// A node that no row sees is dropped; a leaf, or a node of which one leaf is seen and fills it, is kept
  /// for good.
  void push(std::uint32_t node, std::size_t first, std::size_t last, std::priority_queue<Candidate>& open,
            std::vector<Candidate>& kept) const {
    const TreeNodeRange& range = tree_.nodes[node];
    const auto begin = union_.leaves.begin();
    Candidate c{0.0, node,
                std::size_t(std::lower_bound(begin + std::ptrdiff_t(first), begin + std::ptrdiff_t(last),
                                             range.first) -
                            begin),
                0};
    c.last = std::size_t(std::lower_bound(begin + std::ptrdiff_t(c.first), begin + std::ptrdiff_t(last),
                                          range.first + range.count) -
                         begin);
    if (c.first == c.last) return;
    if (range.count == 1) {
      kept.push_back(c);
      return;
    }
    c.spread = spread(range, c);
    open.push(c);
  }

  /// Of the mean of the rows: neighbours see nearly the same, and their rays together tell noise from walls.
  double spread(const TreeNodeRange& range, const Candidate& c) const {
    double area = 0.0, sum = 0.0;
    for (std::uint32_t i = 0; i < range.count; ++i) area += leaf_area_[range.first + i];
    for (std::size_t i = c.first; i < c.last; ++i) sum += pooled_[i];
    double deviation = 0.0, seen = 0.0, noise = 0.0;
    for (std::size_t i = c.first; i < c.last; ++i) {
      const double share = leaf_area_[union_.leaves[i]] / area;
      deviation += std::abs(pooled_[i] - sum * share);
      noise += mean_deviation(sum * share * rays_);
      seen += share;
    }
    const double unseen = std::max(0.0, 1.0 - seen);
    const double unseen_leaves = double(range.count) - double(c.last - c.first);
    if (unseen_leaves > 0.0) noise += unseen_leaves * mean_deviation(sum * unseen / unseen_leaves * rays_);
    // Where rays are few against leaves, noise hides what a finer node would show.
    constexpr double kAtLeast = 0.25;
    const double found = deviation + sum * unseen;
    return std::max(kAtLeast * found, found - noise / rays_);
  }

  double value(std::size_t leaf, std::size_t row) const { return union_.values[leaf * union_.rows + row]; }

  CutTile finish(std::vector<Candidate> kept) const {
    std::sort(kept.begin(), kept.end(),
              [](const Candidate& a, const Candidate& b) { return a.first < b.first; });
    CutTile tile;
    tile.values.resize(union_.rows);
    for (const Candidate& c : kept) {
      tile.nodes.push_back(c.node);
      if (tree_.nodes[c.node].count > 1) tile.spread += float(c.spread);
      for (std::size_t r = 0; r < union_.rows; ++r) {
        double sum = 0.0;
        for (std::size_t i = c.first; i < c.last; ++i) sum += value(i, r);
        tile.values[r].push_back(float(sum));
      }
    }
    return tile;
  }

  const ClusterTree& tree_;
  std::span<const double> leaf_area_;
  Union union_;
  std::vector<double> pooled_;  ///< per leaf of the union: mean over the rows
  double rays_;                 ///< of all rows together
};

}  // namespace

CutTile cut_tile(const ClusterTree& tree, std::span<const double> leaf_area,
                 std::span<const FormFactorRow* const> rows, std::uint32_t rays, const CutLimits& limits) {
  return TileCutter(tree, leaf_area, rows, rays).cut(limits);
}

}  // namespace relume
