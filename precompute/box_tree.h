// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace relume {

struct Box {
  glm::vec3 lower{0.0f}, upper{0.0f};

  bool meets(const Box& other) const {
    return lower.x <= other.upper.x && other.lower.x <= upper.x && lower.y <= other.upper.y &&
           other.lower.y <= upper.y && lower.z <= other.upper.z && other.lower.z <= upper.z;
  }
};

/// Of both.
Box join(const Box& a, const Box& b);
/// Of all of them; there must be some.
Box join(std::span<const Box> boxes);

/// Tells whether anything of a set of boxes is near.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box> boxes);

  bool empty() const { return nodes_.empty(); }
  /// Whether `box` meets one of them.
  bool meets(const Box& box) const { return !empty() && meets(0, 0, std::uint32_t(boxes_.size()), box); }

 private:
  static constexpr std::uint32_t kLeaf = 4;
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last);
  bool meets(std::uint32_t node, std::uint32_t first, std::uint32_t last, const Box& box) const;

  std::vector<Box> boxes_;
  std::vector<Box> nodes_;  ///< an implicit binary tree: halves of a range of boxes, down to kLeaf of them
};

}  // namespace relume
