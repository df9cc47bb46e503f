// SPDX-License-Identifier: MIT
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <limits>
#include <map>

#include "precompute/sampling.h"
#include "precompute/split_systems.h"

namespace relume {
namespace {

constexpr double kRaysOfAll = 1 << 18;  ///< of all charts together, about
constexpr std::uint32_t kFewestRays = 32, kMostRays = 8192;

/// Chart of a side of a triangle.
class ChartOfTriangle {
 public:
  ChartOfTriangle(std::size_t triangles, const std::vector<Chart>& charts) : charts_(2 * triangles, kNone) {
    for (std::uint32_t c = 0; c < charts.size(); ++c) {
      for (const auto t : charts[c].triangles) charts_[2 * t + std::size_t(charts[c].side)] = c;
    }
  }
  std::uint32_t of(std::uint32_t triangle, Side side) const {
    return charts_[2 * triangle + std::size_t(side)];
  }

 private:
  std::vector<std::uint32_t> charts_;
};

double area_of(const Geometry& geometry, const Chart& chart) {
  double area = 0.0;
  for (const auto t : chart.triangles) area += geometry.areas[t];
  return area;
}

struct Bounds {
  glm::vec3 lower, upper;
};

Bounds bounds_of(const Geometry& geometry, const Chart& chart) {
  Bounds bounds{geometry.point(chart.triangles[0], 0.0f, 0.0f), {}};
  bounds.upper = bounds.lower;
  for (const auto t : chart.triangles) {
    for (const auto corner : geometry.triangles[t]) {
      bounds.lower = glm::min(bounds.lower, geometry.positions[corner]);
      bounds.upper = glm::max(bounds.upper, geometry.positions[corner]);
    }
  }
  return bounds;
}

/// The same place has the same key.
std::uint64_t key_of(const Geometry& geometry, const Chart& chart) {
  const Bounds bounds = bounds_of(geometry, chart);
  const glm::vec3 centre = 0.5f * (bounds.lower + bounds.upper);
  std::uint64_t key = std::uint64_t(chart.side);
  for (int k = 0; k < 3; ++k) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &centre[k], sizeof bits);
    key = mix(key, bits);
  }
  return key;
}

/// Rays from one chart.
class ChartRays {
 public:
  ChartRays(const Geometry& geometry, const Chart& chart, const SobolPoints& points)
      : geometry_(geometry), chart_(chart), points_(points), key_(key_of(geometry, chart)) {
    double sum = 0.0;
    for (const auto t : chart.triangles) area_up_to_.push_back(sum += geometry.areas[t]);
  }

  RayPacket packet(std::uint32_t first) const {
    RayPacket packet;
    for (std::uint32_t lane = 0; lane < std::uint32_t(kPacketSize); ++lane) {
      const SamplePoint at = points_.scrambled(first + lane, key_);
      // The triangle from the first coordinate; what is left of it places the origin inside.
      const double wanted = at[0] * area_up_to_.back();
      const auto place = std::min<std::size_t>(
          std::size_t(std::upper_bound(area_up_to_.begin(), area_up_to_.end(), wanted) - area_up_to_.begin()),
          area_up_to_.size() - 1);
      const double below = place > 0 ? area_up_to_[place - 1] : 0.0;
      const float rest = float((wanted - below) / std::max(area_up_to_[place] - below, 1e-300));
      const glm::vec2 inside = triangle_point(std::clamp(rest, 0.0f, 1.0f), at[1]);
      const std::uint32_t triangle = chart_.triangles[place];
      const glm::vec3 normal = geometry_.normal(triangle, chart_.side);
      const glm::vec3 from = geometry_.point(triangle, inside.x, inside.y) + geometry_.offset * normal;
      set_ray(packet, lane, from, frame_about(normal).to_world(cosine_direction(at[2], at[3])));
    }
    return packet;
  }

 private:
  static void set_ray(RayPacket& packet, std::size_t lane, const glm::vec3& from,
                      const glm::vec3& direction) {
    packet.origin_x[lane] = from.x, packet.origin_y[lane] = from.y, packet.origin_z[lane] = from.z;
    packet.direction_x[lane] = direction.x, packet.direction_y[lane] = direction.y;
    packet.direction_z[lane] = direction.z;
    packet.near[lane] = 0.0f, packet.far[lane] = std::numeric_limits<float>::max();
  }

  const Geometry& geometry_;
  const Chart& chart_;
  const SobolPoints& points_;
  std::uint64_t key_;
  std::vector<double> area_up_to_;
};

/// Hits per chart seen.
using HitCounts = std::map<std::uint32_t, std::uint32_t>;

HitCounts count_hits(const Geometry& geometry, const ChartOfTriangle& charts, const RayCaster& caster,
                     const ChartRays& rays, std::uint32_t count) {
  HitCounts hits;
  for (std::uint32_t first = 0; first < count; first += kPacketSize) {
    RayPacket packet = rays.packet(first);
    caster.closest_hits(packet);
    for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
      if (packet.triangle[lane] == kNoTriangle) continue;
      const glm::vec3 direction(packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]);
      const std::uint32_t triangle = packet.triangle[lane];
      const auto seen = seen_surface(geometry, {triangle, packet.u[lane], packet.v[lane]}, direction);
      const std::uint32_t chart = seen ? charts.of(seen->triangle, seen->side) : kNone;
      if (chart != kNone) ++hits[chart];
    }
  }
  return hits;
}

}  // namespace

std::uint64_t most_lumels_of(const Chart& chart) {
  double area = 0.0;
  for (const auto& [a, b, c] : chart.corners)
    area += 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  const std::uint64_t outline = 2 * (std::uint64_t{chart.width} + chart.height);
  return std::min(std::uint64_t{chart.width} * chart.height, std::uint64_t(area) + outline);
}

std::vector<ChartLink> link_charts(const Geometry& geometry, const std::vector<Chart>& charts,
                                   const RayCaster& caster) {
  const ChartOfTriangle chart_of(geometry.triangles.size(), charts);
  const SobolPoints points(kMostRays);
  std::vector<HitCounts> hits(charts.size());
  std::vector<double> area_per_ray(charts.size());
  tbb::parallel_for(std::size_t{0}, charts.size(), [&](std::size_t c) {
    const double area = area_of(geometry, charts[c]);
    const auto wanted =
        std::clamp<double>(kRaysOfAll * area / std::max(geometry.area, 1e-30), kFewestRays, kMostRays);
    const std::uint32_t count = std::uint32_t(wanted) / kPacketSize * kPacketSize;
    area_per_ray[c] = area / count;
    hits[c] = count_hits(geometry, chart_of, caster, ChartRays(geometry, charts[c], points), count);
  });
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> flux;
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    for (const auto& [seen, count] : hits[c]) {
      if (seen != c) flux[std::minmax(c, seen)] += count * area_per_ray[c];
    }
  }
  std::vector<ChartLink> links;
  for (const auto& [pair, sum] : flux) links.push_back({pair.first, pair.second, sum});
  return links;
}

std::vector<ChartCost> chart_costs(const Geometry& geometry, const std::vector<Chart>& charts,
                                   const std::vector<ChartLink>& links, const SystemLimits& limits) {
  std::vector<double> clusters;
  for (const Chart& chart : charts)
    clusters.push_back(std::max(1.0, area_of(geometry, chart) / (limits.cluster_size * limits.cluster_size)));
  std::vector<double> seen(charts.size(), 1.0);
  for (const ChartLink& link : links) {
    seen[link.a] += clusters[link.b];
    seen[link.b] += clusters[link.a];
  }
  std::vector<ChartCost> costs;
  for (std::size_t c = 0; c < charts.size(); ++c) {
    const Bounds bounds = bounds_of(geometry, charts[c]);
    const std::uint64_t lumels = most_lumels_of(charts[c]);
    const double rows = double(lumels) + clusters[c];
    costs.push_back(
        {bounds.lower, bounds.upper, lumels, rows * std::min<double>(seen[c], limits.row_entries)});
  }
  return costs;
}

}  // namespace relume
