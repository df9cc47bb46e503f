// SPDX-License-Identifier: MIT
//
// Where direct light is sampled: the triangles that surface elements are cut into, each with a point of its
// own for a shadow ray. Whoever computes direct irradiance, on whatever device, uses these.
//
// Element: each of its pieces is cut into rows of congruent triangles, about kPatchesPerElement of them in
// all, or fewer where whoever asks wants fewer rays. Light: a patch that looks large from it is cut in four
// again and again (max_patch_solid_angle), so that shadows and cones close to a light are met. The flux that
// a patch receives is its solid angle as the light sees it times the share of the light that reaches its
// point; H of the element is the sum over its patches over their area.
//
// A patch belongs to its element (System::own_patches) when it lies on the same side of all walls as the
// element's middle; others, of a lumel that a wall runs through, are left out. An element that lost patches
// has all that are left, however few were asked for, and none of them cut again, because a part of one may
// lie beyond the wall.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "core/light.h"
#include "core/model.h"

namespace relume {

inline constexpr double kPatchesPerElement = 16.0;
inline constexpr int kMaxPatchRows = 4;
inline constexpr int kMaxPatchCuts = 5;

using TriangleCorners = std::array<glm::dvec3, 3>;

/// A triangle cut out of the surface, about the origin of the model.
struct LightPatch {
  TriangleCorners corners{};
  glm::dvec3 normal{0.0};  ///< unit, towards the receiving side
  std::uint32_t key = 0;   ///< of its random point
};

/// 32 well-mixed bits from two numbers (the finaliser that C. Wellons found by search, 2018).
constexpr std::uint32_t patch_key(std::uint32_t a, std::uint32_t b) {
  std::uint32_t x = a + 0x9e3779b9u * (b + 1);
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/// Of position and normal: whatever system the element is in, the same place has the same points.
std::uint32_t element_key(const SurfaceElement& element);

double area_of(const TriangleCorners& corners);

/// A piece before it is cut: its key is that of the element and the number of the piece in it.
LightPatch whole_piece(const Model& model, const System& system, const SurfaceElement& element,
                       std::uint32_t piece_of_element);

/// The piece is cut into the square of so many patches.
int patch_rows(double piece_area, double element_area, double patches_per_element = kPatchesPerElement);

/// Patch number `index` of rows * rows.
LightPatch patch_of_piece(const LightPatch& piece, int rows, int index);

/// All patches of an element, piece by piece, those that do not belong to it included.
std::vector<LightPatch> element_patches(const Model& model, const System& system,
                                        const SurfaceElement& element);
/// How many those are.
std::size_t count_element_patches(const Model& model, const System& system, const SurfaceElement& element);

/// What direct light of an element is sampled by.
struct ElementPatches {
  struct Piece {
    LightPatch whole;
    int rows = 1;
  };
  struct Patch {
    std::uint32_t piece = 0;  ///< of the element
    int index = 0;            ///< in its piece: patch_of_piece()
  };
  std::vector<Piece> pieces;
  std::vector<Patch> patches;    ///< those that belong to the element
  bool lost_some = false;        ///< others do not
  std::size_t stored_count = 0;  ///< of the bits that the element has in System::own_patches
};

/// About `patches_per_element` of them, at most kPatchesPerElement. `first_patch`: its first bit in
/// System::own_patches.
ElementPatches own_patches(const Model& model, const System& system, const SurfaceElement& element,
                           std::size_t first_patch, double patches_per_element = kPatchesPerElement);

/// A random point inside, the same at each call.
glm::dvec3 patch_point(const LightPatch& patch);

/// Its children by halves of edges.
LightPatch quarter_of_patch(const LightPatch& patch, std::uint32_t child);

/// Patches that look larger from a point or spot light (sr) are cut again.
double max_patch_solid_angle(const Light& light);

/// Bit i of System::own_patches; an empty list means that all belong.
inline bool owns_patch(const System& system, std::size_t patch) {
  return system.own_patches.empty() || (system.own_patches[patch / 32] >> patch % 32 & 1u) != 0;
}

/// Patches of all elements of a system.
std::size_t patch_count(const Model& model, const System& system);

}  // namespace relume
