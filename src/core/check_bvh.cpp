// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>

#include "core/model_checks.h"
#include "core/ray_offset.h"

namespace relume {
namespace {

/// What lies beneath a node or a leaf.
struct Beneath {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};
  std::uint32_t stack = 0;  ///< entries that a walk below it needs
};

void add_triangle(const Occluders& occluders, std::uint32_t triangle, Beneath& sum) {
  for (const std::uint32_t corner : occluders.triangles[triangle]) {
    sum.lower = glm::min(sum.lower, occluders.positions[corner]);
    sum.upper = glm::max(sum.upper, occluders.positions[corner]);
  }
}

/// Works from the last node to the first: children come after their parents.
class BvhCheck {
 public:
  explicit BvhCheck(const Occluders& occluders)
      : occluders_(occluders),
        margin_(0.5 * double(kBvhMargin) * double(largest_coordinate(occluders.positions))),
        beneath_(occluders.bvh.nodes.size()),
        is_child_(occluders.bvh.nodes.size(), false),
        in_leaf_(occluders.bvh.triangles.size(), false) {}

  Result<void> run() {
    for (std::size_t index = beneath_.size(); index-- > 0;) {
      if (auto checked = check_node(std::uint32_t(index)); !checked) return checked;
    }
    if (!beneath_.empty() && beneath_[0].stack > kBvhStackSize) {
      return broken_model("tree of occluders: expected a walk to need at most {} entries, found {}",
                          kBvhStackSize, beneath_[0].stack);
    }
    const auto lost_node = std::find(is_child_.begin() + (is_child_.empty() ? 0 : 1), is_child_.end(), false);
    if (lost_node != is_child_.end()) {
      return broken_model("node {} of the tree of occluders: expected a parent",
                          lost_node - is_child_.begin());
    }
    const auto lost = std::find(in_leaf_.begin(), in_leaf_.end(), false);
    if (lost == in_leaf_.end()) return {};
    return broken_model("tree of occluders: expected entry {} in a leaf", lost - in_leaf_.begin());
  }

 private:
  Result<void> check_node(std::uint32_t index) {
    const BvhNode& node = occluders_.bvh.nodes[index];
    const bool steps = std::all_of(node.exponents.begin(), node.exponents.begin() + 3,
                                   [](std::uint8_t e) { return e > 0 && e < 255; });
    if (!finite(node.origin) || !steps || node.exponents[3] != 0 || node.zero != decltype(node.zero){}) {
      return broken_model(
          "node {} of the tree of occluders: expected a finite origin, exponents from 1 to 254 "
          "and zeros",
          index);
    }
    if (node.children[0] == kBvhNoChild) {
      return broken_model("node {} of the tree of occluders: expected a child", index);
    }
    std::uint32_t children = 0, deepest = 0;
    for (std::uint32_t k = 0; k < kBvhWidth; ++k) {
      if (node.children[k] == kBvhNoChild) continue;
      if (k != children++) {
        return broken_model("node {} of the tree of occluders: expected no gaps among its children", index);
      }
      const auto below = check_child(index, k);
      if (!below) return tl::unexpected(below.error());
      deepest = std::max(deepest, below->stack);
      beneath_[index].lower = glm::min(beneath_[index].lower, below->lower);
      beneath_[index].upper = glm::max(beneath_[index].upper, below->upper);
    }
    beneath_[index].stack = std::max(children, children - 1 + deepest);
    return {};
  }

  Result<Beneath> check_child(std::uint32_t index, std::uint32_t k) {
    const BvhNode& node = occluders_.bvh.nodes[index];
    const auto below = is_bvh_leaf(node.children[k]) ? take_leaf(index, bvh_leaf(node.children[k]))
                                                     : take_node(index, node.children[k]);
    if (!below) return below;
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = bvh_lower(node, k, axis), upper = bvh_upper(node, k, axis);
      if (lower <= below->lower[axis] - margin_ && upper >= below->upper[axis] + margin_) continue;
      return broken_model(
          "node {} of the tree of occluders: expected the box of child {} around its triangles, {} to {} "
          "along "
          "axis {}, found {} to {}",
          index, k, below->lower[axis], below->upper[axis], axis, lower, upper);
    }
    return below;
  }

  Result<Beneath> take_node(std::uint32_t parent, std::uint32_t child) {
    if (child <= parent || child >= beneath_.size() || is_child_[child]) {
      return broken_model(
          "node {} of the tree of occluders: expected a child above it and below {} that has one parent, "
          "found {}",
          parent, beneath_.size(), child);
    }
    is_child_[child] = true;
    return beneath_[child];
  }

  Result<Beneath> take_leaf(std::uint32_t parent, const BvhLeaf& leaf) {
    Beneath sum;
    if (std::uint64_t{leaf.first} + leaf.count > in_leaf_.size()) {
      return broken_model("node {} of the tree of occluders: expected entries below {}, found {} from {} on",
                          parent, in_leaf_.size(), leaf.count, leaf.first);
    }
    for (std::uint32_t entry = leaf.first; entry < leaf.first + leaf.count; ++entry) {
      if (in_leaf_[entry]) {
        return broken_model("tree of occluders: expected entry {} in one leaf, found it in two", entry);
      }
      in_leaf_[entry] = true;
      add_triangle(occluders_, occluders_.bvh.triangles[entry], sum);
    }
    return sum;
  }

  const Occluders& occluders_;
  double margin_;  ///< half of what it should be: rounding of those who made it
  std::vector<Beneath> beneath_;
  std::vector<bool> is_child_;
  std::vector<bool> in_leaf_;
};

}  // namespace

Result<void> check_bvh(const Occluders& occluders) {
  std::vector<bool> there(occluders.triangles.size(), false);
  for (const std::uint32_t triangle : occluders.bvh.triangles) {
    if (triangle >= there.size() || there[triangle]) {
      return broken_model("tree of occluders: expected each triangle below {} at most once, found {}",
                          there.size(), triangle);
    }
    there[triangle] = true;
  }
  for (const OpacityTriangle& listed : occluders.opacity.triangles) there[listed.triangle] = true;
  const auto lost = std::find(there.begin(), there.end(), false);
  if (lost != there.end()) {
    return broken_model("tree of occluders: expected all opaque triangles, triangle {} is missing",
                        lost - there.begin());
  }
  return BvhCheck(occluders).run();
}

}  // namespace relume
