// SPDX-License-Identifier: MIT
#include "precompute/cluster_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <span>

namespace relume {
namespace {

/// Position and, scaled to the width of the set, normal.
using Key = std::array<float, 6>;

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

/// Where to cut a set that is sorted along its longest direction: the first index of the upper half by area.
/// Parts, which follow each other where there are several, stay whole. The same in tree_order and
/// append_tree.
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

void order_set(const std::vector<TreeLeaf>& leaves, std::span<std::uint32_t> set) {
  if (set.size() < 2) return;
  if (!one_part(leaves, set)) {
    order_parts(leaves, set);
    const std::size_t half = half_by_area(leaves, set);
    order_set(leaves, set.subspan(0, half));
    order_set(leaves, set.subspan(half));
    return;
  }
  const auto widths = extents(leaves, set, 0.0f);
  const float normal_scale = 0.5f * std::max({widths[0], widths[1], widths[2]});
  const auto all = extents(leaves, set, normal_scale);
  const auto axis = std::size_t(std::max_element(all.begin(), all.end()) - all.begin());
  std::stable_sort(set.begin(), set.end(), [&](std::uint32_t a, std::uint32_t b) {
    return key_of(leaves[a], normal_scale)[axis] < key_of(leaves[b], normal_scale)[axis];
  });
  const std::size_t half = half_by_area(leaves, set);
  order_set(leaves, set.subspan(0, half));
  order_set(leaves, set.subspan(half));
}

void append_children(const std::vector<TreeLeaf>& leaves, std::uint32_t offset, std::uint32_t parent,
                     ClusterTree& tree) {
  const TreeNodeRange range = tree.nodes[parent];
  if (range.count < 2) return;
  std::vector<std::uint32_t> set(range.count);
  std::iota(set.begin(), set.end(), range.first - offset);
  const auto half = std::uint32_t(half_by_area(leaves, set));
  const auto left = std::uint32_t(tree.nodes.size());
  tree.nodes[parent].left = left;
  tree.nodes.push_back({range.first, half, 0});
  tree.nodes.push_back({range.first + half, range.count - half, 0});
  append_children(leaves, offset, left, tree);
  append_children(leaves, offset, left + 1, tree);
}

}  // namespace

std::vector<std::uint32_t> tree_order(const std::vector<TreeLeaf>& leaves) {
  std::vector<std::uint32_t> order(leaves.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return leaves[a].group < leaves[b].group; });
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last < order.size() && leaves[order[last]].group == leaves[order[first]].group) ++last;
    order_set(leaves, std::span(order).subspan(first, last - first));
    first = last;
  }
  return order;
}

void append_tree(const std::vector<TreeLeaf>& ordered_leaves, std::uint32_t first, ClusterTree& tree) {
  for (std::uint32_t begin = 0; begin < ordered_leaves.size();) {
    std::uint32_t end = begin;
    while (end < ordered_leaves.size() && ordered_leaves[end].group == ordered_leaves[begin].group) ++end;
    tree.roots.push_back(std::uint32_t(tree.nodes.size()));
    tree.nodes.push_back({first + begin, end - begin, 0});
    append_children(ordered_leaves, first, tree.roots.back(), tree);
    begin = end;
  }
}

}  // namespace relume
