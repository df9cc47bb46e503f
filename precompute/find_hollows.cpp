// SPDX-License-Identifier: MIT
#include "precompute/find_hollows.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/mix.h"
#include "precompute/emitters.h"
#include "precompute/enclosed_grid.h"
#include "precompute/packet_lanes.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

constexpr std::uint32_t kRays = 32;  ///< of a cell
constexpr int kRaysOfPlace = 256;    ///< from a light, or from where somebody looks
/// Edges of cells are no longer than those of a square of this share of the scene's area, unless a triangle
/// would be cut into more than the square of this, or, because it is narrow, into so many times more than its
/// area asks for, squared.
constexpr double kCellShare = 1.0 / 8192.0, kLongCells = 4.0;
constexpr std::uint32_t kMostSplits = 64;
constexpr float kReflected = 0.5f;
constexpr int kBounces = 16, kMeans = 8;
/// Less light than this is none; more of what is seen than that is most.
constexpr float kDark = 1e-3f, kMost = 0.5f;
/// Rays of a cell that may slip through cracks.
constexpr float kStray = 2.0f / float(kRays);

/// What rays meet, besides cells.
constexpr std::uint32_t kSky = 0xffffffffu, kBlackBack = 0xfffffffeu;

/// A part of one side of a triangle, with corners as SurfacePiece has them.
struct Cell {
  std::uint32_t triangle = 0;
  Side side = Side::front;
  glm::vec2 corner{0.0f}, edge1{0.0f}, edge2{0.0f};
};

/// Sides of triangles cut in n^2 equal cells each.
class SideCells {
 public:
  explicit SideCells(const Geometry& geometry) {
    const double size = std::sqrt(std::max(kCellShare * geometry.area, 1e-12));
    for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
      splits_.push_back(splits_of(geometry, t, size));
      for (const Side side : {Side::front, Side::back}) {
        first_.push_back(std::uint32_t(cells_.size()));
        if (side == Side::front || geometry.double_sided[geometry.material[t]]) add(t, side);
      }
    }
    first_.push_back(std::uint32_t(cells_.size()));
  }
  std::uint32_t size() const { return std::uint32_t(cells_.size()); }
  const Cell& operator[](std::uint32_t cell) const { return cells_[cell]; }
  std::uint32_t first(std::uint32_t triangle, Side side) const { return first_[slot(triangle, side)]; }
  std::uint32_t end(std::uint32_t triangle, Side side) const { return first_[slot(triangle, side) + 1]; }

  std::uint32_t at(const SurfaceHit& hit) const {
    const std::uint32_t n = splits_[hit.triangle];
    const float u = hit.u * float(n), v = hit.v * float(n);
    const std::uint32_t j = std::min(std::uint32_t(std::max(v, 0.0f)), n - 1),
                        i = std::min(std::uint32_t(std::max(u, 0.0f)), n - 1 - j);
    const bool upper = i + j + 1 < n && u - float(i) + v - float(j) > 1.0f;
    return first(hit.triangle, hit.side) + j * (2 * n - j) + 2 * i + (upper ? 1 : 0);
  }

 private:
  static std::uint32_t splits_of(const Geometry& geometry, std::uint32_t triangle, double size) {
    const auto& t = geometry.triangles[triangle];
    float longest = 0.0f;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, glm::length(geometry.positions[t[k]] - geometry.positions[t[(k + 1) % 3]]));
    const double width = std::sqrt(2.0 * double(geometry.areas[triangle]));
    const double splits = std::ceil(std::min(double(longest), kLongCells * width) / size);
    return std::uint32_t(std::clamp(splits, 1.0, double(kMostSplits)));
  }
  static std::size_t slot(std::uint32_t triangle, Side side) {
    return 2 * std::size_t{triangle} + (side == Side::back ? 1 : 0);
  }
  void add(std::uint32_t triangle, Side side) {
    const std::uint32_t n = splits_[triangle];
    const float step = 1.0f / float(n);
    for (std::uint32_t j = 0; j < n; ++j) {
      for (std::uint32_t i = 0; i + j < n; ++i) {
        const glm::vec2 corner(float(i) * step, float(j) * step);
        cells_.push_back({triangle, side, corner, {step, 0.0f}, {0.0f, step}});
        if (i + j + 1 < n) cells_.push_back({triangle, side, corner + step, {-step, 0.0f}, {0.0f, -step}});
      }
    }
  }

  std::vector<std::uint32_t> splits_, first_;
  std::vector<Cell> cells_;
};

bool emits(const Scene& scene, const SceneSurface& surface) {
  return shines(scene.materials[surface.material]) ||
         scene.nodes[surface.node].extras.emitter.value_or(false);
}

class HollowFinder {
 public:
  HollowFinder(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
               const HollowSearch& search)
      : scene_(scene),
        geometry_(geometry),
        caster_(caster),
        search_(search),
        cells_(geometry),
        met_(std::size_t{kRays} * cells_.size()),
        sources_(cells_.size(), 0.0f) {}

  std::vector<bool> run() {
    const SobolPoints points(kRays);
    tbb::parallel_for(std::uint32_t{0}, cells_.size(), [&](std::uint32_t c) { look(c, points); });
    light_up();
    const std::vector<std::uint8_t> dark = find_dark();
    const std::vector<float> backs = backs_around(dark);
    std::vector<bool> hollow(geometry_.triangles.size(), false);
    for (std::uint32_t t = 0; t < hollow.size(); ++t) {
      const std::uint32_t first = cells_.first(t, Side::back), end = cells_.end(t, Side::back);
      const bool no_light =
          std::all_of(dark.begin() + first, dark.begin() + end, [](auto d) { return d != 0; });
      const float seen = std::accumulate(backs.begin() + first, backs.begin() + end, 0.0f);
      hollow[t] = no_light && seen > kMost * float(end - first);
    }
    return hollow;
  }

 private:
  /// What the lanes of a packet meet, of those that have a ray.
  void trace(RayPacket& packet, std::span<std::uint32_t> met) const;
  void look(std::uint32_t cell, const SobolPoints& points);
  /// Lights and eyes: what they see is no hollow.
  void light_up();
  void light_from(const glm::vec3& place, const glm::vec3& normal = glm::vec3(0.0f));
  std::vector<std::uint8_t> find_dark() const;
  /// Per cell: the share of backs among what is seen after some reflections.
  std::vector<float> backs_around(const std::vector<std::uint8_t>& dark) const;
  template <class Value>
  float mean_met(std::uint32_t cell, Value&& value) const {
    float sum = 0.0f;
    for (std::size_t i = 0; i < kRays; ++i) sum += value(met_[std::size_t{kRays} * cell + i]);
    return sum / float(kRays);
  }

  const Scene& scene_;
  const Geometry& geometry_;
  const RayCaster& caster_;
  const HollowSearch& search_;
  SideCells cells_;
  std::vector<std::uint32_t> met_;  ///< [cell][ray]
  std::vector<float> sources_;      ///< per cell
};

void HollowFinder::trace(RayPacket& packet, std::span<std::uint32_t> met) const {
  packet.near.fill(0.0f);
  packet.far.fill(-1.0f);
  std::fill_n(packet.far.begin(), met.size(), std::numeric_limits<float>::infinity());
  caster_.closest_hits(packet);
  for (std::size_t lane = 0; lane < met.size(); ++lane) {
    met[lane] = kSky;
    if (packet.triangle[lane] == kNoTriangle) continue;
    const auto seen =
        seen_surface(geometry_, {packet.triangle[lane], packet.u[lane], packet.v[lane], Side::front},
                     direction_of(packet, lane));
    met[lane] = seen ? cells_.at(*seen) : kBlackBack;
  }
}

void HollowFinder::look(std::uint32_t number, const SobolPoints& points) {
  const Cell& cell = cells_[number];
  const glm::vec3 normal = geometry_.normal(cell.triangle, cell.side);
  const Frame frame = frame_about(normal);
  const std::uint64_t key = mix(mix(search_.seed, 0x686f6c6c6f77ull), number);
  for (std::uint32_t first = 0; first < kRays; first += kPacketSize) {
    SampleLanes samples;
    points.scrambled(first, key, samples);
    const auto& [x, y, z, w] = samples.coordinate;
    RayPacket packet{};
    for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
      const glm::vec2 in_cell = triangle_point(x[lane], y[lane]);
      const glm::vec2 at = cell.corner + in_cell.x * cell.edge1 + in_cell.y * cell.edge2;
      const glm::vec3 from = geometry_.point(cell.triangle, at.x, at.y) + geometry_.offset * normal,
                      way = frame.to_world(cosine_direction(z[lane], w[lane]));
      packet.origin_x[lane] = from.x, packet.origin_y[lane] = from.y, packet.origin_z[lane] = from.z;
      packet.direction_x[lane] = way.x, packet.direction_y[lane] = way.y, packet.direction_z[lane] = way.z;
    }
    trace(packet, std::span(met_).subspan(std::size_t{kRays} * number + first, kPacketSize));
  }
  const std::uint32_t surface = geometry_.surface[cell.triangle];
  sources_[number] = emits(scene_, scene_.surfaces[surface])
                         ? 1.0f
                         : mean_met(number, [](std::uint32_t met) { return met == kSky ? 1.0f : 0.0f; });
}

void HollowFinder::light_from(const glm::vec3& place, const glm::vec3& normal) {
  for (int first = 0; first < kRaysOfPlace; first += kPacketSize) {
    RayPacket packet{};
    packet.origin_x.fill(place.x), packet.origin_y.fill(place.y), packet.origin_z.fill(place.z);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const glm::vec3 way = sphere_direction(first + lane, kRaysOfPlace);
      packet.direction_x[std::size_t(lane)] = way.x, packet.direction_y[std::size_t(lane)] = way.y,
      packet.direction_z[std::size_t(lane)] = way.z;
    }
    std::array<std::uint32_t, kPacketSize> met{};
    trace(packet, met);
    for (std::size_t lane = 0; lane < met.size(); ++lane) {
      const bool behind = normal != glm::vec3(0.0f) && glm::dot(normal, direction_of(packet, lane)) <= 0.0f;
      if (met[lane] < cells_.size() && !behind) sources_[met[lane]] = 1.0f;
    }
  }
}

void HollowFinder::light_up() {
  for (const Light& light : scene_.lights) {
    if (light.type != LightType::directional) light_from(glm::vec3(light.position - geometry_.origin));
  }
  for (const Camera& camera : scene_.cameras) light_from(glm::vec3(camera.position - geometry_.origin));
  for (const SurfacePoint& place : search_.places) light_from(place.position, place.normal);
}

std::vector<std::uint8_t> HollowFinder::find_dark() const {
  std::vector<float> light = sources_, received(cells_.size(), 0.0f);
  for (int k = 0; k < kBounces; ++k) {
    tbb::parallel_for(std::uint32_t{0}, cells_.size(), [&](std::uint32_t c) {
      received[c] = kReflected *
                    mean_met(c, [&](std::uint32_t met) { return met < cells_.size() ? light[met] : 0.0f; });
    });
    for (std::uint32_t c = 0; c < cells_.size(); ++c) light[c] = sources_[c] + received[c];
  }
  std::vector<std::uint8_t> dark(cells_.size());
  for (std::uint32_t c = 0; c < cells_.size(); ++c)
    dark[c] = received[c] < kDark && sources_[c] <= kStray ? 1 : 0;
  return dark;
}

std::vector<float> HollowFinder::backs_around(const std::vector<std::uint8_t>& dark) const {
  std::vector<float> backs(cells_.size()), means(cells_.size(), 0.0f);
  for (std::uint32_t c = 0; c < cells_.size(); ++c)
    backs[c] = dark[c] != 0 && cells_[c].side == Side::back ? 1.0f : 0.0f;
  for (int k = 0; k < kMeans; ++k) {
    tbb::parallel_for(std::uint32_t{0}, cells_.size(), [&](std::uint32_t c) {
      if (dark[c] == 0) return;
      means[c] = mean_met(c, [&](std::uint32_t met) {
        return met < cells_.size() ? backs[met] : met == kBlackBack ? 1.0f : 0.0f;
      });
    });
    std::swap(backs, means);
  }
  return backs;
}

}  // namespace

bool may_have_hollows(const Geometry& geometry) {
  return std::any_of(geometry.material.begin(), geometry.material.end(),
                     [&](std::uint32_t material) { return geometry.double_sided[material]; });
}

std::vector<bool> find_hollows(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
                               const HollowSearch& search) {
  return HollowFinder(scene, geometry, caster, search).run();
}

}  // namespace relume
