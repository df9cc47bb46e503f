// SPDX-License-Identifier: MIT
#include "precompute/ray_caster.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

#include "core/ray_offset.h"
#include "precompute/embree_memory.h"
#include "precompute/embree_ties.h"
#include "precompute/opacity.h"
#include "precompute/packet_lanes.h"

namespace relume {
namespace {

/// What filters of triangles that are not opaque know of a query.
struct QueryContext {
  RTCIntersectContext base;
  AlphaTest alpha = AlphaTest::coin;
  bool multiply = false;       ///< pass on, and count what is left
  double transmittance = 1.0;  ///< of a query with `multiply`
};

/// A barycentric coordinate below which a hit lies at an edge.
constexpr float kNearEdge = 1e-6f;

bool near_edge(float u, float v) {
  return std::min(std::min(u, v), 1.0f - u - v) < kNearEdge;
}

/// What the rays of a packet have met first in the order of triangles, not of distance.
struct LowestHits {
  QueryContext query;
  const std::vector<std::uint8_t>* flags = nullptr;  ///< per triangle; may be empty
  RayPacket::Numbers triangle;
  RayPacket::Floats distance, u, v;
};

/// The order in which triangles take a hit: first those that it lies inside of. A ray that Embree says to
/// meet one inside is not asked again, so whatever else it might have said must lose to that one.
std::uint64_t rank(const LowestHits& hits, std::uint32_t triangle, float u, float v) {
  const bool thin = !hits.flags->empty() && ((*hits.flags)[triangle] & kThin) != 0;
  return std::uint64_t{thin || near_edge(u, v) ? 1u : 0u} << 32 | triangle;
}

/// Books the first of the triangles of each ray, by rank, and lets it pass on through everything. Rays have
/// their lanes as ids: Embree may take a packet apart.
void keep_lowest(const RTCFilterFunctionNArguments* arguments) {
  auto& lowest = *reinterpret_cast<LowestHits*>(arguments->context);
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    arguments->valid[i] = 0;
    const unsigned lane = RTCRayN_id(arguments->ray, n, i);
    const std::uint32_t triangle = RTCHitN_primID(arguments->hit, n, i);
    const float u = RTCHitN_u(arguments->hit, n, i), v = RTCHitN_v(arguments->hit, n, i);
    if (lowest.triangle[lane] != kNoTriangle &&
        rank(lowest, triangle, u, v) >= rank(lowest, lowest.triangle[lane], lowest.u[lane], lowest.v[lane]))
      continue;
    lowest.triangle[lane] = triangle, lowest.distance[lane] = RTCRayN_tfar(arguments->ray, n, i);
    lowest.u[lane] = u, lowest.v[lane] = v;
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

/// One instruction set on every machine that has it: results differ between sets in the last place.
const char* instruction_set() {
  return __builtin_cpu_supports("avx2") ? "avx2" : "sse2";
}

/// The triangles that are opaque, or the others, as a geometry that numbers all of them: those that do not
/// belong get a vertex that is not finite, and Embree leaves such triangles out.
void attach_triangles(RTCDevice device, RTCScene scene, const Mesh& mesh, TriangleOpacity& opacity,
                      bool opaque) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.positions.size() + 1));
  auto* indices = static_cast<Triangle*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size()));
  if (vertices != nullptr && indices != nullptr) {
    const auto nowhere = std::uint32_t(mesh.positions.size());
    std::memcpy(vertices, mesh.positions.data(), mesh.positions.size_bytes());
    vertices[nowhere] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool belongs = opacity.opaque(t) == opaque && !opacity.never_solid(t);
      indices[t] = belongs ? mesh.triangles[t] : Triangle{nowhere, nowhere, nowhere};
    }
  }
  if (!opaque) {
    rtcSetGeometryUserData(geometry, &opacity);
    rtcSetGeometryIntersectFilterFunction(geometry, let_alpha_pass);
    rtcSetGeometryOccludedFilterFunction(geometry, let_alpha_pass);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

RTCRay ray_from(const glm::vec3& origin, const glm::vec3& direction, float far) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tnear = 0.0f, ray.tfar = far;
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

static_assert(sizeof(RayPacket) == sizeof(RTCRayHit8) && alignof(RayPacket) == alignof(RTCRayHit8));
static_assert(offsetof(RayPacket, near) == offsetof(RTCRayHit8, ray.tnear) &&
              offsetof(RayPacket, far) == offsetof(RTCRayHit8, ray.tfar) &&
              offsetof(RayPacket, mask) == offsetof(RTCRayHit8, ray.mask) &&
              offsetof(RayPacket, flags) == offsetof(RTCRayHit8, ray.flags) &&
              offsetof(RayPacket, u) == offsetof(RTCRayHit8, hit.u) &&
              offsetof(RayPacket, triangle) == offsetof(RTCRayHit8, hit.primID) &&
              offsetof(RayPacket, geometry) == offsetof(RTCRayHit8, hit.geomID));

/// -1 for chosen lanes, 0 for others.
struct alignas(32) LaneChoice : std::array<int, kPacketSize> {
  bool any() const {
    return std::any_of(begin(), end(), [](int lane) { return lane != 0; });
  }
};

LaneChoice lanes_with_rays(const RayPacket& packet) {
  LaneChoice lanes;
  for (int lane = 0; lane < kPacketSize; ++lane) lanes[lane] = packet.far[lane] >= packet.near[lane] ? -1 : 0;
  return lanes;
}

/// Lanes that met a triangle at one of its edges, or one with flags (per triangle; may be empty).
LaneChoice lanes_with_ties(const RayPacket& packet, const std::vector<std::uint8_t>& flags) {
  LaneChoice lanes;
  for (int lane = 0; lane < kPacketSize; ++lane)
    lanes[lane] = packet.triangle[lane] != kNoTriangle && near_edge(packet.u[lane], packet.v[lane]) ? -1 : 0;
  if (flags.empty()) return lanes;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (packet.triangle[lane] != kNoTriangle && flags[packet.triangle[lane]] != 0) lanes[lane] = -1;
  }
  return lanes;
}

/// Gives hits to the first triangle, by rank, among those as far away, up to rounding.
void settle_ties(RTCScene scene, const LaneChoice& lanes, float largest,
                 const std::vector<std::uint8_t>& flags, AlphaTest alpha, RayPacket& packet) {
  LowestHits lowest;
  lowest.flags = &flags, lowest.query = start_query(alpha);
  lowest.query.base.filter = keep_lowest;
  lowest.triangle.fill(kNoTriangle);
  RayPacket around = packet;
  around.geometry.fill(RTC_INVALID_GEOMETRY_ID);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const float way = glm::length(direction_of(packet, std::size_t(lane)));
    const float margin = (packet.far[lane] + largest / way) * 0x1p-20f;
    around.near[lane] = std::max(packet.near[lane], packet.far[lane] - margin);
    around.far[lane] = packet.far[lane] + margin;
    around.id[lane] = std::uint32_t(lane);
  }
  rtcIntersect8(lanes.data(), scene, &lowest.query.base, reinterpret_cast<RTCRayHit8*>(&around));
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (lanes[lane] == 0 || lowest.triangle[lane] == kNoTriangle) continue;
    packet.triangle[lane] = lowest.triangle[lane], packet.far[lane] = lowest.distance[lane];
    packet.u[lane] = lowest.u[lane], packet.v[lane] = lowest.v[lane];
  }
}

}  // namespace

struct RayCaster::Scene {
  TriangleOpacity opacity;
  Device device;
  EmbreeScene scene;
  std::string description;
  std::vector<std::uint8_t> ties;  ///< flags of each triangle; empty: none has any
  float largest = 0.0f;            ///< coordinate
};

RayCaster::RayCaster(std::unique_ptr<Scene> scene) : scene_(std::move(scene)) {}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

const std::vector<std::uint8_t>& RayCaster::ties() const {
  return scene_->ties;
}

const std::string& RayCaster::description() const {
  return scene_->description;
}

Result<RayCaster> RayCaster::create(std::span<const glm::vec3> positions,
                                    std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const Opacity& opacity, std::span<const std::uint8_t> known_ties) {
  if (auto enough = check_embree_memory(triangles.size()); !enough) return tl::unexpected(enough.error());
  auto scene = std::make_unique<Scene>();
  scene->device.reset(rtcNewDevice((std::string("isa=") + instruction_set()).c_str()));
  if (!scene->device) return tl::unexpected(no_embree_memory(triangles.size()));
  scene->scene.reset(rtcNewScene(scene->device.get()));
  rtcSetSceneFlags(scene->scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  // Spatial splits of the high-quality builder depend on timing between threads; binned SAH does not.
  rtcSetSceneBuildQuality(scene->scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  const Mesh mesh{positions, triangles, largest_coordinate(positions)};
  scene->largest = mesh.largest;
  if (!triangles.empty()) {
    auto ties = find_ties(scene->device.get(), mesh, known_ties);
    if (!ties) return tl::unexpected(ties.error());
    scene->ties = std::move(*ties);
    scene->opacity = TriangleOpacity(opacity, positions, triangles);
    attach_triangles(scene->device.get(), scene->scene.get(), mesh, scene->opacity, true);
    if (scene->opacity.any())
      attach_triangles(scene->device.get(), scene->scene.get(), mesh, scene->opacity, false);
  }
  if (auto built = build_tree(scene->device.get(), scene->scene, triangles.size()); !built)
    return tl::unexpected(built.error());
  scene->description = describe(scene->device.get());
  return RayCaster(std::move(scene));
}

void RayCaster::closest_hits(RayPacket& packet, RaySpread spread, AlphaTest alpha) const {
  QueryContext query = start_query(alpha);
  if (spread == RaySpread::narrow) query.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  packet.triangle.fill(kNoTriangle), packet.geometry.fill(RTC_INVALID_GEOMETRY_ID);
  const LaneChoice lanes = lanes_with_rays(packet);
  rtcIntersect8(lanes.data(), scene_->scene.get(), &query.base, reinterpret_cast<RTCRayHit8*>(&packet));
  const LaneChoice ties = lanes_with_ties(packet, scene_->ties);
  if (ties.any()) settle_ties(scene_->scene.get(), ties, scene_->largest, scene_->ties, alpha, packet);
}

void RayCaster::settle(RayPacket& packet, std::uint32_t lanes) const {
  LaneChoice ties;
  for (int lane = 0; lane < kPacketSize; ++lane)
    ties[lane] = (lanes >> lane & 1u) != 0 && packet.triangle[lane] != kNoTriangle ? -1 : 0;
  if (ties.any())
    settle_ties(scene_->scene.get(), ties, scene_->largest, scene_->ties, AlphaTest::coin, packet);
}

std::uint32_t RayCaster::occluded(RayPacket& packet, AlphaTest alpha) const {
  QueryContext query = start_query(alpha);
  const LaneChoice lanes = lanes_with_rays(packet);
  rtcOccluded8(lanes.data(), scene_->scene.get(), &query.base, reinterpret_cast<RTCRay8*>(&packet));
  std::uint32_t hidden = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (lanes[lane] != 0 && packet.far[lane] < 0.0f) hidden |= 1u << lane;
  }
  return hidden;
}

bool RayCaster::occluded(const glm::vec3& a, const glm::vec3& b) const {
  QueryContext query = start_query(AlphaTest::solid);
  RTCRay ray = ray_from(a, b - a, 1.0f);
  rtcOccluded1(scene_->scene.get(), &query.base, &ray);
  return ray.tfar < 0.0f;
}

float RayCaster::free_way(const glm::vec3& from, const glm::vec3& direction, float most) const {
  QueryContext query = start_query(AlphaTest::solid);
  RTCRayHit hit{};
  hit.ray = ray_from(from, direction, most);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_->scene.get(), &query.base, &hit);
  return hit.ray.tfar;
}

float RayCaster::transmittance(const glm::vec3& a, const glm::vec3& b) const {
  QueryContext query = start_query(AlphaTest::coin);
  query.multiply = true;
  RTCRay ray = ray_from(a, b - a, 1.0f);
  rtcOccluded1(scene_->scene.get(), &query.base, &ray);
  return ray.tfar < 0.0f ? 0.0f : float(query.transmittance);
}

}  // namespace relume
