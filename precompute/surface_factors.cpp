// SPDX-License-Identifier: MIT
#include "precompute/surface_factors.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <new>

#include "precompute/arena_threads.h"
#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/process_memory.h"
#include "precompute/progress.h"
#include "precompute/ray_caster.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

/// Independent scrambles per surface, from whose scatter the standard error comes.
constexpr std::uint32_t kBatches = 16;
/// Factors are a dense table; beyond this it would no longer fit memory or a reader.
constexpr std::size_t kMaxSurfaces = 4096;

constexpr std::array<glm::vec2, 3> kWholeTriangle{glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{0, 1}};

/// A triangle that sends from one side.
struct SendingSide {
  std::uint32_t triangle = 0;
  Side side = Side::front;
};

/// One row of the result while rays leave it.
struct Surface {
  std::string name;
  std::vector<SendingSide> sides;
  std::vector<double> cumulative_area;  ///< m2, holes of masks included
  double solid_area = 0.0;              ///< m2
};

struct SurfaceGroups {
  std::vector<Surface> list;
  std::vector<std::uint32_t> of_triangle;
};

SurfaceGroups group_triangles(const Scene& scene, const Geometry& geometry, FactorGrouping grouping) {
  const bool by_node = grouping == FactorGrouping::node;
  const std::vector<std::uint32_t>& groups = by_node ? geometry.node : geometry.material;
  SurfaceGroups surfaces;
  std::map<std::uint32_t, std::uint32_t> index_of;
  for (const auto group : groups) index_of[group] = 0;
  for (auto& [group, index] : index_of) {
    index = static_cast<std::uint32_t>(surfaces.list.size());
    surfaces.list.push_back({by_node ? scene.nodes[group].path : scene.materials[group].name, {}, {}, 0.0});
  }
  for (std::uint32_t t = 0; t < groups.size(); ++t) {
    const std::uint32_t index = index_of[groups[t]];
    surfaces.of_triangle.push_back(index);
    Surface& surface = surfaces.list[index];
    for (const Side side : {Side::front, Side::back}) {
      if (side == Side::back && !geometry.double_sided[geometry.material[t]]) continue;
      const double below = surface.cumulative_area.empty() ? 0.0 : surface.cumulative_area.back();
      surface.sides.push_back({t, side});
      surface.cumulative_area.push_back(below + static_cast<double>(geometry.areas[t]));
      surface.solid_area += geometry.opacity.mean(t, kWholeTriangle) * static_cast<double>(geometry.areas[t]);
    }
  }
  return surfaces;
}

/// Where a ray starts, and how much of that place is solid: a hole sends nothing.
struct Origin {
  SurfacePoint point;
  float solid = 1.0f;
};

/// Point of the surface for u, v in [0, 1), uniform by area; kept as far from the border of its triangle as
/// rays are lifted, for an origin in the edge of a room would start behind the other wall.
Origin sample(const Geometry& geometry, const Surface& surface, float u, float v) {
  const std::vector<double>& areas = surface.cumulative_area;
  const double target = static_cast<double>(u) * areas.back();
  const auto found = std::upper_bound(areas.begin(), areas.end() - 1, target);
  const auto index = static_cast<std::size_t>(found - areas.begin());
  const double below = index > 0 ? areas[index - 1] : 0.0;
  const auto rest = static_cast<float>(std::clamp((target - below) / (areas[index] - below), 0.0, 1.0));
  const glm::vec2 at = triangle_point(std::min(rest, 0.99999994f), v);
  const auto [triangle, side] = surface.sides[index];
  const glm::vec3 point = geometry.point(triangle, at.x, at.y);
  const glm::vec3 inward = geometry.point(triangle, 1.0f / 3.0f, 1.0f / 3.0f) - point;
  const float distance = glm::length(inward);
  const float step = distance > 0.0f ? std::min(1.0f, 2.0f * geometry.offset / distance) : 0.0f;
  return {{point + inward * step, geometry.normal(triangle, side)},
          geometry.opacity.at(triangle, at.x, at.y)};
}

void set_ray(RayPacket& packet, int lane, const glm::vec3& origin, const glm::vec3& direction) {
  packet.origin_x[lane] = origin.x;
  packet.origin_y[lane] = origin.y;
  packet.origin_z[lane] = origin.z;
  packet.direction_x[lane] = direction.x;
  packet.direction_y[lane] = direction.y;
  packet.direction_z[lane] = direction.z;
  packet.near[lane] = 0.0f;
  packet.far[lane] = std::numeric_limits<float>::infinity();
}

/// What all batches share.
struct FactorScene {
  const Geometry& geometry;
  const RayCaster& caster;
  const SurfaceGroups& surfaces;
  const SobolPoints& points;
};

/// Rays of one batch, each weighted by how solid its origin is.
struct Arrivals {
  std::map<std::uint32_t, double> at;  ///< per surface that any arrived at
  double sent = 0.0;
};

void count_arrivals(const FactorScene& scene, const RayPacket& packet,
                    const std::array<float, kPacketSize>& weights, int lanes, Arrivals& arrivals) {
  for (int lane = 0; lane < lanes; ++lane) {
    arrivals.sent += weights[std::size_t(lane)];
    if (packet.triangle[lane] == kNoTriangle) continue;
    const glm::vec3 direction(packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]);
    const auto seen =
        seen_surface(scene.geometry, {packet.triangle[lane], packet.u[lane], packet.v[lane]}, direction);
    if (seen) arrivals.at[scene.surfaces.of_triangle[seen->triangle]] += weights[std::size_t(lane)];
  }
}

Arrivals trace_batch(const FactorScene& scene, const Surface& surface, std::uint64_t key) {
  Arrivals arrivals;
  RayPacket packet{};
  std::array<float, kPacketSize> weights{};
  for (std::uint32_t first = 0; first < scene.points.count(); first += kPacketSize) {
    const int lanes = static_cast<int>(std::min<std::uint32_t>(kPacketSize, scene.points.count() - first));
    packet.near.fill(0.0f);
    packet.far.fill(-1.0f);
    for (int lane = 0; lane < lanes; ++lane) {
      const SamplePoint s = scene.points.scrambled(first + static_cast<std::uint32_t>(lane), key);
      const auto [origin, solid] = sample(scene.geometry, surface, s[2], s[3]);
      weights[std::size_t(lane)] = solid;
      if (solid <= 0.0f) continue;
      set_ray(packet, lane, origin.position + origin.normal * scene.geometry.offset,
              frame_about(origin.normal).to_world(cosine_direction(s[0], s[1])));
    }
    scene.caster.closest_hits(packet);
    count_arrivals(scene, packet, weights, lanes, arrivals);
  }
  return arrivals;
}

/// Mean and standard error of the mean over the batches of one surface.
void finish_row(std::span<const Arrivals> batches, std::vector<double>& factors,
                std::vector<double>& errors) {
  std::vector<double> squares(factors.size(), 0.0);
  for (const Arrivals& arrivals : batches) {
    for (const auto& [surface, count] : arrivals.at) {
      const double share = count / arrivals.sent;
      factors[surface] += share / kBatches;
      squares[surface] += share * share / kBatches;
    }
  }
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const double variance = std::max(0.0, squares[j] - factors[j] * factors[j]);
    errors[j] = std::sqrt(variance / (kBatches - 1));
  }
}

Result<SurfaceFactors> trace_all(const FactorScene& scene, std::uint64_t seed,
                                 const ProgressObserver& observer) {
  const std::size_t count = scene.surfaces.list.size();
  std::vector<Arrivals> batches(count * kBatches);
  Progress progress(observer, "rays", batches.size());
  tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
    if (progress.cancelled()) return;
    batches[b] = trace_batch(scene, scene.surfaces.list[b / kBatches], mix(seed, b));
    progress.one_done();
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while tracing the rays of surfaces");

  SurfaceFactors result;
  for (std::size_t i = 0; i < count; ++i) {
    result.surfaces.push_back(scene.surfaces.list[i].name);
    result.areas.push_back(scene.surfaces.list[i].solid_area);
    result.factors.emplace_back(count, 0.0);
    result.standard_error.emplace_back(count, 0.0);
    finish_row(std::span(batches).subspan(i * kBatches, kBatches), result.factors.back(),
               result.standard_error.back());
  }
  return result;
}

std::uint32_t default_rays(std::size_t surface_count) {
  constexpr std::size_t kTotal = std::size_t{1} << 26, kLeast = std::size_t{1} << 16,
                        kMost = std::size_t{1} << 22;
  return static_cast<std::uint32_t>(
      std::clamp(kTotal / std::max<std::size_t>(surface_count, 1), kLeast, kMost));
}

Result<SurfaceFactors> build(const Scene& scene, FactorGrouping grouping, std::uint32_t rays,
                             std::uint64_t seed, const ProgressObserver& observer) {
  if (scene.triangles.empty()) {
    return fail(ErrorCode::bad_input, fmt::format("{}: no static triangles to measure", scene.file_name));
  }
  const Geometry geometry = make_geometry(scene);
  const SurfaceGroups surfaces = group_triangles(scene, geometry, grouping);
  if (surfaces.list.size() > kMaxSurfaces) {
    return fail(ErrorCode::usage,
                fmt::format("{}: expected at most {} surfaces, found {}; group them by material",
                            scene.file_name, kMaxSurfaces, surfaces.list.size()));
  }
  const auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  if (rays == 0) rays = default_rays(surfaces.list.size());
  const SobolPoints points((rays - 1) / kBatches + 1);
  return trace_all({geometry, *caster, surfaces, points}, seed, observer);
}

}  // namespace

Result<SurfaceFactors> surface_factors(const Scene& scene, FactorGrouping grouping, std::uint32_t rays,
                                       std::uint64_t seed, std::uint32_t threads,
                                       const ProgressObserver& observer) {
  tbb::task_arena arena(arena_threads(threads));
  try {
    return arena.execute([&] { return build(scene, grouping, rays, seed, observer); });
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::out_of_memory,
        fmt::format("{}: memory ran out while form factors were measured: expected more than {:.0f} MB, "
                    "found less",
                    scene.file_name, 1e-6 * double(peak_address_bytes())));
  }
}

}  // namespace relume
