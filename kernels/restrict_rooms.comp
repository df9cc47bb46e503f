// SPDX-License-Identifier: MIT
//
// What the clusters of a segment, all of one room and one system, send to a room: of the reflected (a coefficient of
// C) and of what the last bounce changed (a part of d). A workgroup a segment; lanes add up strided, then in a tree.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/fetch.glsl"
#include "include/rooms.glsl"

layout(set = kSolveSet, binding = kRadiosityTexelsBinding) uniform samplerBuffer radiosity_texels;
layout(set = kSystemSet, binding = kAlbedoTexelsBinding) uniform samplerBuffer albedo_texels;
layout(set = kBlockSet, binding = kRoomEntryTexelsBinding) uniform usamplerBuffer entry_texels;

shared vec4 reflected_of[kWorkgroupSize];
shared vec4 changed_of[kWorkgroupSize];

uvec2 entry_at(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(entry_texels, int(index)).xy;
  return entries[index];
}

vec3 albedo_at(uint cluster) {
  if (kFetch == kFetchTexels) return texelFetch(albedo_texels, int(cluster)).rgb;
  return albedo[cluster].rgb;
}

vec3 radiosity_at(uint sender) {
  if (kFetch == kFetchTexels) return texelFetch(radiosity_texels, int(sender)).rgb;
  return radiosity[sender].rgb;
}

void main() {
  const uint lane = gl_LocalInvocationIndex;
  const uvec4 segment = segments[range.block_row + gl_WorkGroupID.x];
  const uint after = in_lighting(range.first_sender), before = in_lighting(range.first_row);
  precise vec3 reflected = vec3(0.0), changed = vec3(0.0);
  for (uint i = segment.x + lane; i < segment.x + segment.y; i += kWorkgroupSize) {
    const uvec2 entry = entry_at(i);
    const float weight = uintBitsToFloat(entry.y);
    precise vec3 change = radiosity_at(after + entry.x) - radiosity_at(before + entry.x);
    precise vec3 term = weight * albedo_at(entry.x);
    reflected = reflected + term;
    term = weight * change;
    changed = changed + term;
  }
  reflected_of[lane] = vec4(reflected, 0.0);
  changed_of[lane] = vec4(changed, 0.0);
  for (uint half_size = kWorkgroupSize / 2u; half_size > 0u; half_size /= 2u) {
    memoryBarrierShared();
    barrier();
    if (lane < half_size) {
      reflected_of[lane] = reflected_of[lane] + reflected_of[lane + half_size];
      changed_of[lane] = changed_of[lane] + changed_of[lane + half_size];
    }
  }
  if (lane > 0u) return;
  const uint sums = pair_sums(range.count, segment.z, segment.w);
  room_sums[sums] = reflected_of[0];
  room_sums[sums + 1u] = changed_of[0];
}
