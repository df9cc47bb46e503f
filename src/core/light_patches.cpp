// SPDX-License-Identifier: MIT
#include "core/light_patches.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/quantities.h"

namespace relume {
namespace {

constexpr double kMaxSolidAngle = 4.0 * kPi / 1024.0;
constexpr double kPatchesOfCone = 64.0;

TriangleCorners piece_corners(const Model& model, const SurfacePiece& piece) {
  const auto& triangle = model.occluders.triangles[piece.triangle];
  const glm::dvec3 p0 = model.occluders.positions[triangle[0]];
  const glm::dvec3 edge_u = glm::dvec3(model.occluders.positions[triangle[1]]) - p0;
  const glm::dvec3 edge_v = glm::dvec3(model.occluders.positions[triangle[2]]) - p0;
  TriangleCorners corners;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec2 at(piece.corners[k]);
    corners[k] = p0 + edge_u * at.x + edge_v * at.y;
  }
  return corners;
}

}  // namespace

std::uint32_t element_key(const SurfaceElement& element) {
  std::uint32_t key = 0;
  for (const glm::vec3& v : {element.position, element.normal}) {
    for (int k = 0; k < 3; ++k) key = patch_key(key, std::bit_cast<std::uint32_t>(v[k]));
  }
  return key;
}

double area_of(const TriangleCorners& corners) {
  return 0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
}

LightPatch whole_piece(const Model& model, const System& system, const SurfaceElement& element,
                       std::uint32_t piece_of_element) {
  const SurfacePiece& piece = system.pieces[element.first_piece + piece_of_element];
  const auto& triangle = model.occluders.triangles[piece.triangle];
  const glm::dvec3 p0 = model.occluders.positions[triangle[0]];
  const glm::dvec3 edge_u = glm::dvec3(model.occluders.positions[triangle[1]]) - p0;
  const glm::dvec3 edge_v = glm::dvec3(model.occluders.positions[triangle[2]]) - p0;
  LightPatch whole;
  whole.corners = piece_corners(model, piece);
  const glm::dvec3 cross = glm::cross(edge_u, edge_v);
  const double length = glm::length(cross);
  const Side side = system.clusters[element.cluster].side;
  whole.normal =
      (length > 0.0 ? cross / length : glm::dvec3(0.0, 1.0, 0.0)) * (side == Side::front ? 1.0 : -1.0);
  whole.key = patch_key(element_key(element), piece_of_element);
  return whole;
}

int patch_rows(double piece_area, double element_area, double patches_per_element) {
  const double wanted = patches_per_element * piece_area / element_area;
  return std::clamp(static_cast<int>(std::lround(std::sqrt(wanted))), 1, kMaxPatchRows);
}

LightPatch patch_of_piece(const LightPatch& piece, int rows, int index) {
  int row = 0, left = index;
  while (left >= 2 * (rows - row) - 1) left -= 2 * (rows - row++) - 1;
  const int column = left / 2;
  const glm::dvec3 along = (piece.corners[1] - piece.corners[0]) / double(rows);
  const glm::dvec3 across = (piece.corners[2] - piece.corners[0]) / double(rows);
  const glm::dvec3 corner = piece.corners[0] + along * double(column) + across * double(row);
  LightPatch patch = piece;
  patch.key = patch_key(piece.key, static_cast<std::uint32_t>(index));
  patch.corners = {corner, corner + along, corner + across};
  if (left % 2 != 0) patch.corners = {corner + along + across, corner + across, corner + along};
  return patch;
}

std::size_t count_element_patches(const Model& model, const System& system, const SurfaceElement& element) {
  std::size_t count = 0;
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    const TriangleCorners corners = piece_corners(model, system.pieces[element.first_piece + p]);
    const int rows = patch_rows(area_of(corners), element.area);
    count += std::size_t(rows * rows);
  }
  return count;
}

std::vector<LightPatch> element_patches(const Model& model, const System& system,
                                        const SurfaceElement& element) {
  std::vector<LightPatch> patches;
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    const LightPatch piece = whole_piece(model, system, element, p);
    const int rows = patch_rows(area_of(piece.corners), element.area);
    for (int index = 0; index < rows * rows; ++index) patches.push_back(patch_of_piece(piece, rows, index));
  }
  return patches;
}

ElementPatches own_patches(const Model& model, const System& system, const SurfaceElement& element,
                           std::size_t first_patch, double patches_per_element) {
  ElementPatches out;
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    out.pieces.push_back({whole_piece(model, system, element, p)});
    ElementPatches::Piece& piece = out.pieces.back();
    piece.rows = patch_rows(area_of(piece.whole.corners), element.area);
    for (int index = 0; index < piece.rows * piece.rows; ++index) {
      if (owns_patch(system, first_patch + out.stored_count++)) out.patches.push_back({p, index});
    }
  }
  out.lost_some = out.patches.size() < out.stored_count;
  if (out.lost_some || patches_per_element >= kPatchesPerElement) return out;
  out.patches.clear();
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    ElementPatches::Piece& piece = out.pieces[p];
    piece.rows = patch_rows(area_of(piece.whole.corners), element.area, patches_per_element);
    for (int index = 0; index < piece.rows * piece.rows; ++index) out.patches.push_back({p, index});
  }
  return out;
}

glm::dvec3 patch_point(const LightPatch& patch) {
  const std::uint32_t bits = patch_key(patch.key, 4);
  const double u = (double(bits >> 16) + 0.5) / 65536.0, v = (double(bits & 0xffffu) + 0.5) / 65536.0;
  // Uniform in the triangle (E. Heitz, A Low-Distortion Map Between Triangle and Square, 2019).
  const double s = v > u ? 0.5 * u : u - 0.5 * v, t = v > u ? v - 0.5 * u : 0.5 * v;
  return patch.corners[0] + (patch.corners[1] - patch.corners[0]) * s +
         (patch.corners[2] - patch.corners[0]) * t;
}

LightPatch quarter_of_patch(const LightPatch& patch, std::uint32_t child) {
  const auto& [a, b, c] = patch.corners;
  const glm::dvec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
  const std::array<TriangleCorners, 4> corners{{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
  return {corners[child], patch.normal, patch_key(patch.key, child)};
}

double max_patch_solid_angle(const Light& light) {
  if (light.type != LightType::spot) return kMaxSolidAngle;
  return std::min(kMaxSolidAngle, 2.0 * kPi * (1.0 - std::cos(light.outer_cone_angle)) / kPatchesOfCone);
}

std::size_t patch_count(const Model& model, const System& system) {
  std::size_t count = 0;
  for (const SurfaceElement& element : system.elements) {
    for (std::uint32_t p = 0; p < element.piece_count; ++p) {
      const int rows = patch_rows(area_of(whole_piece(model, system, element, p).corners), element.area);
      count += std::size_t(rows * rows);
    }
  }
  return count;
}

}  // namespace relume
