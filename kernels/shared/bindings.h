// SPDX-License-Identifier: MIT
//
// Descriptor sets, bindings and specialization constants. All kernels share one pipeline layout. In each set,
// storage buffers come first; uniform texel buffers, which are views of some of them, follow.
//
// The senders of a system are its clusters, then the nodes of its tree; those of the sky, its patches, then
// their nodes. They lie together in one buffer, twice for a system, which reads one half and writes the
// other; where, a table says, so that import tables need not know which systems are loaded.
//
// Of several lightings (include/lightings.glsl), radiosity, residuals, irradiance, exitance, direct, probe
// coefficients and room sums are in planes, one lighting after the other: what is said of their elements here
// is said of a plane.
#ifndef RELUME_KERNELS_BINDINGS_H
#define RELUME_KERNELS_BINDINGS_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

/// Set of the whole solve.
const uint kSolveSet = 0u;
const uint kRadiosityBinding = 0u;  // vec4 per sender of every half: b, lm/m2 in rgb
const uint kFirstSenderBinding =
    1u;  // uint per system, then of the sky: sender 0 in the half that counts, or kNotLoaded
const uint kResidualBinding = 2u;  // ResidualRecord per system
const uint kSolveBindings = 3u;
const uint kRadiosityTexelsBinding = 3u;    // rgba32f
const uint kFirstSenderTexelsBinding = 4u;  // r32ui
const uint kSolveTexelBindings = 2u;

/// First sender of a system that is not there: black.
const uint kNotLoaded = 0xffffffffu;

/// Set of one system, or of the sky.
const uint kSystemSet = 1u;
// uvec4 per import: number of the system (that of the sky is the number of systems), index of the sender,
// bits of its share, and 0 or where in this buffer the next part is. A sender of a system or of the sky has
// one part, of share 1; a node above the systems several, of which all but the first follow the imports.
const uint kImportsBinding = 0u;
const uint kLocalRadiosityBinding = 1u;  // vec4, or as kHalfSendersConstant says four halves in a uvec2, per
                                         // import and lighting of it: b of the sender
                                         // (include/local_radiosity.glsl)
const uint kIrradianceBinding = 2u;  // vec4 per gather row: I, lm/m2; where the gather matrix has directions,
                                     // then three vec4 per row: D along x, y, z
const uint kAlbedoBinding = 3u;      // vec4 per cluster
const uint kExitanceBinding = 4u;    // vec4 per cluster, lm/m2
const uint kDirectBinding = 5u;      // vec4 per cluster: H, lm/m2
const uint kWeightsBinding = 6u;     // vec4 per cluster: v of the contraction bound, > 0
// uvec4 per node: first of its parts, number of parts, number of the node among the senders of its system, 0.
const uint kNodesBinding = 7u;
const uint kNodePartsBinding = 8u;  // uvec2 per part of every node: sender of the system, bits of its share
const uint kOwnRadiosityBinding =
    9u;  // vec4 per sender of both halves of the system: its part of kRadiosityBinding, for what reads and
         // writes nodes of several systems side by side
const uint kSystemBindings = 10u;
const uint kImportTexelsBinding = 10u;          // rgba32ui
const uint kLocalRadiosityTexelsBinding = 11u;  // rgba32f or rgba16f
const uint kAlbedoTexelsBinding = 12u;          // rgba32f, as the two that follow
const uint kExitanceTexelsBinding = 13u;
const uint kDirectTexelsBinding = 14u;
const uint kNodeTexelsBinding = 15u;          // rgba32ui
const uint kNodePartTexelsBinding = 16u;      // rg32ui
const uint kOwnRadiosityTexelsBinding = 17u;  // rgba32f
const uint kSystemTexelBindings = 8u;

/// Set of one block of a bounce or gather matrix, in the format of core/block_matrix.h, or of the light
/// probes of a system.
const uint kBlockSet = 2u;
const uint kTileOffsetsBinding = 0u;  // uint per tile, and one at the end
const uint kColumnsBinding = 1u;      // two 16-bit columns in a uint, the first in the low half
const uint kValuesBinding = 2u;  // f32: a float's bits in a uint; unorm16, sqrt8: two, four codes, as columns
const uint kRowScalesBinding = 3u;  // float per row; of blocks with directions, then a uint per value
                                    // (core/packed_direction.h)
const uint kBlockBindings = 4u;
const uint kColumnTexelsBinding = 4u;  // r32ui
const uint kValueTexelsBinding = 5u;   // r32ui
const uint kCodeTexelsBinding =
    6u;  // the values; of tiles of eight rows, unorm16 and f32 as rgba32ui, sqrt8 as rg32ui
const uint kTileOffsetTexelsBinding = 7u;  // r32ui
const uint kRowScaleTexelsBinding = 8u;    // r32f
const uint kBlockTexelBindings = 5u;

/// The same set for light probes (core/probe_coefficients.h).
const uint kProbeListsBinding = 0u;    // three uints per probe: first entry among the senders, their end,
                                       // number of the probe among those of all systems
const uint kProbeSendersBinding = 1u;  // ProbeSender of core/model.h: 5 uints each
const uint kProbeCoefficientsBinding =
    2u;  // kProbeHarmonics vec4 per probe of all systems: cd/m2 sr^1/2 in rgb
const uint kProbeBindings = 3u;
const uint kProbeListUints = 3u;
const uint kProbeSenderUints = 5u;
const uint kProbeHarmonics = 9u;

/// The same set for the level above the bounces (core/methods/room_correction.h). A segment is the clusters
/// of one system and one room, or in no room, that one room sees.
const uint kRoomSegmentsBinding =
    0u;  // uvec4 per segment: first entry, number of entries, room that sees them, their own room or kNoRoom
const uint kRoomEntriesBinding =
    1u;  // uvec2 per entry: cluster of the system, bits of its weight / area of the room
const uint kRoomOfClusterBinding = 2u;  // uint per cluster of all systems: its room or kNoRoom
// vec4: irradiance of kMaxRooms rooms, lm/m2; then per system, room that sees and room that is seen
// (kMaxRooms: none) the sums over the entries of weight x albedo and of weight x change, lm/m2; 0 where there
// is no segment.
const uint kRoomSumsBinding = 3u;
const uint kRoomBindings = 4u;
const uint kRoomEntryTexelsBinding = 6u;  // rg32ui

const uint kNoRoom = 0xffffffffu;

const uint kSets = 3u;

/// Specialization constant: the ValueCodec of core/block_matrix.h.
const uint kCodecConstant = 0u;
const uint kCodecF32 = 0u;
const uint kCodecUnorm16 = 1u;
const uint kCodecSqrt8 = 2u;

/// Specialization constant: where row products, and what they need, are read from.
const uint kFetchConstant = 1u;
const uint kFetchStorage = 0u;  // storage buffers
const uint kFetchTexels = 1u;   // texel buffers

/// Specialization constant: rows of a tile, 1 or 8.
const uint kTileRowsConstant = 2u;

/// Specialization constants: whether imports are kept in half precision, and what times, a float.
const uint kHalfSendersConstant = 3u;
const uint kSenderScaleConstant = 4u;

/// Specialization constant: lightings at once, 1 to kMaxLightings (include/lightings.glsl).
const uint kLightingsConstant = 5u;

RELUME_SHARED_END

#endif
