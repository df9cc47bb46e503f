// SPDX-License-Identifier: MIT
//
// A tree of boxes over the triangles that block light, for shadow rays on a device: nodes of up to four
// children whose boxes are stored in 8 bits a coordinate (after H. Ylitie, T. Karras, S. Laine, Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 2017).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace relume {

inline constexpr std::uint32_t kBvhWidth = 4;
inline constexpr std::uint32_t kBvhLeafSize = 4;  ///< triangles of a leaf, at most
inline constexpr std::uint32_t kBvhNoChild = 0xffffffffu;
inline constexpr std::uint32_t kBvhLeafBit = 1u << 31;

/// Room that a walk needs which pushes all children of a node and takes the last: entries of its stack.
inline constexpr std::uint32_t kBvhStackSize = 64;

/// How much each box is larger than its triangles, as a share of the largest coordinate of the scene: beyond
/// what rounding of rays and boxes in single precision can miss.
inline constexpr float kBvhMargin = 0x1p-21f;

/// Child k covers, along each axis, origin + lower[axis][k] * step to origin + upper[axis][k] * step,
/// computed in single precision. Stored.
struct BvhNode {
  glm::vec3 origin{0.0f};
  std::array<std::uint8_t, 4> exponents{1, 1, 1, 0};  ///< step = 2^(exponent - 127), 1..254; the last is 0
  std::array<std::array<std::uint8_t, kBvhWidth>, 3> lower{};
  std::array<std::array<std::uint8_t, kBvhWidth>, 3> upper{};
  /// A node after this one; or kBvhLeafBit | (count - 1) << 29 | first: entries of OccluderBvh::triangles; or
  /// kBvhNoChild, after all others.
  std::array<std::uint32_t, kBvhWidth> children{kBvhNoChild, kBvhNoChild, kBvhNoChild, kBvhNoChild};
  std::array<std::uint32_t, 2> zero{};
  friend bool operator==(const BvhNode&, const BvhNode&) = default;
};
static_assert(sizeof(BvhNode) == 64);

/// Empty where there is nothing that blocks. Node 0 is the root.
struct OccluderBvh {
  std::vector<BvhNode> nodes;
  /// In the order of the leaves: every triangle that stops light, each once. Left out are those that never do
  /// (never_solid), and of several that are not opaque and have the same corners all but the first.
  std::vector<std::uint32_t> triangles;
  friend bool operator==(const OccluderBvh&, const OccluderBvh&) = default;
};

/// The triangles [first, first + count) of a leaf.
struct BvhLeaf {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

inline bool is_bvh_leaf(std::uint32_t child) {
  return child != kBvhNoChild && (child & kBvhLeafBit) != 0;
}

inline BvhLeaf bvh_leaf(std::uint32_t child) {
  return {child & 0x1fffffffu, (child >> 29 & 3u) + 1};
}

inline std::uint32_t bvh_leaf_child(const BvhLeaf& leaf) {
  return kBvhLeafBit | (leaf.count - 1) << 29 | leaf.first;
}

inline float bvh_step(const BvhNode& node, int axis) {
  return std::bit_cast<float>(std::uint32_t{node.exponents[std::size_t(axis)]} << 23);
}

inline float bvh_lower(const BvhNode& node, std::uint32_t child, int axis) {
  return node.origin[axis] + float(node.lower[std::size_t(axis)][child]) * bvh_step(node, axis);
}

inline float bvh_upper(const BvhNode& node, std::uint32_t child, int axis) {
  return node.origin[axis] + float(node.upper[std::size_t(axis)][child]) * bvh_step(node, axis);
}

}  // namespace relume
