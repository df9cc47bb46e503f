// SPDX-License-Identifier: MIT
#include "precompute/embree_bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <memory>
#include <new>
#include <vector>

#include "core/ray_offset.h"
#include "precompute/embree_memory.h"
#include "precompute/opacity.h"

namespace relume {
namespace {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};

struct BvhBox {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};
  void add(const BvhBox& box) { lower = glm::min(lower, box.lower), upper = glm::max(upper, box.upper); }
};

/// A node or a leaf as Embree's builder asks for it, in memory of its own.
struct BuiltNode {
  std::array<BuiltNode*, kBvhWidth> children{};
  std::array<std::uint32_t, kBvhLeafSize> triangles{};
  std::uint32_t triangle_count = 0;  ///< 0: not a leaf
  std::uint32_t lowest = 0;          ///< triangle
  BvhBox box;
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(BuiltNode), alignof(BuiltNode))) BuiltNode();
}

void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned k = 0; k < count; ++k)
    static_cast<BuiltNode*>(node)->children[k] = static_cast<BuiltNode*>(children[k]);
}

/// Boxes are made again from the triangles.
void set_bounds(void*, const RTCBounds**, unsigned, void*) {}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                  void*) {
  auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(BuiltNode), alignof(BuiltNode))) BuiltNode();
  leaf->triangle_count = static_cast<std::uint32_t>(count);
  for (std::size_t i = 0; i < count; ++i) leaf->triangles[i] = primitives[i].primID;
  std::sort(leaf->triangles.begin(), leaf->triangles.begin() + count);
  return leaf;
}

/// An exponent for BvhNode and the numbers of steps of each child along one axis.
class AxisSteps {
 public:
  AxisSteps(float origin, float extent) : origin_(origin) {
    int power = 0;
    std::frexp(extent / 255.0f, &power);  // extent <= 255 * 2^power
    exponent_ = std::clamp(power + 127, 1, 253);
  }

  /// False: the step is too small for a box; take the next.
  bool fits(float upper) const { return at(255) >= upper; }
  void next() { ++exponent_; }

  std::uint8_t exponent() const { return static_cast<std::uint8_t>(exponent_); }
  std::uint8_t below(float value) const {
    int steps = std::clamp(static_cast<int>(std::floor((value - origin_) / step())), 0, 255);
    while (steps > 0 && at(steps) > value) --steps;
    return static_cast<std::uint8_t>(steps);
  }
  std::uint8_t above(float value) const {
    int steps = std::clamp(static_cast<int>(std::ceil((value - origin_) / step())), 0, 255);
    while (steps < 255 && at(steps) < value) ++steps;
    return static_cast<std::uint8_t>(steps);
  }

 private:
  float step() const { return std::ldexp(1.0f, exponent_ - 127); }
  float at(int steps) const { return origin_ + float(steps) * step(); }

  float origin_;
  int exponent_ = 1;
};

/// Writes the tree in depth-first order.
class Flattening {
 public:
  Flattening(std::span<const BvhBox> boxes, float margin) : boxes_(boxes), margin_(margin) {}

  OccluderBvh run(BuiltNode& root) {
    prepare(root);
    bvh_.nodes.emplace_back();
    if (root.triangle_count > 0) {
      store_boxes({&root, nullptr, nullptr, nullptr}, 0);
      bvh_.nodes[0].children[0] = add_leaf(root);
    } else {
      fill(root, 0);
    }
    return std::move(bvh_);
  }

 private:
  /// Boxes and lowest triangles from below, and children in order.
  void prepare(BuiltNode& node) {
    node.lowest = node.triangle_count > 0 ? node.triangles[0] : std::numeric_limits<std::uint32_t>::max();
    for (std::uint32_t i = 0; i < node.triangle_count; ++i) node.box.add(boxes_[node.triangles[i]]);
    for (BuiltNode* child : node.children) {
      if (child == nullptr) break;
      prepare(*child);
      node.lowest = std::min(node.lowest, child->lowest);
      node.box.add(child->box);
    }
    const auto end = std::find(node.children.begin(), node.children.end(), nullptr);
    std::sort(node.children.begin(), end,
              [](const BuiltNode* a, const BuiltNode* b) { return a->lowest < b->lowest; });
  }

  std::uint32_t add_leaf(const BuiltNode& leaf) {
    const BvhLeaf entries{static_cast<std::uint32_t>(bvh_.triangles.size()), leaf.triangle_count};
    bvh_.triangles.insert(bvh_.triangles.end(), leaf.triangles.begin(),
                          leaf.triangles.begin() + leaf.triangle_count);
    return bvh_leaf_child(entries);
  }

  void fill(const BuiltNode& node, std::uint32_t index) {
    store_boxes(node.children, index);
    for (std::size_t k = 0; k < kBvhWidth && node.children[k] != nullptr; ++k) {
      const BuiltNode& child = *node.children[k];
      if (child.triangle_count > 0) {
        bvh_.nodes[index].children[k] = add_leaf(child);
        continue;
      }
      const auto place = static_cast<std::uint32_t>(bvh_.nodes.size());
      bvh_.nodes[index].children[k] = place;
      bvh_.nodes.emplace_back();
      fill(child, place);
    }
  }

  void store_boxes(const std::array<BuiltNode*, kBvhWidth>& children, std::uint32_t index) {
    BvhNode& node = bvh_.nodes[index];
    BvhBox whole;
    for (const BuiltNode* child : children) {
      if (child != nullptr) whole.add(child->box);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      node.origin[axis] = whole.lower[axis] - margin_;
      const float end = whole.upper[axis] + margin_;
      AxisSteps steps(node.origin[axis], end - node.origin[axis]);
      while (!steps.fits(end)) steps.next();
      node.exponents[a] = steps.exponent();
      for (std::size_t k = 0; k < kBvhWidth && children[k] != nullptr; ++k) {
        node.lower[a][k] = steps.below(children[k]->box.lower[axis] - margin_);
        node.upper[a][k] = steps.above(children[k]->box.upper[axis] + margin_);
      }
    }
  }

  std::span<const BvhBox> boxes_;
  float margin_;
  OccluderBvh bvh_;
};

/// Numbers of the triangles that belong into the tree.
std::vector<std::uint32_t> light_stoppers(std::span<const glm::vec3> positions,
                                          std::span<const std::array<std::uint32_t, 3>> triangles,
                                          const Opacity& stored) {
  const TriangleOpacity opacity(stored, positions, triangles);
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!opacity.never_solid(t) && !opacity.repeats(t)) chosen.push_back(t);
  }
  return chosen;
}

RTCBuildArguments build_arguments(RTCBVH bvh, std::vector<RTCBuildPrimitive>& primitives) {
  // Each level adds three entries to the stack of a walk. Near the limit the builder halves by number.
  constexpr unsigned kMaxDepth = (kBvhStackSize - 1) / (kBvhWidth - 1);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = kBvhWidth;
  arguments.maxDepth = kMaxDepth;
  arguments.maxLeafSize = kBvhLeafSize;
  arguments.bvh = bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  return arguments;
}

}  // namespace

Result<OccluderBvh> build_occluder_bvh(std::span<const glm::vec3> positions,
                                       std::span<const std::array<std::uint32_t, 3>> triangles,
                                       const Opacity& opacity) {
  const std::vector<std::uint32_t> chosen = light_stoppers(positions, triangles, opacity);
  if (chosen.empty()) return OccluderBvh{};
  std::vector<BvhBox> boxes(triangles.size());
  std::vector<RTCBuildPrimitive> primitives;
  for (const std::uint32_t t : chosen) {
    for (const std::uint32_t corner : triangles[t]) boxes[t].add({positions[corner], positions[corner]});
    const auto& [lower, upper] = boxes[t];
    primitives.push_back({lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, t});
  }
  if (auto enough = check_embree_memory(chosen.size()); !enough) return tl::unexpected(enough.error());
  const std::unique_ptr<RTCDeviceTy, Release> device(rtcNewDevice(nullptr));
  if (!device) return tl::unexpected(no_embree_memory(chosen.size()));
  const std::unique_ptr<RTCBVHTy, Release> bvh(rtcNewBVH(device.get()));
  const RTCBuildArguments arguments = build_arguments(bvh.get(), primitives);
  auto* root = static_cast<BuiltNode*>(rtcBuildBVH(&arguments));
  if (root == nullptr) return tl::unexpected(no_embree_memory(chosen.size()));
  return Flattening(boxes, kBvhMargin * largest_coordinate(positions)).run(*root);
}

}  // namespace relume
