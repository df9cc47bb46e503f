// SPDX-License-Identifier: MIT
#include "precompute/cluster_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>

#include "precompute/system_tiles.h"

namespace relume {
namespace {

/// Position and, scaled to the width of the set, normal.
using Key = std::array<float, 6>;
constexpr std::size_t kFirstNormalAxis = 3;

Key key_of(const TreeLeaf& leaf, float normal_scale) {
  return {leaf.centroid.x,
          leaf.centroid.y,
          leaf.centroid.z,
          leaf.normal.x * normal_scale,
          leaf.normal.y * normal_scale,
          leaf.normal.z * normal_scale};
}

std::array<float, 6> extents(const std::vector<TreeLeaf>& leaves, std::span<const std::uint32_t> set,
                             float normal_scale) {
  Key lower, upper;
  lower.fill(std::numeric_limits<float>::max());
  upper.fill(std::numeric_limits<float>::lowest());
  for (const auto i : set) {
    const Key key = key_of(leaves[i], normal_scale);
    for (std::size_t d = 0; d < key.size(); ++d) {
      lower[d] = std::min(lower[d], key[d]);
      upper[d] = std::max(upper[d], key[d]);
    }
  }
  for (std::size_t d = 0; d < lower.size(); ++d) upper[d] -= lower[d];
  return upper;
}

bool one_part(const std::vector<TreeLeaf>& leaves, std::span<const std::uint32_t> set) {
  return std::all_of(set.begin(), set.end(),
                     [&](std::uint32_t i) { return leaves[i].part == leaves[set[0]].part; });
}

/// Normals count as far apart as this times the width of the set: surfaces at right angles part before the
/// set is halved in space.
constexpr float kNormalWidth = 1.02f;

/// A gap between normals is cut at when it is more than this of all that they spread.
constexpr float kWideGap = 0.25f;

/// Where to cut a set that is sorted along its longest direction: the first index of the upper half by area.
/// Parts, which follow each other where there are several, stay whole.
std::size_t half_by_area(const std::vector<TreeLeaf>& leaves, std::span<const std::uint32_t> sorted) {
  const bool whole_parts = !one_part(leaves, sorted);
  double total = 0.0;
  for (const auto i : sorted) total += leaves[i].area;
  double below = 0.0;
  std::size_t last = 0;
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    below += leaves[sorted[k - 1]].area;
    if (whole_parts && leaves[sorted[k]].part == leaves[sorted[k - 1]].part) continue;
    last = k;
    if (2.0 * below >= total) break;
  }
  return last;
}

/// Brings the parts of a set into their order along the axis in which their centroids lie widest.
void order_parts(const std::vector<TreeLeaf>& leaves, std::span<std::uint32_t> set) {
  std::map<std::uint32_t, TreeLeaf> parts;
  for (const auto i : set) {
    TreeLeaf& part = parts[leaves[i].part];
    part.area += leaves[i].area;
    part.centroid += leaves[i].area * leaves[i].centroid;
  }
  std::vector<TreeLeaf> centres;
  for (auto& [number, part] : parts) {
    part.centroid /= part.area;
    centres.push_back(part);
  }
  std::vector<std::uint32_t> all(centres.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto widths = extents(centres, all, 0.0f);
  const auto axis = int(std::max_element(widths.begin(), widths.begin() + 3) - widths.begin());
  std::stable_sort(set.begin(), set.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t pa = leaves[a].part, pb = leaves[b].part;
    const float xa = parts.at(pa).centroid[axis], xb = parts.at(pb).centroid[axis];
    return xa != xb ? xa < xb : pa < pb;
  });
}

/// Halves sets until they are leaves.
class TreeMaker {
 public:
  TreeMaker(const std::vector<TreeLeaf>& leaves, std::uint32_t first, ClusterTree& tree)
      : leaves_(leaves), order_(leaves.size()), first_(first), tree_(tree) {
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return leaves[a].group < leaves[b].group; });
  }

  std::vector<std::uint32_t> make() && {
    for (std::uint32_t begin = 0, end = 0; begin < order_.size(); begin = end) {
      while (end < order_.size() && leaves_[order_[end]].group == leaves_[order_[begin]].group) ++end;
      tree_.roots.push_back(std::uint32_t(tree_.nodes.size()));
      tree_.nodes.push_back({first_ + begin, end - begin, 0});
      halve(tree_.roots.back());
    }
    return std::move(order_);
  }

 private:
  void halve(std::uint32_t parent) {
    const TreeNodeRange range = tree_.nodes[parent];
    const auto set = std::span(order_).subspan(range.first - first_, range.count);
    if (range.count < 2) {
      ++placed_[leaves_[set[0]].part];
      return;
    }
    const auto half = std::uint32_t(one_part(leaves_, set) ? cut_inside(set) : cut_between_parts(set));
    const auto left = std::uint32_t(tree_.nodes.size());
    tree_.nodes[parent].left = left;
    tree_.nodes.push_back({range.first, half, 0});
    tree_.nodes.push_back({range.first + half, range.count - half, 0});
    halve(left);
    halve(left + 1);
  }

  std::size_t cut_between_parts(std::span<std::uint32_t> set) const {
    order_parts(leaves_, set);
    return half_by_area(leaves_, set);
  }

  std::size_t cut_inside(std::span<std::uint32_t> set) {
    const auto widths = extents(leaves_, set, 0.0f);
    const float normal_scale = kNormalWidth * std::max({widths[0], widths[1], widths[2]});
    const auto all = extents(leaves_, set, normal_scale);
    const auto axis = std::size_t(std::max_element(all.begin(), all.end()) - all.begin());
    const auto value = [&](std::uint32_t leaf) { return key_of(leaves_[leaf], normal_scale)[axis]; };
    std::stable_sort(set.begin(), set.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return value(a) < value(b); });
    const std::size_t half = half_by_area(leaves_, set);
    if (axis >= kFirstNormalAxis) return widest_gap(set, value).value_or(half);
    return at_tile(half, set.size(), placed_[leaves_[set[0]].part]);
  }

  template <class Value>
  static std::optional<std::size_t> widest_gap(std::span<const std::uint32_t> sorted, const Value& value) {
    std::optional<std::size_t> best;
    float widest = kWideGap * (value(sorted.back()) - value(sorted.front()));
    for (std::size_t k = 1; k < sorted.size(); ++k) {
      const float gap = value(sorted[k]) - value(sorted[k - 1]);
      if (gap > widest) {
        widest = gap;
        best = k;
      }
    }
    return best;
  }

  /// Where a tile of rows begins, if that is inside the set: `before` leaves of the part come before it.
  static std::size_t at_tile(std::size_t half, std::size_t count, std::size_t before) {
    const std::size_t nearest = (before + half + kTileRows / 2) / kTileRows * kTileRows;
    return nearest > before && nearest < before + count ? nearest - before : half;
  }

  const std::vector<TreeLeaf>& leaves_;
  std::vector<std::uint32_t> order_;
  std::uint32_t first_;
  ClusterTree& tree_;
  std::map<std::uint32_t, std::size_t> placed_;  ///< leaves of each part that have their place
};

}  // namespace

std::vector<std::uint32_t> append_tree(const std::vector<TreeLeaf>& leaves, std::uint32_t first,
                                       ClusterTree& tree) {
  return TreeMaker(leaves, first, tree).make();
}

}  // namespace relume
