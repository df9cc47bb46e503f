// SPDX-License-Identifier: MIT
#include "precompute/ray_caster.h"

#include <embree3/rtcore.h>

#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>

namespace relume {
namespace {

/// What the filter knows of each lane's best hit so far.
struct HitContext {
  RTCIntersectContext base;
  std::array<float, kPacketSize> distance;
  std::array<std::uint32_t, kPacketSize> triangle;
};

/// Bit l: lane l of a packet is valid. Nearly always there is one, anywhere.
std::uint32_t valid_lanes(const int* valid) {
  std::uint32_t lanes = 0;
  for (int lane = 0; lane < kPacketSize; ++lane)
    lanes |= (static_cast<std::uint32_t>(valid[lane]) & 1u) << lane;
  return lanes;
}

/// Accepts a hit at the distance of the best one so far only from a lower triangle: the answer does not
/// depend on the order in which the BVH is walked.
void prefer_lowest_triangle(const RTCFilterFunctionNArguments* arguments) {
  auto* context = reinterpret_cast<HitContext*>(arguments->context);
  const float* distance = &RTCRayN_tfar(arguments->ray, kPacketSize, 0);
  const unsigned* triangle = &RTCHitN_primID(arguments->hit, kPacketSize, 0);
  for (std::uint32_t lanes = valid_lanes(arguments->valid); lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    if (distance[lane] == context->distance[lane] && triangle[lane] > context->triangle[lane]) {
      arguments->valid[lane] = 0;
      continue;
    }
    context->distance[lane] = distance[lane];
    context->triangle[lane] = triangle[lane];
  }
}

/// One instruction set on every machine that has it: results differ between sets in the last place.
const char* instruction_set() {
  return __builtin_cpu_supports("avx2") ? "avx2" : "sse2";
}

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneRelease>;

void attach_triangles(RTCDevice device, RTCScene scene, std::span<const glm::vec3> positions,
                      std::span<const std::array<std::uint32_t, 3>> triangles) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(glm::vec3), positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(std::array<std::uint32_t, 3>), triangles.size());
  if (vertices != nullptr && indices != nullptr) {
    std::memcpy(vertices, positions.data(), positions.size_bytes());
    std::memcpy(indices, triangles.data(), triangles.size_bytes());
  }
  rtcSetGeometryIntersectFilterFunction(geometry, prefer_lowest_triangle);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

std::string describe(RTCDevice device) {
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  return "Embree " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100) + " " + instruction_set() + " robust";
}

static_assert(sizeof(RayPacket) == sizeof(RTCRayHit8) && alignof(RayPacket) == alignof(RTCRayHit8));
static_assert(offsetof(RayPacket, near) == offsetof(RTCRayHit8, ray.tnear) &&
              offsetof(RayPacket, far) == offsetof(RTCRayHit8, ray.tfar) &&
              offsetof(RayPacket, mask) == offsetof(RTCRayHit8, ray.mask) &&
              offsetof(RayPacket, flags) == offsetof(RTCRayHit8, ray.flags) &&
              offsetof(RayPacket, u) == offsetof(RTCRayHit8, hit.u) &&
              offsetof(RayPacket, triangle) == offsetof(RTCRayHit8, hit.primID) &&
              offsetof(RayPacket, geometry) == offsetof(RTCRayHit8, hit.geomID));

/// -1 for lanes with a ray, 0 for others.
struct alignas(32) ValidLanes {
  explicit ValidLanes(const RayPacket& packet) {
    for (int lane = 0; lane < kPacketSize; ++lane)
      valid[lane] = packet.far[lane] >= packet.near[lane] ? -1 : 0;
  }
  std::array<int, kPacketSize> valid;
};

}  // namespace

struct RayCaster::Scene {
  Device device;
  EmbreeScene scene;
  std::string description;
};

RayCaster::RayCaster(std::unique_ptr<Scene> scene) : scene_(std::move(scene)) {}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

const std::string& RayCaster::description() const {
  return scene_->description;
}

Result<RayCaster> RayCaster::create(std::span<const glm::vec3> positions,
                                    std::span<const std::array<std::uint32_t, 3>> triangles) {
  auto scene = std::make_unique<Scene>();
  scene->device.reset(rtcNewDevice((std::string("isa=") + instruction_set()).c_str()));
  if (!scene->device) return fail(ErrorCode::out_of_memory, "Embree could not create a device");
  scene->scene.reset(rtcNewScene(scene->device.get()));
  rtcSetSceneFlags(scene->scene.get(), RTC_SCENE_FLAG_ROBUST);
  // Spatial splits of the high-quality builder depend on timing between threads; binned SAH does not.
  rtcSetSceneBuildQuality(scene->scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  if (!triangles.empty()) attach_triangles(scene->device.get(), scene->scene.get(), positions, triangles);
  rtcCommitScene(scene->scene.get());
  if (const RTCError error = rtcGetDeviceError(scene->device.get()); error != RTC_ERROR_NONE) {
    return fail(ErrorCode::out_of_memory, "Embree could not build its tree over " +
                                              std::to_string(triangles.size()) + " triangles (RTCError " +
                                              std::to_string(int(error)) + ")");
  }
  scene->description = describe(scene->device.get());
  return RayCaster(std::move(scene));
}

void RayCaster::closest_hits(RayPacket& packet, RaySpread spread) const {
  HitContext context;
  rtcInitIntersectContext(&context.base);
  if (spread == RaySpread::narrow) context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.distance.fill(std::numeric_limits<float>::infinity());
  context.triangle.fill(kNoTriangle);
  packet.triangle.fill(kNoTriangle);
  packet.geometry.fill(RTC_INVALID_GEOMETRY_ID);
  const ValidLanes lanes(packet);
  rtcIntersect8(lanes.valid.data(), scene_->scene.get(), &context.base,
                reinterpret_cast<RTCRayHit8*>(&packet));
}

std::uint32_t RayCaster::occluded(RayPacket& packet) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const ValidLanes lanes(packet);
  rtcOccluded8(lanes.valid.data(), scene_->scene.get(), &context, reinterpret_cast<RTCRay8*>(&packet));
  std::uint32_t hidden = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (lanes.valid[lane] != 0 && packet.far[lane] < 0.0f) hidden |= 1u << lane;
  }
  return hidden;
}

bool RayCaster::occluded(const glm::vec3& a, const glm::vec3& b) const {
  const glm::vec3 direction = b - a;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  ray.org_x = a.x;
  ray.org_y = a.y;
  ray.org_z = a.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tnear = 0.0f;
  ray.tfar = 1.0f;
  ray.mask = ~0u;
  rtcOccluded1(scene_->scene.get(), &context, &ray);
  return ray.tfar < 0.0f;
}

}  // namespace relume
