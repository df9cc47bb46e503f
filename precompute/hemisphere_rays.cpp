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

/// Always inline: a call from one instruction set into another costs more than all of it.
[[gnu::always_inline]] inline void set_lane(const Frame& frame, float offset, const PointLanes& origins,
                                            const DirectionLanes& local, std::size_t lane, RayPacket& rays) {
  const glm::vec3 direction = frame.to_world({local.x[lane], local.y[lane], local.z[lane]});
  rays.direction_x[lane] = direction.x;
  rays.direction_y[lane] = direction.y;
  rays.direction_z[lane] = direction.z;
  rays.origin_x[lane] = origins.x[lane] + offset * frame.normal.x;
  rays.origin_y[lane] = origins.y[lane] + offset * frame.normal.y;
  rays.origin_z[lane] = origins.z[lane] + offset * frame.normal.z;
}

/// All lanes at once; the same numbers from either version, for neither contracts nor reorders.
[[gnu::target_clones("avx2", "default")]] void make_rays(const SampleLanes& samples,
                                                         const AreaSampler& sampler, float offset,
                                                         PointLanes& origins, RayPacket& rays) {
  sampler.sample(samples.coordinate[2], samples.coordinate[3], origins);
  DirectionLanes local;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const glm::vec3 direction = cosine_direction(samples.coordinate[0][lane], samples.coordinate[1][lane]);
    local.x[lane] = direction.x, local.y[lane] = direction.y, local.z[lane] = direction.z;
  }
  if (sampler.flat()) {
    const Frame frame = sampler.patch(0).frame;
    for (std::size_t lane = 0; lane < kLanes; ++lane) set_lane(frame, offset, origins, local, lane, rays);
  } else {
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      set_lane(sampler.patch(origins.patch[lane]).frame, offset, origins, local, lane, rays);
  }
  rays.near.fill(0.0f);
  rays.far.fill(std::numeric_limits<float>::infinity());
}

[[gnu::target_clones("avx2", "default")]] void make_samples(const SobolPoints& points,
                                                            const std::array<std::uint32_t, kLanes>& some,
                                                            std::uint64_t key, SampleLanes& samples) {
  points.scrambled(some, key, samples);
}

}  // namespace

void make_packet(const Geometry& geometry, const Receiver& receiver, const SobolPoints& points,
                 std::uint64_t key, std::span<const std::uint32_t> some, HemispherePacket& packet) {
  std::array<std::uint32_t, kLanes> chosen;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    chosen[lane] = some[std::min(lane, some.size() - 1)];
    packet.numbers[lane] = points.number(chosen[lane]);
  }
  SampleLanes samples;
  make_samples(points, chosen, key, samples);
  make_rays(samples, receiver.origins(), geometry.offset, packet.origins, packet.rays);
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
