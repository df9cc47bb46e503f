// SPDX-License-Identifier: MIT
//
// Bindings and records of direct light (compute/direct_light.h): one descriptor set, storage buffers first.
// Positions are metres about the origin of the model.
#ifndef RELUME_KERNELS_DIRECT_LIGHT_H
#define RELUME_KERNELS_DIRECT_LIGHT_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

const uint kBvhNodesBinding = 0u;  // 4 uvec4 per node: BvhNode of core/occluder_bvh.h
const uint kBvhTrianglesBinding =
    1u;  // 3 uvec4 per triangle, in leaf order: bits of corners; w of the first: OpacityTriangle + 1, or 0
const uint kOpacityBinding = 2u;        // uints: see OpacityTable
const uint kPiecesBinding = 3u;         // LightPiece
const uint kPatchesBinding = 4u;        // uint per patch: number of the piece << 4 | number in it
const uint kElementsBinding = 5u;       // LightElement
const uint kTablesBinding = 6u;         // uints: see TableLayout
const uint kLightsBinding = 7u;         // LightRecord
const uint kWorkBinding = 8u;           // uints: TraceJob, then SumJob, then two of each pair: slot, light
const uint kSharesBinding = 9u;         // float per slot and element of its block
const uint kElementLightBinding = 10u;  // vec4 per element: H, lm/m2
const uint kClusterLightBinding = 11u;  // vec4 per cluster: H, lm/m2
const uint kGatherLightBinding = 12u;   // vec4 per gather row: H, lm/m2
const uint kVisibilityBinding = 13u;    // float per light and cluster: the host's mask
const uint kDirectLightBindings = 14u;
const uint kBvhNodeTexelsBinding = 14u;      // rgba32ui, as kBvhNodesBinding
const uint kBvhTriangleTexelsBinding = 15u;  // rgba32ui, as kBvhTrianglesBinding
const uint kDirectLightTexelBindings = 2u;

/// Specialization constant: where the tree is read from (bindings.h: storage or texels).
const uint kTreeFetchConstant = 0u;

/// Elements of a block, at most: the unit of what is traced, and of what is kept for each light.
const uint kBlockElements = 32u;

const uint kLightPoint = 0u;
const uint kLightSpot = 1u;
const uint kLightDirectional = 2u;

/// LightPiece::flags: rows of patches in the low bits, and
const uint kPieceUncut = 16u;   // its patches are not cut again
const uint kPieceSensor = 32u;  // a point: the first corner
const uint kPieceRowsMask = 15u;

/// TraceJob::flags
const uint kJobMask = 1u;  // visibility comes from the host's mask

struct LightRecord {
  vec4 position;   // xyz; w: range, m, 0 = none
  vec4 direction;  // xyz: unit, where it shines; w: type, as bits
  vec4 intensity;  // cd or lux
  vec4 cone;  // cosine of the outer angle, 1 / max(0.001, cos inner - cos outer), sine of the outer angle;
              // w: patches that look larger (sr) are cut
};

struct LightPiece {
  vec4 a;       // corner; w: flags, as bits
  vec4 b;       // corner; w: key, as bits
  vec4 c;       // corner
  vec4 normal;  // unit
};

struct LightElement {
  uint first_patch;
  uint patch_count;
  float inverse_area;  // 1 / m2 of its patches; 1 for a sensor
  float weight;        // its share of the area of its cluster; 0 for a sensor
  uint cluster;
  uint unused0;
  uint unused1;
  uint unused2;
};

struct TraceJob {
  uint block;
  uint light;
  uint slot;
  uint flags;
};

struct SumJob {
  uint block;
  uint first_pair;
  uint pair_count;
  uint unused;
};

/// Push constants of all kernels.
struct DirectLightRange {
  uint first;        // job, cluster or gather row
  uint count;        // of them
  uint sum_jobs;     // uint of the work buffer where sum jobs begin
  uint pairs;        // likewise the pairs
  uint clusters;     // uint of the tables: two per cluster: first element, number of elements
  uint gather_rows;  // likewise one per gather row: its element
  uint cluster_count;
  float offset;  // m, of points off their surface
  float far;     // m, length of rays to directional lights
  uint unused0;
  uint unused1;
  uint unused2;
  // ---- 48 bytes
};

RELUME_SHARED_END

#ifdef __cplusplus
namespace relume::kernels {
static_assert(sizeof(LightRecord) == 64 && sizeof(LightPiece) == 64 && sizeof(LightElement) == 32);
static_assert(sizeof(TraceJob) == 16 && sizeof(SumJob) == 16 && sizeof(DirectLightRange) == 48);
}  // namespace relume::kernels
#endif

#endif
