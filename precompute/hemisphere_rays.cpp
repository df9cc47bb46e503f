// SPDX-License-Identifier: MIT
#include "precompute/hemisphere_rays.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace relume {
namespace {

static_assert(kPacketSize == int(kLanes));

/// Directions about +Z, lane by lane.
struct DirectionLanes {
  Lanes x, y, z;
};

/// The axes of frames, lane by lane.
using FrameLanes = std::array<Lanes, 9>;
std::array<float, 9> axes(const Frame& f) {
  return {f.tangent.x,   f.tangent.y, f.tangent.z, f.bitangent.x, f.bitangent.y,
          f.bitangent.z, f.normal.x,  f.normal.y,  f.normal.z};
}

// Always inline: a call from one instruction set into another costs more than all of it. Statement by
// statement for all lanes, into local arrays: so compilers see that lanes go together.

[[gnu::always_inline]] inline void spread_frames(const AreaSampler& sampler, const PointLanes& origins,
                                                 FrameLanes& frames) {
  if (sampler.flat()) {
    const auto own = axes(sampler.patch(0).frame);
    for (std::size_t a = 0; a < own.size(); ++a) frames[a].fill(own[a]);
    return;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto own = axes(sampler.patch(origins.patch[lane]).frame);
    for (std::size_t a = 0; a < own.size(); ++a) frames[a][lane] = own[a];
  }
}

/// One coordinate of all rays, `axis` of x, y and z.
[[gnu::always_inline]] inline void set_axis(const FrameLanes& frames, std::size_t axis, float offset,
                                            const Lanes& on_surface, const DirectionLanes& local,
                                            Lanes& origin, Lanes& direction) {
  const Lanes &tangent = frames[axis], &bitangent = frames[3 + axis], &normal = frames[6 + axis];
  Lanes way, from;
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    way[lane] =
        tangent[lane] * local.x[lane] + bitangent[lane] * local.y[lane] + normal[lane] * local.z[lane];
  for (std::size_t lane = 0; lane < kLanes; ++lane) from[lane] = on_surface[lane] + offset * normal[lane];
  direction = way, origin = from;
}

/// What lies on one multiple of kLanes and those after it is read at once.
[[gnu::always_inline]] inline void make_samples(const SobolPoints& points,
                                                const std::array<std::uint32_t, kLanes>& some,
                                                std::uint64_t key, SampleLanes& samples) {
  bool in_order = some[0] % kLanes == 0;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) in_order &= some[lane] == some[0] + lane;
  if (in_order) {
    points.scrambled(some[0], key, samples);
  } else {
    points.scrambled(some, key, samples);
  }
}

/// All lanes at once; the same numbers from either version, for neither contracts nor reorders.
[[gnu::target_clones("avx2", "default")]] void make_rays(const SobolPoints& points,
                                                         const std::array<std::uint32_t, kLanes>& some,
                                                         std::uint64_t key, const AreaSampler& sampler,
                                                         float offset, PointLanes& origins, RayPacket& rays) {
  SampleLanes samples;
  make_samples(points, some, key, samples);
  PointLanes places;
  sampler.sample(samples.coordinate[2], samples.coordinate[3], places);
  origins = places;
  DirectionLanes local;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const glm::vec3 direction = cosine_direction(samples.coordinate[0][lane], samples.coordinate[1][lane]);
    local.x[lane] = direction.x, local.y[lane] = direction.y, local.z[lane] = direction.z;
  }
  FrameLanes frames;
  spread_frames(sampler, places, frames);
  set_axis(frames, 0, offset, places.x, local, rays.origin_x, rays.direction_x);
  set_axis(frames, 1, offset, places.y, local, rays.origin_y, rays.direction_y);
  set_axis(frames, 2, offset, places.z, local, rays.origin_z, rays.direction_z);
  rays.near.fill(0.0f);
  rays.far.fill(std::numeric_limits<float>::infinity());
}

}  // namespace

void make_packet(const Geometry& geometry, const Receiver& receiver, const SobolPoints& points,
                 std::uint64_t key, std::span<const std::uint32_t> some, HemispherePacket& packet) {
  std::array<std::uint32_t, kLanes> chosen;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    chosen[lane] = some[std::min(lane, some.size() - 1)];
    packet.numbers[lane] = points.number(chosen[lane]);
  }
  make_rays(points, chosen, key, receiver.origins(), geometry.offset, packet.origins, packet.rays);
  packet.used.fill(true);
  for (std::size_t lane = some.size(); lane < kLanes; ++lane) {
    packet.used[lane] = false;
    packet.rays.far[lane] = -1.0f;
  }
}

void fill_packet(const Geometry& geometry, const RayCaster& caster, const Receiver& receiver,
                 const SobolPoints& points, std::uint64_t key, std::uint32_t first,
                 HemispherePacket& packet) {
  std::array<std::uint32_t, kLanes> some;
  std::iota(some.begin(), some.end(), first);
  make_packet(geometry, receiver, points, key,
              std::span(some).first(std::min<std::size_t>(kLanes, points.count() - first)), packet);
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    if (!packet.used[lane] || receiver.owns(geometry, caster, packet.origins, lane)) continue;
    packet.used[lane] = false;
    packet.rays.far[lane] = -1.0f;
  }
}

}  // namespace relume
