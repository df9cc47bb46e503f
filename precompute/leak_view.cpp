// SPDX-License-Identifier: MIT
#include "precompute/leak_view.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "core/ray_offset.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

static_assert(kLeakPoints == kPacketSize);

/// The k-th of the points of the unit square that fill it evenly (M. Roberts, The Unreasonable Effectiveness
/// of Quasirandom Sequences, 2018).
glm::vec2 even_point(std::uint32_t k) {
  return glm::fract(glm::vec2(0.5f) + float(k + 1) * glm::vec2(0.7548776662f, 0.5698402910f));
}

void set_ray(RayPacket& packet, std::uint32_t lane, const glm::vec3& from, const glm::vec3& way, float far) {
  packet.origin_x[lane] = from.x, packet.origin_y[lane] = from.y, packet.origin_z[lane] = from.z;
  packet.direction_x[lane] = way.x, packet.direction_y[lane] = way.y, packet.direction_z[lane] = way.z;
  packet.near[lane] = 0.0f, packet.far[lane] = far;
}

/// Bit k: `from` and the front of point k see each other; of those in `asked`. Without `normal`, `from` is a
/// place in free space.
std::uint32_t seen_from(const RayCaster& caster, const glm::vec3& from, const glm::vec3* normal,
                        const LeakPoints& to, std::uint32_t asked) {
  RayPacket packet{};
  std::uint32_t traced = 0;
  for (std::uint32_t k = 0; k < kLeakPoints; ++k) {
    const glm::vec3 way = to[k].position - from;
    const bool faces = glm::dot(way, to[k].normal) < 0.0f && (!normal || glm::dot(way, *normal) > 0.0f);
    const bool used = (asked >> k & 1u) && faces;
    set_ray(packet, k, from, used ? way : glm::vec3(0.0f, 0.0f, 1.0f), used ? 1.0f : -1.0f);
    traced |= std::uint32_t(used) << k;
  }
  return traced == 0 ? 0 : traced & ~caster.occluded(packet);
}

}  // namespace

std::vector<WeightPart> spread(std::span<const double> weights, std::uint32_t count) {
  double total = 0.0;
  for (const double weight : weights) total += weight;
  std::vector<WeightPart> parts;
  std::uint32_t index = 0;
  double passed = weights.empty() ? 0.0 : weights[0];
  for (std::uint32_t k = 0; k < count && total > 0.0; ++k) {
    const double target = total * (k + 0.5) / count;
    while (passed < target && index + 1 < weights.size()) passed += weights[++index];
    parts.push_back({index, 1.0 / count});
  }
  return parts;
}

PointSpreader::PointSpreader(const Model& model, const RayCaster& caster)
    : occluders_(model.occluders), caster_(caster) {
  geometry_.offset = ray_offset(occluders_.positions);
}

LeakPoints PointSpreader::points(const System& system, std::uint32_t first, std::uint32_t count) const {
  std::vector<double> areas;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places;  // element, piece
  for (std::uint32_t e = first; e < first + count; ++e) {
    const SurfaceElement& element = system.elements[e];
    for (std::uint32_t p = element.first_piece; p < element.first_piece + element.piece_count; ++p) {
      areas.push_back(area(system.pieces[p]));
      places.emplace_back(e, p);
    }
  }
  const std::vector<WeightPart> parts = spread(areas, kLeakPoints);
  LeakPoints result;
  for (std::uint32_t k = 0; k < kLeakPoints; ++k) {
    const auto& [e, p] = places[parts.empty() ? 0 : parts[k].index];
    result[k] = owned(system.elements[e], point_of(system, system.elements[e], system.pieces[p], k));
    result[k].position += result[k].normal * geometry_.offset;
  }
  return result;
}

glm::vec3 PointSpreader::at(std::uint32_t triangle, const glm::vec2& uv) const {
  const auto& t = occluders_.triangles[triangle];
  const auto& p = occluders_.positions;
  return p[t[0]] * (1.0f - uv.x - uv.y) + p[t[1]] * uv.x + p[t[2]] * uv.y;
}

double PointSpreader::area(const SurfacePiece& piece) const {
  const glm::vec3 corner = at(piece.triangle, piece.corners[0]);
  return 0.5 * glm::length(glm::cross(at(piece.triangle, piece.corners[1]) - corner,
                                      at(piece.triangle, piece.corners[2]) - corner));
}

SurfacePoint PointSpreader::point_of(const System& system, const SurfaceElement& element,
                                     const SurfacePiece& piece, std::uint32_t k) const {
  const glm::vec2 square = even_point(k);
  const glm::vec2 inside = triangle_point(square.x, square.y);
  const auto& c = piece.corners;
  const glm::vec3 corner = at(piece.triangle, {0, 0});
  const glm::vec3 cross =
      glm::cross(at(piece.triangle, {1, 0}) - corner, at(piece.triangle, {0, 1}) - corner);
  const float length = glm::length(cross);
  const float side = system.clusters[element.cluster].side == Side::front ? 1.0f : -1.0f;
  return {at(piece.triangle, c[0] * (1.0f - inside.x - inside.y) + c[1] * inside.x + c[2] * inside.y),
          length > 0.0f ? cross * (side / length) : element.normal};
}

SurfacePoint PointSpreader::owned(const SurfaceElement& element, const SurfacePoint& point) const {
  const SurfacePoint middle{element.position, element.normal};
  return mutually_visible(geometry_, caster_, middle, point) ? point : middle;
}

LeakView::LeakView(const RayCaster& caster, const LeakPoints& points, float offset, float far)
    : caster_(caster), points_(points) {
  for (std::uint32_t first = 0; first < kLeakViews; first += kPacketSize) look_around(first, offset, far);
}

std::uint32_t LeakView::sees(const LeakPoints& to) const {
  std::uint32_t seen = 0;
  for (const SurfacePoint& from : points_) {
    const std::uint32_t asked = kAllLeakPoints & ~seen;
    if (asked != 0) seen |= seen_from(caster_, from.position, &from.normal, to, asked);
  }
  return seen;
}

std::uint32_t LeakView::joined(const LeakPoints& to, std::uint32_t asked) const {
  std::uint32_t seen = 0;
  for (const glm::vec3& place : places_) {
    if (asked & ~seen) seen |= seen_from(caster_, place, nullptr, to, asked & ~seen);
  }
  return seen;
}

void LeakView::look_around(std::uint32_t first, float offset, float far) {
  RayPacket packet{};
  std::array<glm::vec3, kPacketSize> origins, ways;
  for (std::uint32_t lane = 0; lane < kPacketSize; ++lane) {
    const SurfacePoint& from = points_[lane];
    const glm::vec2 square = even_point(first + lane);
    origins[lane] = from.position;
    ways[lane] = frame_about(from.normal).to_world(cosine_direction(square.x, square.y));
    set_ray(packet, lane, origins[lane], ways[lane], far);
  }
  caster_.closest_hits(packet);
  for (std::uint32_t lane = 0; lane < kPacketSize; ++lane) {
    const bool escaped = packet.triangle[lane] == kNoTriangle;
    const float length = escaped ? far : std::max(0.5f * packet.far[lane], packet.far[lane] - offset);
    places_.push_back(origins[lane] + ways[lane] * (0.5f * length));
    places_.push_back(origins[lane] + ways[lane] * length);
  }
}

}  // namespace relume
