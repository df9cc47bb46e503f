// SPDX-License-Identifier: MIT
#include "precompute/clusters.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <span>

#include "precompute/mutual_visibility.h"

namespace relume {
namespace {

/// A cluster below this share of cluster_size squared looks for a neighbour to join.
constexpr double kSmallGroup = 0.25;

/// A union may be this many cluster sizes across.
constexpr float kMaxExtent = 1.5f;

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  /// The lower root stays, so that numbering does not depend on the order of unions.
  std::uint32_t unite(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
    return std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

/// Block of the chart that an element's cell lies in: blocks of nearly equal size, as close to cluster_size
/// as whole lumels allow.
std::vector<std::uint64_t> blocks_of_elements(const std::vector<Chart>& charts, const AtlasLayout& layout,
                                              const SystemSurface& surface,
                                              const std::vector<double>& texel_sizes, double cluster_size) {
  std::map<std::uint32_t, std::size_t> slot_of_chart;
  for (std::size_t i = 0; i < layout.charts.size(); ++i) slot_of_chart[layout.charts[i]] = i;
  std::vector<std::uint64_t> blocks;
  blocks.reserve(surface.elements.size());
  for (const Element& element : surface.elements) {
    const std::size_t slot = slot_of_chart.at(element.chart);
    const Chart& chart = charts[element.chart];
    const double lumels = std::max(1.0, cluster_size / texel_sizes[chart.node]);
    const auto columns = std::uint64_t(std::max(1.0, std::round(chart.width / lumels)));
    const auto rows = std::uint64_t(std::max(1.0, std::round(chart.height / lumels)));
    const std::uint64_t x = element.cell % surface.width - layout.positions[slot].x;
    const std::uint64_t y = element.cell / surface.width - layout.positions[slot].y;
    blocks.push_back((std::uint64_t(slot) << 40) | ((y * rows / chart.height) << 20) |
                     (x * columns / chart.width));
  }
  return blocks;
}

/// Halves blocks across their longer side, until none is larger than the share of its clearance or a lumel.
/// `limits` gets the size of the block of each element.
class BlockHalver {
 public:
  BlockHalver(const std::vector<Chart>& charts, const SystemSurface& surface,
              const std::vector<double>& texel_sizes, const ClusterSizes& sizes,
              std::vector<std::uint64_t>& blocks, std::vector<float>& limits)
      : charts_(charts),
        surface_(surface),
        texel_sizes_(texel_sizes),
        sizes_(sizes),
        blocks_(blocks),
        limits_(limits) {}

  void run() {
    std::vector<std::uint32_t> order(blocks_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return blocks_[a] < blocks_[b]; });
    const std::vector<std::uint64_t> before = blocks_;
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first;
      while (last < order.size() && before[order[last]] == before[order[first]]) ++last;
      halve(std::span(order).subspan(first, last - first));
      first = last;
    }
  }

 private:
  std::uint32_t x(std::uint32_t e) const { return surface_.elements[e].cell % surface_.width; }
  std::uint32_t y(std::uint32_t e) const { return surface_.elements[e].cell / surface_.width; }

  /// Of irradiance over the block.
  double clearance(std::span<const std::uint32_t> block) const {
    double inverse = 0.0;
    for (const auto e : block) inverse += 1.0 / double(sizes_.clearances[e]);
    return inverse > 0.0 ? double(block.size()) / inverse : std::numeric_limits<double>::infinity();
  }

  void halve(std::span<std::uint32_t> block) {
    std::uint32_t left = x(block[0]), right = left, lower = y(block[0]), upper = lower;
    for (const auto e : block) {
      left = std::min(left, x(e)), right = std::max(right, x(e));
      lower = std::min(lower, y(e)), upper = std::max(upper, y(e));
    }
    const bool wide = right - left >= upper - lower;
    const std::uint32_t lumels = (wide ? right - left : upper - lower) + 1;
    const double texel = texel_sizes_[charts_[surface_.elements[block[0]].chart].node];
    const double limit = sizes_.clearance_share * clearance(block);
    if (lumels > 1 && double(lumels) * texel > limit) {
      const std::uint32_t middle = (wide ? left : lower) + lumels / 2;
      const auto second = std::stable_partition(
          block.begin(), block.end(), [&](std::uint32_t e) { return (wide ? x(e) : y(e)) < middle; });
      const auto count = std::size_t(second - block.begin());
      halve(block.first(count));
      halve(block.subspan(count));
      return;
    }
    for (const auto e : block) {
      blocks_[e] = next_;
      limits_[e] = float(std::min(sizes_.largest, std::max(limit, texel)));
    }
    ++next_;
  }

  const std::vector<Chart>& charts_;
  const SystemSurface& surface_;
  const std::vector<double>& texel_sizes_;
  const ClusterSizes& sizes_;
  std::vector<std::uint64_t>& blocks_;
  std::vector<float>& limits_;
  std::uint64_t next_ = 0;
};

struct Group {
  double area = 0.0;
  glm::dvec3 centroid{0.0};  ///< times area until finished
  glm::vec3 normal{0.0f};    ///< times area
  glm::vec3 lower{std::numeric_limits<float>::max()}, upper{std::numeric_limits<float>::lowest()};
  std::uint32_t node = 0, material = 0, element = 0;
  Side side = Side::front;

  glm::vec3 centre() const { return glm::vec3(centroid / area); }
};

Group join(const Group& a, const Group& b) {
  Group sum = a.area >= b.area ? a : b;
  sum.area = a.area + b.area;
  sum.centroid = a.centroid + b.centroid;
  sum.normal = a.normal + b.normal;
  sum.lower = glm::min(a.lower, b.lower);
  sum.upper = glm::max(a.upper, b.upper);
  return sum;
}

std::vector<Group> groups_of_roots(const std::vector<Chart>& charts, const SystemSurface& surface,
                                   DisjointSets& sets) {
  std::vector<Group> groups(surface.elements.size());
  for (std::uint32_t i = 0; i < surface.elements.size(); ++i) {
    const Element& e = surface.elements[i];
    Group own{e.area,
              glm::dvec3(e.position) * double(e.area),
              e.normal * e.area,
              e.position,
              e.position,
              charts[e.chart].node,
              e.material,
              i,
              charts[e.chart].side};
    Group& group = groups[sets.root(i)];
    group = group.area > 0.0 ? join(group, own) : own;
  }
  return groups;
}

using GridKey = std::array<std::int32_t, 3>;

GridKey grid_key(const glm::vec3& p, double size) {
  return {std::int32_t(std::floor(p.x / size)), std::int32_t(std::floor(p.y / size)),
          std::int32_t(std::floor(p.z / size))};
}

bool may_join(const Group& small, const Group& other, float cluster_size) {
  if (small.node != other.node || small.material != other.material || small.side != other.side) return false;
  if (glm::dot(small.normal, other.normal) <= 0.5f * glm::length(small.normal) * glm::length(other.normal))
    return false;
  const glm::vec3 extent = glm::max(small.upper, other.upper) - glm::min(small.lower, other.lower);
  return glm::length(extent) <= kMaxExtent * cluster_size;
}

/// Small groups join the nearest group that may take them and that they see.
void absorb_small(const Geometry& geometry, const RayCaster& caster, const SystemSurface& surface,
                  const std::vector<float>& limits, std::vector<Group>& groups, DisjointSets& sets) {
  const auto is_small = [&](const Group& group) {
    return group.area < kSmallGroup * double(limits[group.element]) * double(limits[group.element]);
  };
  double cell = 0.0;
  for (const float limit : limits) cell = std::max(cell, double(limit));
  std::map<GridKey, std::vector<std::uint32_t>> grid;
  std::vector<std::uint32_t> small;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    if (groups[g].area <= 0.0) continue;
    grid[grid_key(groups[g].centre(), cell)].push_back(g);
    if (is_small(groups[g])) small.push_back(g);
  }
  for (const auto start : small) {
    const std::uint32_t own = sets.root(start);
    const Group group = groups[own];
    if (!is_small(group)) continue;
    const GridKey key = grid_key(group.centre(), cell);
    std::vector<std::pair<float, std::uint32_t>> candidates;
    for (int step = 0; step < 27; ++step) {
      const auto near = grid.find({key[0] + step % 3 - 1, key[1] + step / 3 % 3 - 1, key[2] + step / 9 - 1});
      if (near == grid.end()) continue;
      for (const auto listed : near->second) {
        const std::uint32_t other = sets.root(listed);
        if (other == own || !may_join(group, groups[other], limits[group.element])) continue;
        candidates.emplace_back(glm::length(groups[other].centre() - group.centre()), other);
      }
    }
    std::sort(candidates.begin(), candidates.end());
    constexpr std::size_t kTries = 4;
    for (std::size_t c = 0; c < std::min(kTries, candidates.size()); ++c) {
      const Element &a = surface.elements[group.element],
                    &b = surface.elements[groups[candidates[c].second].element];
      if (!mutually_visible(geometry, caster, {a.position, a.normal}, {b.position, b.normal})) continue;
      const Group sum = join(group, groups[candidates[c].second]);
      groups[sets.unite(own, candidates[c].second)] = sum;
      break;
    }
  }
}

}  // namespace

std::vector<std::uint32_t> make_clusters(const Geometry& geometry, const std::vector<Chart>& charts,
                                         const AtlasLayout& layout, const SystemSurface& surface,
                                         const RayCaster& caster, const std::vector<double>& texel_sizes,
                                         const ClusterSizes& sizes) {
  DisjointSets sets(surface.elements.size());
  std::vector<float> limits(surface.elements.size(), float(sizes.largest));
  auto blocks = blocks_of_elements(charts, layout, surface, texel_sizes, sizes.largest);
  if (sizes.clearance_share > 0.0) BlockHalver(charts, surface, texel_sizes, sizes, blocks, limits).run();
  for (const auto& [a, b] : surface.links) {
    if (blocks[a] == blocks[b]) sets.unite(a, b);
  }
  auto groups = groups_of_roots(charts, surface, sets);
  absorb_small(geometry, caster, surface, limits, groups, sets);
  // Number by chart, block and first element: neighbours in space get neighbouring numbers.
  std::vector<std::uint32_t> order(surface.elements.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return blocks[a] < blocks[b]; });
  std::vector<std::uint32_t> number_of_root(surface.elements.size(), kNone);
  std::vector<std::uint32_t> clusters(surface.elements.size());
  std::uint32_t count = 0;
  for (const auto i : order) {
    std::uint32_t& number = number_of_root[sets.root(i)];
    if (number == kNone) number = count++;
    clusters[i] = number;
  }
  return clusters;
}

}  // namespace relume
