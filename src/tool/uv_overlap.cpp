// SPDX-License-Identifier: MIT
#include "tool/uv_overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <set>
#include <utility>

namespace relume {
namespace {

/// Places along each edge of a texel.
constexpr std::uint32_t kAlong = 4;

/// How many triangles lie over each place of a lightmap: 0, 1 or 2 and more.
class Coverage {
 public:
  explicit Coverage(const System& system)
      : width_(kAlong * system.lightmap_width),
        height_(kAlong * system.lightmap_height),
        counts_(std::size_t{width_} * height_, 0) {}

  void add(const glm::vec2* corners) {
    const glm::vec2 a = float(kAlong) * corners[0], b = float(kAlong) * corners[1],
                    c = float(kAlong) * corners[2];
    const glm::vec2 lower = glm::min(a, glm::min(b, c)), upper = glm::max(a, glm::max(b, c));
    for (auto y = first(lower.y); y < end(upper.y, height_); ++y) {
      for (auto x = first(lower.x); x < end(upper.x, width_); ++x) {
        if (!inside({float(x) + 0.5f, float(y) + 0.5f}, a, b, c)) continue;
        std::uint8_t& count = counts_[std::size_t{y} * width_ + x];
        count = std::uint8_t(std::min(count + 1, 2));
      }
    }
  }

  /// Of the covered places of a texel, those under two triangles.
  double share_twice(const Lumel& lumel) const {
    int once = 0, twice = 0;
    for (std::uint32_t y = kAlong * lumel.y; y < kAlong * (lumel.y + 1u); ++y) {
      for (std::uint32_t x = kAlong * lumel.x; x < kAlong * (lumel.x + 1u); ++x) {
        const std::uint8_t count = counts_[std::size_t{y} * width_ + x];
        once += count > 0 ? 1 : 0, twice += count > 1 ? 1 : 0;
      }
    }
    return once > 0 ? double(twice) / once : 0.0;
  }

 private:
  static std::uint32_t first(float lower) { return std::uint32_t(std::max(0.0f, std::floor(lower))); }
  static std::uint32_t end(float upper, std::uint32_t size) {
    return std::min(size, std::uint32_t(std::max(0.0f, std::floor(upper) + 1.0f)));
  }
  static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }
  /// By more than a thousandth of the triangle, so that neighbours do not count.
  static bool inside(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double area = cross(b - a, c - a), sign = area < 0.0 ? -1.0 : 1.0, margin = 1e-3 * std::abs(area);
    return sign * cross(b - a, p - a) > margin && sign * cross(c - b, p - b) > margin &&
           sign * cross(a - c, p - c) > margin;
  }

  std::uint32_t width_, height_;
  std::vector<std::uint8_t> counts_;
};

}  // namespace

std::vector<double> uv_overlaps(const Model& model, std::size_t s) {
  const System& system = model.systems[s];
  const Occluders& occluders = model.occluders;
  std::set<std::pair<std::uint32_t, Side>> given;
  for (const LightmapChart& chart : system.charts) {
    if (chart.uv_set != kNone) given.insert({chart.node, chart.side});
  }
  Coverage coverage(system);
  for (std::size_t t = 0; t < occluders.triangles.size(); ++t) {
    if (occluders.system[t] != s) continue;
    if (given.contains({occluders.node[t], Side::front})) coverage.add(&occluders.front_uv[3 * t]);
    const bool back = !occluders.back_uv.empty() && model.materials[occluders.material[t]].double_sided;
    if (back && given.contains({occluders.node[t], Side::back})) coverage.add(&occluders.back_uv[3 * t]);
  }
  std::vector<double> overlaps;
  for (const Lumel& lumel : system.lumels) {
    const Cluster& cluster = system.clusters[system.elements[lumel.element].cluster];
    overlaps.push_back(given.contains({cluster.node, cluster.side})
                           ? coverage.share_twice(lumel)
                           : std::numeric_limits<double>::quiet_NaN());
  }
  return overlaps;
}

}  // namespace relume
