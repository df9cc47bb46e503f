// SPDX-License-Identifier: MIT
//
// Descriptor sets, bindings and specialization constants. All kernels share one pipeline layout. In each set,
// storage buffers come first; uniform texel buffers, which are views of some of them, follow.
//
// Senders are numbered through: the clusters of all systems, system by system, then the sky patches.
#ifndef RELUME_KERNELS_BINDINGS_H
#define RELUME_KERNELS_BINDINGS_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

/// Set of the whole solve. There are two: radiosity in and out are swapped in the second.
const uint kSolveSet = 0u;
const uint kRadiosityInBinding = 0u;   // vec4 per sender: b, lm/m2 in rgb
const uint kRadiosityOutBinding = 1u;  // vec4 per sender
const uint kAlbedoBinding = 2u;        // vec4 per cluster
const uint kExitanceBinding = 3u;      // vec4 per cluster, lm/m2
const uint kDirectBinding = 4u;        // vec4 per cluster: H, lm/m2
const uint kWeightsBinding = 5u;       // vec4 per cluster: v of the contraction bound, > 0
const uint kResidualBinding = 6u;      // one ResidualRecord
const uint kSolveBindings = 7u;

/// Set of one system.
const uint kSystemSet = 1u;
// uvec4 per import: first leaf, number of leaves, first of their shares, 0; of a node above the systems:
// first of its ranges in this buffer, 0, 0, number of ranges. Ranges follow the imports: first leaf, number
// of leaves, first of their shares, 0.
const uint kImportsBinding = 0u;
const uint kLocalRadiosityBinding = 1u;  // vec4 per import: b of the sender
const uint kIrradianceBinding = 2u;      // vec4 per gather row of the system: I, lm/m2
const uint kImportSharesBinding =
    3u;  // float per leaf of an import that is a node: what it counts for in the mean
const uint kSystemBindings = 4u;
const uint kLocalRadiosityTexelsBinding = 4u;  // rgba32f
const uint kSystemTexelBindings = 1u;

/// Set of one block of a bounce or gather matrix, in the format of core/block_matrix.h.
const uint kBlockSet = 2u;
const uint kTileOffsetsBinding = 0u;  // uint per tile, and one at the end
const uint kColumnsBinding = 1u;      // two 16-bit columns in a uint, the first in the low half
const uint kValuesBinding = 2u;  // f32: a float's bits in a uint; unorm16, sqrt8: two, four codes, as columns
const uint kRowScalesBinding = 3u;  // float per row
const uint kBlockBindings = 4u;
const uint kColumnTexelsBinding = 4u;  // r32ui
const uint kValueTexelsBinding = 5u;   // r32ui
const uint kBlockTexelBindings = 2u;

const uint kSets = 3u;

/// Specialization constant: the ValueCodec of core/block_matrix.h.
const uint kCodecConstant = 0u;
const uint kCodecF32 = 0u;
const uint kCodecUnorm16 = 1u;
const uint kCodecSqrt8 = 2u;

/// Specialization constant: where row products read from.
const uint kFetchConstant = 1u;
const uint kFetchStorage = 0u;  // storage buffers
const uint kFetchTexels = 1u;   // texel buffers

/// Specialization constant: rows of a tile, 1 or 8.
const uint kTileRowsConstant = 2u;

RELUME_SHARED_END

#endif
