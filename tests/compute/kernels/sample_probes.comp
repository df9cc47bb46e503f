// SPDX-License-Identifier: MIT
//
// What a renderer's shader would see of light probes, at given points and normals.
#version 450
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 8) in;

layout(set = 0, binding = 0, std430) readonly buffer Places {
  vec4 places[];  // per place: point, normal
};
layout(set = 0, binding = 1, std430) readonly buffer Volume {
  uint volume[];
};
layout(set = 0, binding = 2, std430) readonly buffer Coefficients {
  vec4 coefficients[];
};
layout(set = 0, binding = 3, std430) writeonly buffer Answers {
  vec4 answers[];  // per place: irradiance; 1 where some probe sees it
};

#define RELUME_PROBE_VOLUME(i) volume[i]
#define RELUME_PROBE_COEFFICIENTS(i) coefficients[i]
#include "../../../kernels/include/relume_sample_probes.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const RelumeProbes near = relume_find_probes(places[2u * i].xyz);
  answers[2u * i] = vec4(relume_probe_irradiance(near, places[2u * i + 1u].xyz), 0.0);
  answers[2u * i + 1u] = vec4(near.covered ? 1.0 : 0.0);
}
