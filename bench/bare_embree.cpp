// SPDX-License-Identifier: MIT
#include "bare_embree.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace relume::bench {
namespace {

void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* rays) {
  rtcIntersect8(valid, scene, context, rays);
}
void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16* rays) {
  rtcIntersect16(valid, scene, context, rays);
}

void trace_single(RTCScene scene, const RayList& list, HitCount& count) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray;
    ray.ray = {list.origin_x[i],
               list.origin_y[i],
               list.origin_z[i],
               0.0f,
               list.direction_x[i],
               list.direction_y[i],
               list.direction_z[i],
               0.0f,
               std::numeric_limits<float>::infinity(),
               ~0u,
               0,
               0};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    ++count.hits;
    count.triangle_sum += ray.hit.primID;
  }
}

template <class Rays, std::size_t Width>
void trace_packets(RTCScene scene, const RayList& list, bool alike, HitCount& count) {
  for (std::size_t first = 0; first < list.size(); first += Width) {
    const std::size_t lanes = std::min(Width, list.size() - first);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (alike) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    Rays rays;
    alignas(64) std::array<int, Width> valid;
    const auto copy = [&](float* to, const std::vector<float>& from) {
      std::memcpy(to, from.data() + first, lanes * sizeof(float));
    };
    copy(rays.ray.org_x, list.origin_x), copy(rays.ray.org_y, list.origin_y),
        copy(rays.ray.org_z, list.origin_z);
    copy(rays.ray.dir_x, list.direction_x), copy(rays.ray.dir_y, list.direction_y);
    copy(rays.ray.dir_z, list.direction_z);
    for (std::size_t lane = 0; lane < Width; ++lane) {
      valid[lane] = lane < lanes ? -1 : 0;
      rays.ray.tnear[lane] = 0.0f;
      rays.ray.tfar[lane] = std::numeric_limits<float>::infinity();
      rays.ray.time[lane] = 0.0f;
      rays.ray.mask[lane] = ~0u;
      rays.ray.flags[lane] = 0;
      rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect(valid.data(), scene, &context, &rays);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      ++count.hits;
      count.triangle_sum += rays.hit.primID[lane];
    }
  }
}

}  // namespace

struct BareEmbree::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

BareEmbree::BareEmbree(std::unique_ptr<State> state) : state_(std::move(state)) {}
BareEmbree::BareEmbree(BareEmbree&&) noexcept = default;
BareEmbree::~BareEmbree() = default;

Result<BareEmbree> BareEmbree::create(std::span<const glm::vec3> positions,
                                      std::span<const std::array<std::uint32_t, 3>> triangles,
                                      const std::string& configuration) {
  auto state = std::make_unique<State>();
  state->device = rtcNewDevice(configuration.c_str());
  if (state->device == nullptr) return fail(ErrorCode::out_of_memory, "Embree could not create a device");
  state->scene = rtcNewScene(state->device);
  rtcSetSceneFlags(state->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(glm::vec3), positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(std::array<std::uint32_t, 3>), triangles.size());
  if (vertices == nullptr || indices == nullptr)
    return fail(ErrorCode::out_of_memory, "Embree found no memory");
  std::memcpy(vertices, positions.data(), positions.size_bytes());
  std::memcpy(indices, triangles.data(), triangles.size_bytes());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(state->scene);
  return BareEmbree(std::move(state));
}

HitCount BareEmbree::trace(std::span<const RayList> lists, int width, bool alike) const {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, lists.size()), HitCount{},
      [&](const Range& range, HitCount count) {
        for (const RayList& rays : lists.subspan(range.begin(), range.size())) {
          if (width == 1) trace_single(state_->scene, rays, count);
          if (width == 8) trace_packets<RTCRayHit8, 8>(state_->scene, rays, alike, count);
          if (width == 16) trace_packets<RTCRayHit16, 16>(state_->scene, rays, alike, count);
        }
        return count;
      },
      [](HitCount a, const HitCount& b) {
        a.hits += b.hits;
        a.triangle_sum += b.triangle_sum;
        return a;
      });
}

}  // namespace relume::bench
