// SPDX-License-Identifier: MIT
#include "precompute/embree_ties.h"

#include <algorithm>
#include <atomic>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "precompute/box_tree.h"
#include "precompute/embree_memory.h"
#include "precompute/overlap_in_plane.h"
#include "precompute/ray_caster.h"

namespace relume {
namespace {

/// Finds the triangles that lie on others, through boxes that meet.
struct OverlapSearch {
  Mesh mesh;
  std::vector<std::uint32_t> triangles;  ///< ascending: those that are looked at
  std::vector<std::uint8_t> flags;       ///< per triangle of the mesh
};

Box box_of(const Mesh& mesh, std::uint32_t triangle) {
  const auto corners = mesh.corners(triangle);
  const float margin = mesh.largest * 0x1p-20f;
  return {glm::min(glm::min(corners[0], corners[1]), corners[2]) - margin,
          glm::max(glm::max(corners[0], corners[1]), corners[2]) + margin};
}

void box_of_triangle(const RTCBoundsFunctionArguments* arguments) {
  const auto& search = *static_cast<const OverlapSearch*>(arguments->geometryUserPtr);
  const auto [lower, upper] = box_of(search.mesh, search.triangles[arguments->primID]);
  *arguments->bounds_o = {lower.x, lower.y, lower.z, 0.0f, upper.x, upper.y, upper.z, 0.0f};
}

/// Called from several threads at once.
void test_pairs(void* user, RTCCollision* pairs, unsigned count) {
  auto& search = *static_cast<OverlapSearch*>(user);
  for (const RTCCollision& pair : std::span(pairs, count)) {
    const auto [a, b] = std::minmax(search.triangles[pair.primID0], search.triangles[pair.primID1]);
    if (a == b || !overlap_in_plane(search.mesh.corners(a), search.mesh.corners(b), search.mesh.largest))
      continue;
    for (const std::uint32_t triangle : {a, b})
      std::atomic_ref(search.flags[triangle]).fetch_or(kOverlaps, std::memory_order_relaxed);
  }
}

/// Whether rays cannot tell a triangle from its edges. It may lie on another, and neither would be found to.
bool thin(const Mesh& mesh, std::size_t triangle) {
  const auto c = mesh.corners(triangle);
  const float longest =
      std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
  return glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) <= longest * mesh.largest * 0x1p-16f;
}

/// Those that are not known, and those whose boxes meet theirs.
std::vector<std::uint32_t> triangles_to_test(const Mesh& mesh, std::span<const std::uint8_t> known) {
  std::vector<Box> boxes;
  for (std::uint32_t t = 0; t < known.size(); ++t) {
    if (known[t] == kUnknownTies) boxes.push_back(box_of(mesh, t));
  }
  const BoxTree tree(std::move(boxes));
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < known.size(); ++t) {
    if (tree.meets(box_of(mesh, t))) triangles.push_back(t);
  }
  return triangles;
}

}  // namespace

Result<void> build_tree(RTCDevice device, EmbreeScene& scene, std::size_t triangles) {
  rtcCommitScene(scene.get());
  if (rtcGetDeviceError(device) == RTC_ERROR_NONE) return {};
  static_cast<void>(scene.release());
  return tl::unexpected(no_embree_memory(triangles));
}

Result<std::vector<std::uint8_t>> find_ties(RTCDevice device, const Mesh& mesh,
                                            std::span<const std::uint8_t> known) {
  OverlapSearch search{mesh, {}, std::vector<std::uint8_t>(mesh.triangles.size(), 0)};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool is_known = !known.empty() && known[t] != kUnknownTies;
    search.flags[t] = is_known ? known[t] : thin(mesh, t) ? kThin : 0;
  }
  if (known.empty()) {
    search.triangles.resize(mesh.triangles.size());
    std::iota(search.triangles.begin(), search.triangles.end(), 0u);
  } else {
    search.triangles = triangles_to_test(mesh, known);
  }
  if (!search.triangles.empty()) {
    EmbreeScene boxes(rtcNewScene(device));
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(search.triangles.size()));
    rtcSetGeometryUserData(geometry, &search);
    rtcSetGeometryBoundsFunction(geometry, box_of_triangle, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(boxes.get(), geometry);
    rtcReleaseGeometry(geometry);
    if (auto built = build_tree(device, boxes, search.triangles.size()); !built)
      return tl::unexpected(built.error());
    rtcCollide(boxes.get(), boxes.get(), test_pairs, &search);
  }
  const bool any =
      std::any_of(search.flags.begin(), search.flags.end(), [](auto flags) { return flags != 0; });
  return any ? std::move(search.flags) : std::vector<std::uint8_t>();
}

}  // namespace relume
