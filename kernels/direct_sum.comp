// SPDX-License-Identifier: MIT
//
// H of elements: intensities times shares, light by light in their order. Two blocks a workgroup.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/direct_light.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x / kBlockElements;
  const uint lane = gl_GlobalInvocationID.x % kBlockElements;
  if (place >= range.count) return;
  const uint at = range.sum_jobs + 4u * (range.first + place);
  const SumJob job = SumJob(work[at], work[at + 1u], work[at + 2u], 0u);
  if (lane >= tables[2u * job.block + 1u]) return;
  precise vec3 sum = vec3(0.0);
  for (uint pair = job.first_pair; pair < job.first_pair + job.pair_count; ++pair) {
    const uint slot = work[range.pairs + 2u * pair], light = work[range.pairs + 2u * pair + 1u];
    precise vec3 term = lights[light].intensity.rgb * shares[slot * kBlockElements + lane];
    sum = sum + term;
  }
  element_light[tables[2u * job.block] + lane] = vec4(sum, 0.0);
}
