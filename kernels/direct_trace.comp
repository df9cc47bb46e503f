// SPDX-License-Identifier: MIT
//
// What a light gives the elements of a block for an intensity of 1: a workgroup per job. Patches are spread
// over all invocations, 64 at a time; then each element adds up its own, in order.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/light_patch.glsl"

shared float patch_flux[kWorkgroupSize];

/// `arriving` < 0: by shadow rays, else it is the share that arrives.
float flux_of_patch(LightRecord light, uint index, float arriving) {
  const LightPiece piece = pieces[patches[index] >> 4];
  const uint flags = floatBitsToUint(piece.a.w);
  if ((flags & kPieceSensor) != 0u) return sensor_share(light, piece.a.xyz, piece.normal.xyz, arriving);
  const Patch whole = patch_of_piece(piece, patches[index] & 15u);
  return flux_share(light, whole, piece.normal.xyz, (flags & kPieceUncut) != 0u ? 0u : kMaxPatchCuts, arriving);
}

void main() {
  const uint at = 4u * (range.first + gl_WorkGroupID.x);
  const TraceJob job = TraceJob(work[at], work[at + 1u], work[at + 2u], work[at + 3u]);
  const LightRecord light = lights[job.light];
  const uint first_element = tables[2u * job.block], element_count = tables[2u * job.block + 1u];
  const uint first_patch = elements[first_element].first_patch;
  const LightElement last = elements[first_element + element_count - 1u];
  const uint end_patch = last.first_patch + last.patch_count;
  const uint lane = gl_LocalInvocationIndex;
  LightElement own = elements[first_element + min(lane, element_count - 1u)];
  const uint own_end = lane < element_count ? own.first_patch + own.patch_count : own.first_patch;
  const bool masked = (job.flags & kJobMask) != 0u;

  precise float sum = 0.0;
  for (uint chunk = first_patch; chunk < end_patch; chunk += kWorkgroupSize) {
    const uint index = chunk + lane;
    float flux = 0.0;
    if (index < end_patch) {
      flux = flux_of_patch(light, index, masked ? 1.0 : -1.0);
    }
    patch_flux[lane] = flux;
    memoryBarrierShared();
    barrier();
    const uint begin = max(own.first_patch, chunk);
    const uint end = min(own_end, chunk + kWorkgroupSize);
    for (uint i = begin; i < end; ++i) sum = sum + patch_flux[i - chunk];
    memoryBarrierShared();
    barrier();
  }
  if (lane >= element_count) return;
  if (masked) sum = sum * visibility[job.light * range.cluster_count + own.cluster];
  shares[job.slot * kBlockElements + lane] = sum * own.inverse_area;
}
