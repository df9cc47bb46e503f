// SPDX-License-Identifier: MIT
#include "scene/shapes.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace relume {
namespace {

std::uint32_t append_vertex(GlbPrimitive& mesh, const glm::dvec3& position, const glm::dvec3& normal) {
  mesh.positions.emplace_back(position);
  mesh.normals.emplace_back(normal);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

bool is_flat(const GlbPrimitive& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const auto& p = mesh.positions;
  return p[triangle[0]] == p[triangle[1]] || p[triangle[1]] == p[triangle[2]] ||
         p[triangle[2]] == p[triangle[0]];
}

void append_triangle(GlbPrimitive& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, Facing facing) {
  const std::array<std::uint32_t, 3> triangle = {a, facing == Facing::outward ? b : c,
                                                 facing == Facing::outward ? c : b};
  if (!is_flat(mesh, triangle)) mesh.triangles.push_back(triangle);
}

/// Outward normals of a profile, across each ring.
std::vector<glm::dvec2> profile_normals(const std::vector<glm::dvec2>& points) {
  std::vector<glm::dvec2> normals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 along = points[std::min(i + 1, points.size() - 1)] - points[i == 0 ? 0 : i - 1];
    normals.push_back(glm::normalize(glm::dvec2(along.y, -along.x)));
  }
  return normals;
}

}  // namespace

void append_quad(GlbPrimitive& mesh, const glm::dvec3& a, const glm::dvec3& u, const glm::dvec3& v) {
  const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
  const std::uint32_t first = append_vertex(mesh, a, normal);
  append_vertex(mesh, a + u, normal);
  append_vertex(mesh, a + u + v, normal);
  append_vertex(mesh, a + v, normal);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

void append_quad_with_hole(GlbPrimitive& mesh, const glm::dvec3& a, const glm::dvec3& u, const glm::dvec3& v,
                           const glm::dvec2& low, const glm::dvec2& high) {
  const std::array<double, 4> at_u = {0.0, low.x, high.x, 1.0};
  const std::array<double, 4> at_v = {0.0, low.y, high.y, 1.0};
  const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const double y : at_v) {
    for (const double x : at_u) append_vertex(mesh, a + x * u + y * v, normal);
  }
  for (std::uint32_t row = 0; row < 3; ++row) {
    for (std::uint32_t column = 0; column < 3; ++column) {
      if (row == 1 && column == 1) continue;
      const std::uint32_t corner = first + 4 * row + column;
      append_triangle(mesh, corner, corner + 1, corner + 5, Facing::outward);
      append_triangle(mesh, corner, corner + 5, corner + 4, Facing::outward);
    }
  }
}

void append_box(GlbPrimitive& mesh, const glm::dvec3& low, const glm::dvec3& high, std::uint32_t faces,
                Facing facing) {
  const glm::dvec3 x(high.x - low.x, 0.0, 0.0);
  const glm::dvec3 y(0.0, high.y - low.y, 0.0);
  const glm::dvec3 z(0.0, 0.0, high.z - low.z);
  const auto face = [&](std::uint32_t bit, const glm::dvec3& a, const glm::dvec3& u, const glm::dvec3& v) {
    if ((faces & bit) == 0) return;
    facing == Facing::outward ? append_quad(mesh, a, u, v) : append_quad(mesh, a, v, u);
  };
  face(kLeft, low, z, y);
  face(kRight, low + x + z, -z, y);
  face(kBottom, low, x, z);
  face(kTop, low + y + z, x, -z);
  face(kBack, low + x, -x, y);
  face(kFront, low + z, x, y);
}

void append_revolved(GlbPrimitive& mesh, const glm::dvec3& foot, std::uint32_t rings, std::uint32_t segments,
                     const std::function<glm::dvec2(double)>& profile, Facing facing) {
  std::vector<glm::dvec2> points;
  for (std::uint32_t r = 0; r <= rings; ++r) points.push_back(profile(static_cast<double>(r) / rings));
  const auto normals = profile_normals(points);
  const double sign = facing == Facing::outward ? 1.0 : -1.0;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double angle = 2.0 * kPi * s / segments;
      const glm::dvec3 out(std::cos(angle), 0.0, -std::sin(angle));
      const glm::dvec3 up(0.0, 1.0, 0.0);
      append_vertex(mesh, foot + points[r].x * out + points[r].y * up,
                    sign * (normals[r].x * out + normals[r].y * up));
    }
  }
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t a = first + r * segments + s;
      const std::uint32_t b = first + r * segments + (s + 1) % segments;
      append_triangle(mesh, a, b, b + segments, facing);
      append_triangle(mesh, a, b + segments, a + segments, facing);
    }
  }
}

void append_sphere(GlbPrimitive& mesh, const glm::dvec3& center, double radius, double from_angle,
                   double to_angle, std::uint32_t rings, std::uint32_t segments, Facing facing) {
  const auto profile = [&](double t) {
    const double angle = std::lerp(to_angle, from_angle, t);  // exact at both ends, where spheres meet
    // sin(pi) is not 0 in floating point, and a pole must be one point.
    const double across = angle >= kPi || angle <= 0.0 ? 0.0 : radius * std::sin(angle);
    return glm::dvec2(across, radius * std::cos(angle));
  };
  append_revolved(mesh, center, rings, segments, profile, facing);
}

}  // namespace relume
