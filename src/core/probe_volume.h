// SPDX-License-Identifier: MIT
//
// Where light probes stand for the light between them: a tree of boxes, cells, with a probe at each corner,
// and for each corner the part of its cell that it speaks for. A point takes the probes of its cell by
// trilinear weights, but none of a probe that a wall hides: planes cut off what a corner does not see, and
// towards them its weight fades to 0. Beyond a wall, weights are 0 to the last bit.
//
// kernels/include/relume_sample_probes.glsl does the same on a device, from probe_volume_words().
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace relume {

inline constexpr std::uint32_t kNoProbe = 0xffffffffu;

/// A leaf of the tree. Corner c lies at the upper end in x, y, z where bit 0, 1, 2 of c is set. Stored.
struct ProbeCell {
  std::array<std::uint32_t, 8> probes{};  ///< per corner: Probe::name, or kNoProbe where none is to be used
  /// Per corner: it counts only where the distance to plane p is positive (bit p) or negative (bit 8 + p).
  std::array<std::uint16_t, 8> sides{};
  std::uint32_t first_plane = 0;
  std::uint32_t plane_count = 0;  ///< at most kMaxCellPlanes
};
static_assert(sizeof(ProbeCell) == 56);

inline constexpr std::uint32_t kMaxCellPlanes = 8;
inline constexpr std::uint32_t kMaxProbeDepth = 24;

/// An entry of ProbeVolume::nodes: a cell (this bit and its index), nothing (kNoProbe), or two halves: the
/// axis across which they lie, 0 to 2, from bit kProbeAxisShift on, and in the bits below the index of the
/// lower one, which lies further on; the upper one follows it.
inline constexpr std::uint32_t kProbeCellBit = 0x80000000u;
inline constexpr std::uint32_t kProbeAxisShift = 29;
inline constexpr std::uint32_t kProbeChildMask = (1u << kProbeAxisShift) - 1u;

/// Positions are metres relative to Model::origin. Empty (without nodes) where probes are only points.
struct ProbeVolume {
  glm::vec3 lower{0.0f};
  glm::vec3 edges{0.0f};                  ///< m, of the root cells
  std::array<std::uint32_t, 3> counts{};  ///< of root cells along x, y, z
  std::vector<std::uint32_t> nodes;       ///< first the root cells, x fastest, then y
  std::vector<ProbeCell> cells;
  std::vector<glm::vec4> planes;  ///< distance of a point: dot(xyz, point) + w; xyz of unit length
};

/// Towards a plane, weights fade over this share of the cell's width in the direction of its normal.
inline constexpr float kProbeFade = 0.25f;
/// What a corner is worth at least before planes, so that those opposite help where the near ones see
/// nothing.
inline constexpr float kLeastCornerWeight = 1e-3f;

/// What each corner of a cell counts for at a point; `within`: where it lies in the cell, 0 to 1; `edges`:
/// m. They need not add up to 1. `planes`: those of the cell.
std::array<float, 8> corner_weights(const ProbeCell& cell, std::span<const glm::vec4> planes,
                                    const glm::vec3& edges, const glm::vec3& point, const glm::vec3& within);

struct WeightedProbes {
  std::array<std::uint32_t, 8> probes{};  ///< Probe::name; kNoProbe has no weight
  std::array<float, 8> weights{};         ///< add up to 1, or all 0 where no probe sees the point
};

/// The probes that speak for a point (metres relative to Model::origin). Outside the volume it is that of the
/// nearest cell. A point of a surface is to be lifted off it, to the side that is asked about.
WeightedProbes probes_at(const ProbeVolume& volume, const glm::vec3& point);

/// The volume as a device reads it (relume_sample_probes.glsl): kProbeVolumeHeader words (lower, edges,
/// counts, first word of the cells, first word of the planes, 0), then nodes, cells (14 words) and planes
/// (4), floats as their bits. Empty without nodes.
std::vector<std::uint32_t> probe_volume_words(const ProbeVolume& volume);
inline constexpr std::uint32_t kProbeVolumeHeader = 12;

}  // namespace relume
