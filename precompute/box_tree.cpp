// SPDX-License-Identifier: MIT
#include "precompute/box_tree.h"

#include <algorithm>
#include <glm/common.hpp>
#include <utility>

namespace relume {

Box join(const Box& a, const Box& b) {
  return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

Box join(std::span<const Box> boxes) {
  Box all = boxes.front();
  for (const Box& box : boxes) all = join(all, box);
  return all;
}

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  if (!boxes_.empty()) build(0, 0, std::uint32_t(boxes_.size()));
}

void BoxTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  const Box bounds = join(std::span<const Box>(boxes_).subspan(first, last - first));
  if (node >= nodes_.size()) nodes_.resize(node + 1);
  nodes_[node] = bounds;
  if (last - first <= kLeaf) return;
  const glm::vec3 size = bounds.upper - bounds.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(boxes_.begin() + first, boxes_.begin() + middle, boxes_.begin() + last,
                   [&](const Box& a, const Box& b) {
                     return a.lower[axis] + a.upper[axis] < b.lower[axis] + b.upper[axis];
                   });
  build(2 * node + 1, first, middle);
  build(2 * node + 2, middle, last);
}

bool BoxTree::meets(std::uint32_t node, std::uint32_t first, std::uint32_t last, const Box& box) const {
  if (!nodes_[node].meets(box)) return false;
  if (last - first <= kLeaf) {
    return std::any_of(boxes_.begin() + first, boxes_.begin() + last,
                       [&](const Box& own) { return own.meets(box); });
  }
  const std::uint32_t middle = first + (last - first) / 2;
  return meets(2 * node + 1, first, middle, box) || meets(2 * node + 2, middle, last, box);
}

}  // namespace relume
