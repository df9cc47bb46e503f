// SPDX-License-Identifier: MIT
#include "precompute/ray_caster.h"

#include <embree3/rtcore.h>

#include <bit>
#include <cstring>
#include <limits>

#include "precompute/opacity.h"

namespace relume {
namespace {

/// What filters of triangles that are not opaque know of a query.
struct QueryContext {
  RTCIntersectContext base;
  AlphaTest alpha = AlphaTest::coin;
  bool multiply = false;       ///< pass on, and count what is left
  double transmittance = 1.0;  ///< of a query with `multiply`
};

/// What the filter knows of each lane's best hit so far.
struct HitContext {
  QueryContext query;
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

/// Whether a triangle that is not opaque stops lane `lane`.
bool stops(const RTCFilterFunctionNArguments* arguments, unsigned lane) {
  const auto& opacity = *static_cast<const TriangleOpacity*>(arguments->geometryUserPtr);
  auto& query = *reinterpret_cast<QueryContext*>(arguments->context);
  RTCRayN* ray = arguments->ray;
  const unsigned lanes = arguments->N, triangle = RTCHitN_primID(arguments->hit, lanes, lane);
  const float u = RTCHitN_u(arguments->hit, lanes, lane), v = RTCHitN_v(arguments->hit, lanes, lane);
  if (query.multiply) {
    if (!opacity.repeats(triangle)) query.transmittance *= 1.0 - double(opacity.at(triangle, u, v));
    return query.transmittance <= 0.0;
  }
  if (query.alpha == AlphaTest::solid) return opacity.at(triangle, u, v) > 0.0f;
  const glm::vec3 origin(RTCRayN_org_x(ray, lanes, lane), RTCRayN_org_y(ray, lanes, lane),
                         RTCRayN_org_z(ray, lanes, lane));
  const glm::vec3 way(RTCRayN_dir_x(ray, lanes, lane), RTCRayN_dir_y(ray, lanes, lane),
                      RTCRayN_dir_z(ray, lanes, lane));
  return !opacity.passes(triangle, u, v, ray_key(origin, way));
}

void let_alpha_pass(const RTCFilterFunctionNArguments* arguments) {
  for (unsigned lane = 0; lane < arguments->N; ++lane) {
    if (arguments->valid[lane] != 0 && !stops(arguments, lane)) arguments->valid[lane] = 0;
  }
}

void let_alpha_pass_and_prefer_lowest(const RTCFilterFunctionNArguments* arguments) {
  let_alpha_pass(arguments);
  prefer_lowest_triangle(arguments);
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

using Triangle = std::array<std::uint32_t, 3>;

/// The triangles that are opaque, or the others, as a geometry that numbers all of them: those that do not
/// belong get a vertex that is not finite, and Embree leaves such triangles out.
void attach_triangles(RTCDevice device, RTCScene scene, std::span<const glm::vec3> positions,
                      std::span<const Triangle> triangles, TriangleOpacity& opacity, bool opaque) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), positions.size() + 1));
  auto* indices = static_cast<Triangle*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), triangles.size()));
  if (vertices != nullptr && indices != nullptr) {
    const auto nowhere = std::uint32_t(positions.size());
    std::memcpy(vertices, positions.data(), positions.size_bytes());
    vertices[nowhere] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const bool belongs = opacity.opaque(t) == opaque && !opacity.never_solid(t);
      indices[t] = belongs ? triangles[t] : Triangle{nowhere, nowhere, nowhere};
    }
  }
  rtcSetGeometryIntersectFilterFunction(geometry,
                                        opaque ? prefer_lowest_triangle : let_alpha_pass_and_prefer_lowest);
  if (!opaque) {
    rtcSetGeometryUserData(geometry, &opacity);
    rtcSetGeometryOccludedFilterFunction(geometry, let_alpha_pass);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

/// The ray from a to b.
RTCRay segment(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 direction = b - a;
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
  return ray;
}

QueryContext start_query(AlphaTest alpha) {
  QueryContext query;
  rtcInitIntersectContext(&query.base);
  query.alpha = alpha;
  return query;
}

std::string describe(RTCDevice device) {
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  return "Embree " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100) + " " + instruction_set() + " robust";
}

/// Rays in Embree's layout; `valid` -1 or 0 per lane.
void copy_rays(const RayPacket& packet, RTCRay8& rays, std::array<int, kPacketSize>& valid) {
  static_assert(kPacketSize == 8);
  std::memcpy(rays.org_x, packet.origin_x.data(), sizeof packet.origin_x);
  std::memcpy(rays.org_y, packet.origin_y.data(), sizeof packet.origin_y);
  std::memcpy(rays.org_z, packet.origin_z.data(), sizeof packet.origin_z);
  std::memcpy(rays.tnear, packet.near.data(), sizeof packet.near);
  std::memcpy(rays.dir_x, packet.direction_x.data(), sizeof packet.direction_x);
  std::memcpy(rays.dir_y, packet.direction_y.data(), sizeof packet.direction_y);
  std::memcpy(rays.dir_z, packet.direction_z.data(), sizeof packet.direction_z);
  std::memcpy(rays.tfar, packet.far.data(), sizeof packet.far);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    valid[lane] = packet.far[lane] >= packet.near[lane] ? -1 : 0;
    rays.time[lane] = 0.0f;
    rays.mask[lane] = ~0u;
    rays.flags[lane] = 0;
  }
}

}  // namespace

struct RayCaster::Scene {
  TriangleOpacity opacity;
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
                                    std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const Opacity& opacity) {
  auto scene = std::make_unique<Scene>();
  scene->device.reset(rtcNewDevice((std::string("isa=") + instruction_set()).c_str()));
  if (!scene->device) return fail(ErrorCode::out_of_memory, "Embree could not create a device");
  scene->scene.reset(rtcNewScene(scene->device.get()));
  rtcSetSceneFlags(scene->scene.get(), RTC_SCENE_FLAG_ROBUST);
  // Spatial splits of the high-quality builder depend on timing between threads; binned SAH does not.
  rtcSetSceneBuildQuality(scene->scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  scene->opacity = TriangleOpacity(opacity, positions, triangles);
  for (const bool opaque : {true, false}) {
    if (triangles.empty() || (!opaque && !scene->opacity.any())) continue;
    attach_triangles(scene->device.get(), scene->scene.get(), positions, triangles, scene->opacity, opaque);
  }
  rtcCommitScene(scene->scene.get());
  if (const RTCError error = rtcGetDeviceError(scene->device.get()); error != RTC_ERROR_NONE) {
    return fail(ErrorCode::out_of_memory, "Embree could not build its tree over " +
                                              std::to_string(triangles.size()) + " triangles (RTCError " +
                                              std::to_string(int(error)) + ")");
  }
  scene->description = describe(scene->device.get());
  return RayCaster(std::move(scene));
}

void RayCaster::closest_hits(RayPacket& packet, AlphaTest alpha) const {
  HitContext context;
  context.query = start_query(alpha);
  context.distance.fill(std::numeric_limits<float>::infinity());
  context.triangle.fill(kNoTriangle);
  RTCRayHit8 rays;
  alignas(32) std::array<int, kPacketSize> valid;
  copy_rays(packet, rays.ray, valid);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.primID[lane] = kNoTriangle;
  }
  rtcIntersect8(valid.data(), scene_->scene.get(), &context.query.base, &rays);
  std::memcpy(packet.far.data(), rays.ray.tfar, sizeof packet.far);
  std::memcpy(packet.u.data(), rays.hit.u, sizeof packet.u);
  std::memcpy(packet.v.data(), rays.hit.v, sizeof packet.v);
  std::memcpy(packet.triangle.data(), rays.hit.primID, sizeof packet.triangle);
}

std::uint32_t RayCaster::occluded(const RayPacket& packet) const {
  QueryContext query = start_query(AlphaTest::coin);
  RTCRay8 rays;
  alignas(32) std::array<int, kPacketSize> valid;
  copy_rays(packet, rays, valid);
  rtcOccluded8(valid.data(), scene_->scene.get(), &query.base, &rays);
  std::uint32_t lanes = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (valid[lane] != 0 && rays.tfar[lane] < 0.0f) lanes |= 1u << lane;
  }
  return lanes;
}

bool RayCaster::occluded(const glm::vec3& a, const glm::vec3& b) const {
  QueryContext query = start_query(AlphaTest::solid);
  RTCRay ray = segment(a, b);
  rtcOccluded1(scene_->scene.get(), &query.base, &ray);
  return ray.tfar < 0.0f;
}

float RayCaster::transmittance(const glm::vec3& a, const glm::vec3& b) const {
  QueryContext query = start_query(AlphaTest::coin);
  query.multiply = true;
  RTCRay ray = segment(a, b);
  rtcOccluded1(scene_->scene.get(), &query.base, &ray);
  return ray.tfar < 0.0f ? 0.0f : float(query.transmittance);
}

}  // namespace relume
