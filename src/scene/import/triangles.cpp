// SPDX-License-Identifier: MIT
#include "scene/import/triangles.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace relume {
namespace {

constexpr double kLeastHeight = 1e-10;  // of the longest edge: above the rounding of a transform in double

using Triangle = std::array<std::uint32_t, 3>;
using Corners = std::array<glm::dvec3, 3>;

Corners corners_of(const Scene& scene, const Triangle& triangle) {
  const auto& positions = scene.vertices.positions;
  return {positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]};
}

bool is_in_range(const Corners& corners) {
  for (const auto& corner : corners) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(corner[axis]) <= kMaxCoordinate)) return false;
    }
  }
  return true;
}

bool has_area(const Corners& corners) {
  const glm::dvec3 a = corners[1] - corners[0];
  const glm::dvec3 b = corners[2] - corners[0];
  const glm::dvec3 c = corners[2] - corners[1];
  const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
  return glm::length(glm::cross(a, b)) > kLeastHeight * longest;
}

/// The corners from the smallest on, in the same sense; -0 becomes 0 so that equal corners have equal bytes.
Corners canonical(Corners corners) {
  const auto less = [](const glm::dvec3& a, const glm::dvec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  for (auto& corner : corners) corner += 0.0;
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), less), corners.end());
  return corners;
}

bool is_same(const Scene& scene, std::uint32_t a, std::uint32_t b) {
  return canonical(corners_of(scene, scene.triangles[a])) == canonical(corners_of(scene, scene.triangles[b]));
}

/// Marks triangles that are out of range or flat.
std::vector<bool> usable_triangles(Scene& scene) {
  std::vector<bool> usable(scene.triangles.size(), false);
  for (std::size_t i = 0; i < usable.size(); ++i) {
    const Corners corners = corners_of(scene, scene.triangles[i]);
    if (!is_in_range(corners)) {
      ++scene.dropped.not_finite;
    } else if (!has_area(corners)) {
      ++scene.dropped.without_area;
    } else {
      usable[i] = true;
    }
  }
  return usable;
}

/// Takes the mark from every triangle that repeats an earlier one: equal ones stand together once hashes are
/// sorted.
void unmark_repeated(Scene& scene, std::vector<bool>& keep) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> hashes;
  for (std::uint32_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    const Corners corners = canonical(corners_of(scene, scene.triangles[i]));
    hashes.emplace_back(XXH3_64bits(corners.data(), sizeof(Corners)), i);
  }
  std::sort(hashes.begin(), hashes.end());
  for (std::size_t i = 1; i < hashes.size(); ++i) {
    for (std::size_t k = i; k-- > 0 && hashes[k].first == hashes[i].first;) {
      if (!is_same(scene, hashes[k].second, hashes[i].second)) continue;
      keep[hashes[i].second] = false;
      ++scene.dropped.repeated;
      break;
    }
  }
}

void keep_triangles(const std::vector<bool>& keep, Scene& scene) {
  std::uint32_t kept = 0;
  for (auto& surface : scene.surfaces) {
    const std::uint32_t first = surface.first_triangle;
    const std::uint32_t end = first + surface.triangle_count;
    surface.first_triangle = kept;
    for (std::uint32_t t = first; t < end; ++t) {
      if (keep[t]) scene.triangles[kept++] = scene.triangles[t];
    }
    surface.triangle_count = kept - surface.first_triangle;
  }
  scene.triangles.resize(kept);
  std::erase_if(scene.surfaces, [](const SceneSurface& surface) { return surface.triangle_count == 0; });
}

void keep_used_vertices(Scene& scene) {
  auto& vertices = scene.vertices;
  std::vector<bool> used(vertices.positions.size(), false);
  for (const auto& triangle : scene.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = true;
  }
  std::vector<std::uint32_t> number(used.size(), kNone);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    vertices.positions[kept] = vertices.positions[i];
    vertices.uv0[kept] = vertices.uv0[i];
    vertices.uv1[kept] = vertices.uv1[i];
    vertices.colors[kept] = vertices.colors[i];
    number[i] = kept++;
  }
  vertices.positions.resize(kept);
  vertices.uv0.resize(kept);
  vertices.uv1.resize(kept);
  vertices.colors.resize(kept);
  for (auto& triangle : scene.triangles) {
    for (std::uint32_t& corner : triangle) corner = number[corner];
  }
}

}  // namespace

void append_surface(const MeshPrimitive& primitive, const glm::dmat4& world, std::uint32_t node,
                    std::uint32_t material, Scene& scene) {
  auto& vertices = scene.vertices;
  const auto first_vertex = static_cast<std::uint32_t>(vertices.positions.size());
  const std::size_t end = first_vertex + primitive.positions.size();
  for (const auto& p : primitive.positions) vertices.positions.emplace_back(world * glm::dvec4(p, 1.0));
  const auto append = [end](auto& all, const auto& some, auto otherwise) {
    all.insert(all.end(), some.begin(), some.end());
    all.resize(end, otherwise);
  };
  append(vertices.uv0, primitive.uv0, glm::vec2(0.0f));
  append(vertices.uv1, primitive.uv1, glm::vec2(0.0f));
  append(vertices.colors, primitive.colors, glm::vec4(1.0f));
  const bool mirrors = glm::determinant(glm::dmat3(world)) < 0.0;
  SceneSurface surface;
  surface.node = node;
  surface.material = material;
  surface.first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
  surface.triangle_count = static_cast<std::uint32_t>(primitive.triangles.size());
  surface.has_uv0 = !primitive.uv0.empty();
  surface.has_uv1 = !primitive.uv1.empty();
  surface.has_colors = !primitive.colors.empty();
  for (Triangle triangle : primitive.triangles) {
    if (mirrors) std::swap(triangle[1], triangle[2]);
    for (std::uint32_t& corner : triangle) corner += first_vertex;
    scene.triangles.push_back(triangle);
  }
  scene.dropped.without_area += primitive.without_area;
  if (surface.triangle_count != 0) scene.surfaces.push_back(surface);
}

void drop_bad_triangles(Scene& scene) {
  auto keep = usable_triangles(scene);
  unmark_repeated(scene, keep);
  if (std::find(keep.begin(), keep.end(), false) == keep.end()) return;
  keep_triangles(keep, scene);
  keep_used_vertices(scene);
}

}  // namespace relume
