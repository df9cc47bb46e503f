// SPDX-License-Identifier: MIT
//
// Points on a surface piece at which textures are looked up for its mean colour.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>

#include "core/model.h"

namespace relume {

/// Barycentric coordinates, as SurfacePiece.
using PieceCorners = std::array<glm::vec2, 3>;

/// How many points a piece needs that covers so many texels of its image: 16 to 256, 8 per texel in between.
std::uint32_t piece_sample_count(double texels);

/// Point i of the R2 sequence (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018),
/// folded into the piece: barycentric coordinates in the triangle.
glm::dvec2 piece_sample(std::uint32_t i, const PieceCorners& corners);

/// Share of its triangle that a piece covers: twice its area in barycentric coordinates.
double piece_share(const PieceCorners& corners);

/// m2.
double triangle_area(const Occluders& occluders, std::uint32_t triangle);

}  // namespace relume
