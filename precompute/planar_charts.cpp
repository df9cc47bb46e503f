// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "precompute/charts.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

/// A triangle joins a chart when its normal is within 40 degrees of the chart's mean.
constexpr float kCosChart = 0.766f;

struct EdgeKey {
  std::array<std::uint32_t, 6> bits;
  friend bool operator==(const EdgeKey&, const EdgeKey&) = default;
};
struct EdgeHash {
  std::size_t operator()(const EdgeKey& key) const {
    std::uint64_t h = 0;
    for (const auto b : key.bits) h = mix(h, b);
    return static_cast<std::size_t>(h);
  }
};

std::array<std::uint32_t, 3> position_bits(const glm::vec3& p) {
  const glm::vec3 canonical = p + 0.0f;  // -0 and +0 are one place
  std::array<std::uint32_t, 3> bits;
  std::memcpy(bits.data(), &canonical, sizeof bits);
  return bits;
}

EdgeKey edge_key(const glm::vec3& a, const glm::vec3& b) {
  auto ka = position_bits(a);
  auto kb = position_bits(b);
  if (kb < ka) std::swap(ka, kb);
  return {{ka[0], ka[1], ka[2], kb[0], kb[1], kb[2]}};
}

/// Per triangle of [first, last): the triangles across its three edges (joined by position, so that split
/// vertices do not matter).
std::vector<std::vector<std::uint32_t>> neighbours(const Geometry& geometry, std::uint32_t first,
                                                   std::uint32_t last) {
  struct Sharing {  // sides of triangles, numbered through, that lie on one edge
    std::uint32_t first = kNone, last = kNone;
  };
  std::unordered_map<EdgeKey, Sharing, EdgeHash> edges;
  edges.reserve(3 * (last - first) / 2);
  std::vector<std::uint32_t> next(3 * (last - first), kNone);  // per side
  std::vector<std::vector<std::uint32_t>> result(last - first);
  for (std::uint32_t t = first; t < last; ++t) {
    const auto& corners = geometry.triangles[t];
    result[t - first].reserve(3);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t side = 3 * (t - first) + k;
      Sharing& sharing =
          edges[edge_key(geometry.positions[corners[k]], geometry.positions[corners[(k + 1) % 3]])];
      for (std::uint32_t other = sharing.first; other != kNone; other = next[other]) {
        result[t - first].push_back(first + other / 3);
        result[other / 3].push_back(t);
      }
      (sharing.first == kNone ? sharing.first : next[sharing.last]) = side;
      sharing.last = side;
    }
  }
  return result;
}

/// Triangles of one chart, grown from `seed` over neighbours of the same material with agreeing normals.
std::vector<std::uint32_t> grow(const Geometry& geometry, std::uint32_t first, std::uint32_t seed,
                                const std::vector<std::vector<std::uint32_t>>& adjacent,
                                std::vector<bool>& taken) {
  std::vector<std::uint32_t> members{seed};
  taken[seed - first] = true;
  glm::vec3 sum = geometry.normals[seed] * geometry.areas[seed];
  for (std::size_t next = 0; next < members.size(); ++next) {
    for (const auto t : adjacent[members[next] - first]) {
      if (taken[t - first] || geometry.material[t] != geometry.material[seed]) continue;
      if (glm::dot(geometry.normals[t], glm::normalize(sum)) < kCosChart) continue;
      if (glm::dot(geometry.normals[t], geometry.normals[seed]) < kCosChart) continue;
      taken[t - first] = true;
      sum += geometry.normals[t] * geometry.areas[t];
      members.push_back(t);
    }
  }
  std::sort(members.begin(), members.end());
  return members;
}

/// Corners of the convex hull, counter-clockwise (A. M. Andrew, Another Efficient Algorithm for Convex Hulls
/// in Two Dimensions, 1979).
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
  const auto before = [](const glm::dvec2& a, const glm::dvec2& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<glm::dvec2> hull;
  const auto add = [&hull](const glm::dvec2& point, std::size_t least) {
    while (hull.size() > least && cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0)
      hull.pop_back();
    hull.push_back(point);
  };
  for (const glm::dvec2& point : points) add(point, 1);
  const std::size_t lower = hull.size();
  for (auto point = points.rbegin() + 1; point < points.rend(); ++point) add(*point, lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

/// The direction in which the smallest rectangle around the points lies, so that charts of walls lie along
/// the lightmap's axes, doors and windows or not. One of its sides is an edge of the convex hull; of
/// rectangles as small as each other, that of the longest edge.
glm::dvec2 direction_of_smallest_rectangle(const std::vector<glm::dvec2>& points) {
  constexpr double kEqual = 1e-4;
  const std::vector<glm::dvec2> hull = convex_hull(points);
  glm::dvec2 best(1.0, 0.0);
  double least = std::numeric_limits<double>::max(), longest = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const glm::dvec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = glm::length(edge);
    if (!(length > 0.0)) continue;
    const glm::dvec2 along = edge / length;
    glm::dvec2 lower(std::numeric_limits<double>::max()), upper(std::numeric_limits<double>::lowest());
    for (const glm::dvec2& corner : hull) {
      const glm::dvec2 turned(glm::dot(corner, along), cross(along, corner));
      lower = glm::min(lower, turned), upper = glm::max(upper, turned);
    }
    const double area = (upper.x - lower.x) * (upper.y - lower.y);
    const bool smaller = area < least * (1.0 - kEqual);
    const bool as_small = area <= least * (1.0 + kEqual) && length > longest * (1.0 + kEqual);
    if (!smaller && !as_small) continue;
    best = along, least = area, longest = length;
  }
  return best;
}

/// Direction of the chart in the plane of its normal.
glm::dvec3 chart_tangent(const Geometry& geometry, const std::vector<std::uint32_t>& members,
                         const glm::dvec3& normal) {
  const Frame frame = frame_about(glm::vec3(normal));
  const glm::dvec3 x(frame.tangent), y = glm::cross(normal, x),
                                     origin(geometry.point(members[0], 0.0f, 0.0f));
  std::vector<glm::dvec2> points;
  for (const auto t : members) {
    for (const auto corner : geometry.triangles[t]) {
      const glm::dvec3 p = glm::dvec3(geometry.positions[corner]) - origin;
      points.emplace_back(glm::dot(p, x), glm::dot(p, y));
    }
  }
  const glm::dvec2 along = direction_of_smallest_rectangle(points);
  const glm::dvec3 tangent = along.x * x + along.y * y;
  return glm::normalize(tangent - normal * glm::dot(tangent, normal));
}

Chart flatten(const Geometry& geometry, std::vector<std::uint32_t> members, double texel_size) {
  glm::dvec3 normal(0.0);
  for (const auto t : members) normal += glm::dvec3(geometry.normals[t]) * double(geometry.areas[t]);
  normal = glm::length(normal) > 0.0 ? glm::normalize(normal) : glm::dvec3(geometry.normals[members[0]]);
  const glm::dvec3 tangent = chart_tangent(geometry, members, normal);
  const glm::dvec3 bitangent = glm::cross(normal, tangent);
  Chart chart;
  chart.node = geometry.node[members[0]];
  glm::dvec2 lower(std::numeric_limits<double>::max());
  glm::dvec2 upper(std::numeric_limits<double>::lowest());
  const auto flat = [&](std::uint32_t vertex) {
    const glm::dvec3 p(geometry.positions[vertex]);
    return glm::dvec2(glm::dot(p, tangent), glm::dot(p, bitangent));
  };
  for (const auto t : members) {
    for (const auto corner : geometry.triangles[t]) {
      lower = glm::min(lower, flat(corner));
      upper = glm::max(upper, flat(corner));
    }
  }
  // Whole lumels from edge to edge: the lumels of a rectangle are all of one size and none hangs over its
  // border.
  const glm::dvec2 size = glm::max(glm::dvec2(1.0), glm::round((upper - lower) / texel_size));
  const glm::dvec2 scale = size / glm::max(upper - lower, glm::dvec2(1e-12));
  chart.width = static_cast<std::uint32_t>(size.x);
  chart.height = static_cast<std::uint32_t>(size.y);
  for (const auto t : members) {
    std::array<glm::vec2, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] =
          glm::vec2(glm::clamp((flat(geometry.triangles[t][k]) - lower) * scale, glm::dvec2(0.0), size));
    }
    chart.corners.push_back(corners);
  }
  chart.triangles = std::move(members);
  return chart;
}

}  // namespace

std::vector<Chart> planar_charts(const Geometry& geometry, std::uint32_t first, std::uint32_t last,
                                 double texel_size) {
  const auto adjacent = neighbours(geometry, first, last);
  std::vector<std::uint32_t> seeds(last - first);
  std::iota(seeds.begin(), seeds.end(), first);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return geometry.areas[a] > geometry.areas[b]; });
  std::vector<bool> taken(last - first, false);
  std::vector<Chart> charts;
  for (const auto seed : seeds) {
    if (taken[seed - first]) continue;
    charts.push_back(flatten(geometry, grow(geometry, first, seed, adjacent, taken), texel_size));
  }
  std::sort(charts.begin(), charts.end(),
            [](const Chart& a, const Chart& b) { return a.triangles[0] < b.triangles[0]; });
  return charts;
}

}  // namespace relume
