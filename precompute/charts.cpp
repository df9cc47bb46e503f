// SPDX-License-Identifier: MIT
#include "precompute/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "precompute/clip_grid.h"

namespace relume {
namespace {

/// Share of the covered sample points of a TEXCOORD_1 that may lie in two triangles before the set counts as
/// overlapping.
constexpr double kOverlapShare = 0.02;

struct TriangleRange {
  std::uint32_t first = 0, last = 0;
  bool has_uv1 = true;
};

/// Triangles of each node; a node's surfaces follow each other.
std::vector<TriangleRange> ranges_of_nodes(const Scene& scene) {
  std::vector<TriangleRange> ranges(scene.nodes.size());
  for (const SceneSurface& surface : scene.surfaces) {
    TriangleRange& range = ranges[surface.node];
    if (range.first == range.last) range.first = surface.first_triangle;
    range.last = surface.first_triangle + surface.triangle_count;
    range.has_uv1 = range.has_uv1 && surface.has_uv1;
  }
  return ranges;
}

struct UvFacts {
  glm::dvec2 lower{std::numeric_limits<double>::max()}, upper{std::numeric_limits<double>::lowest()};
  double uv_area = 0.0, area = 0.0;
};

UvFacts uv_facts(const Scene& scene, const Geometry& geometry, TriangleRange range) {
  UvFacts facts;
  for (std::uint32_t t = range.first; t < range.last; ++t) {
    std::array<glm::dvec2, 3> uv;
    for (std::size_t k = 0; k < 3; ++k) {
      uv[k] = scene.vertices.uv1[scene.triangles[t][k]];
      facts.lower = glm::min(facts.lower, uv[k]);
      facts.upper = glm::max(facts.upper, uv[k]);
    }
    const glm::dvec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    facts.uv_area += 0.5 * std::abs(a.x * b.y - a.y * b.x);
    facts.area += geometry.areas[t];
  }
  return facts;
}

bool strictly_inside(const std::array<glm::vec2, 3>& corners, const glm::dvec2& p) {
  const glm::dvec2 a(corners[0]), b(corners[1]), c(corners[2]);
  const double area = cross(b - a, c - a);
  const double margin = 1e-3 * std::abs(area);
  const double sign = area < 0.0 ? -1.0 : 1.0;
  return sign * cross(b - a, p - a) > margin && sign * cross(c - b, p - b) > margin &&
         sign * cross(a - c, p - c) > margin;
}

/// Share of covered sample points (four a lumel) that lie in more than one triangle.
double overlap_share(const Chart& chart) {
  constexpr int kPerLumel = 2;
  const int width = static_cast<int>(chart.width) * kPerLumel,
            height = static_cast<int>(chart.height) * kPerLumel;
  std::vector<std::uint8_t> covered(std::size_t(width) * std::size_t(height), 0);
  std::size_t once = 0, twice = 0;
  for (const auto& corners : chart.corners) {
    const glm::vec2 lower = glm::min(corners[0], glm::min(corners[1], corners[2])) * float(kPerLumel);
    const glm::vec2 upper = glm::max(corners[0], glm::max(corners[1], corners[2])) * float(kPerLumel);
    for (int y = std::max(0, int(lower.y)); y < std::min(height, int(upper.y) + 1); ++y) {
      for (int x = std::max(0, int(lower.x)); x < std::min(width, int(upper.x) + 1); ++x) {
        if (!strictly_inside(corners, {(x + 0.5) / kPerLumel, (y + 0.5) / kPerLumel})) continue;
        std::uint8_t& count = covered[std::size_t(y) * std::size_t(width) + std::size_t(x)];
        once += count == 0 ? 1u : 0u;
        twice += count == 1 ? 1u : 0u;
        count = static_cast<std::uint8_t>(std::min(count + 1, 2));
      }
    }
  }
  return once > 0 ? double(twice) / double(once) : 0.0;
}

Chart uv_chart(const Scene& scene, TriangleRange range, const UvFacts& facts, std::uint32_t node,
               double texel_size) {
  Chart chart;
  chart.node = node;
  chart.uv_set = 1;
  const double scale = std::sqrt(facts.area / facts.uv_area) / texel_size;
  const glm::dvec2 offset = -glm::floor(facts.lower * scale + 1e-4);
  const glm::dvec2 size = glm::max(glm::dvec2(1.0), glm::ceil(facts.upper * scale + offset - 1e-4));
  chart.uv_scale = glm::vec2(static_cast<float>(scale));
  chart.uv_offset = glm::vec2(offset);
  chart.width = static_cast<std::uint32_t>(size.x);
  chart.height = static_cast<std::uint32_t>(size.y);
  for (std::uint32_t t = range.first; t < range.last; ++t) {
    std::array<glm::vec2, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 uv(scene.vertices.uv1[scene.triangles[t][k]]);
      corners[k] = glm::vec2(glm::clamp(uv * scale + offset, glm::dvec2(0.0), size));
    }
    chart.triangles.push_back(t);
    chart.corners.push_back(corners);
  }
  return chart;
}

/// The node's own chart, or the reason why it is not used.
Result<Chart> given_chart(const Scene& scene, const Geometry& geometry, TriangleRange range,
                          std::uint32_t node, double texel_size) {
  const UvFacts facts = uv_facts(scene, geometry, range);
  constexpr double kSlack = 1e-3;
  if (facts.lower.x < -kSlack || facts.lower.y < -kSlack || facts.upper.x > 1.0 + kSlack ||
      facts.upper.y > 1.0 + kSlack) {
    return fail(ErrorCode::bad_input,
                fmt::format("reaches from ({:.3g}, {:.3g}) to ({:.3g}, {:.3g}), outside 0..1", facts.lower.x,
                            facts.lower.y, facts.upper.x, facts.upper.y));
  }
  if (!(facts.uv_area > 1e-12)) return fail(ErrorCode::bad_input, "has no area");
  Chart chart = uv_chart(scene, range, facts, node, texel_size);
  if (const double share = overlap_share(chart); share > kOverlapShare) {
    return fail(ErrorCode::bad_input, fmt::format("overlaps itself on {:.1f} % of its area", 100.0 * share));
  }
  return chart;
}

/// The same charts for the backs of triangles that have one.
std::vector<Chart> back_charts(const Geometry& geometry, const std::vector<Chart>& fronts) {
  std::vector<Chart> backs;
  for (const Chart& front : fronts) {
    Chart back = front;
    back.side = Side::back;
    back.triangles.clear();
    back.corners.clear();
    for (std::size_t i = 0; i < front.triangles.size(); ++i) {
      if (!geometry.has_back(front.triangles[i])) continue;
      back.triangles.push_back(front.triangles[i]);
      back.corners.push_back(front.corners[i]);
    }
    if (!back.triangles.empty()) backs.push_back(std::move(back));
  }
  return backs;
}

}  // namespace

std::vector<double> texel_sizes(const Scene& scene, double texel_size) {
  std::vector<double> sizes;
  for (const SceneNode& node : scene.nodes) sizes.push_back(node.extras.texel_size.value_or(texel_size));
  return sizes;
}

std::vector<Chart> make_charts(const Scene& scene, const Geometry& geometry, double texel_size,
                               std::vector<std::string>& warnings) {
  std::vector<Chart> charts;
  const auto ranges = ranges_of_nodes(scene);
  const auto sizes = texel_sizes(scene, texel_size);
  for (std::uint32_t node = 0; node < scene.nodes.size(); ++node) {
    const TriangleRange range = ranges[node];
    if (range.first == range.last || scene.nodes[node].extras.receiver.value_or("lightmap") == "none")
      continue;
    std::vector<Chart> fronts;
    if (range.has_uv1) {
      auto chart = given_chart(scene, geometry, range, node, sizes[node]);
      if (chart)
        fronts.push_back(std::move(*chart));
      else
        warnings.push_back(fmt::format("{}: TEXCOORD_1 {}; charts of our own are used",
                                       scene.nodes[node].path, chart.error().message));
    }
    if (fronts.empty()) fronts = planar_charts(geometry, range.first, range.last, sizes[node]);
    auto backs = back_charts(geometry, fronts);
    std::move(fronts.begin(), fronts.end(), std::back_inserter(charts));
    std::move(backs.begin(), backs.end(), std::back_inserter(charts));
  }
  return charts;
}

}  // namespace relume
