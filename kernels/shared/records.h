// SPDX-License-Identifier: MIT
//
// Push constants and records that cross between host and device.
#ifndef RELUME_KERNELS_RECORDS_H
#define RELUME_KERNELS_RECORDS_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

/// Push constants of every kernel. Row kernels do rows [first_row, first_row + count) of a block; the others
/// do elements [0, count).
struct Range {
  uint first_row;  // in the block; start, residual, restrict_rooms: sender 0 of the system in its other half;
                   // correct_rooms: bits of the largest radiosity
  uint count;  // rows, imports, clusters or nodes; restrict_rooms: number of the system; solve_rooms: number
               // of systems
  uint block_row;  // row of the matrix that is row 0 of the block; directions: the first moment of that row
                   // among the elements of a lighting; nodes: senders from a lighting to the next; residual:
                   // number of the system; restrict_rooms: its first segment; solve_rooms: number of rooms;
                   // correct_rooms: cluster of all systems that is its cluster 0
  uint first_sender;  // sender 0 of the system in the half that is written, as all senders here of lighting
                      // 0; nodes: counted from its half 0; residual: in the half that counts; directions:
                      // number of rows of the block
  // ---- 16 bytes
};

/// What a bounce changed, as maxima over the clusters of a system, per channel in xyz. Bits of non-negative
/// floats: they order as the floats do, so that atomicMax gives the same result in any order, and NaN is
/// above all numbers.
struct ResidualRecord {
  uvec4 weighted_change;  // |change| / weight
  // ---- 16 bytes
  uvec4 change;  // |change|, lm/m2
  // ---- 32 bytes
  uvec4 weighted_radiosity;  // |B| / weight, B after the bounce
  // ---- 48 bytes
  uvec4 radiosity;  // |B|, lm/m2
  // ---- 64 bytes
};

RELUME_SHARED_END

#ifdef __cplusplus
#include <cstddef>
namespace relume::kernels {
static_assert(sizeof(Range) == 16);
static_assert(sizeof(ResidualRecord) == 64);
static_assert(offsetof(ResidualRecord, change) == 16 && offsetof(ResidualRecord, radiosity) == 48);
}  // namespace relume::kernels
#endif

#endif
