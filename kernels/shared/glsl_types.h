// SPDX-License-Identifier: MIT
//
// The headers of this folder are read by GLSL and by C++. They use uint, float, vec4 and uvec4 only: never
// vec3, whose size differs.
#ifndef RELUME_KERNELS_GLSL_TYPES_H
#define RELUME_KERNELS_GLSL_TYPES_H

#ifdef __cplusplus
#include <cstdint>

#define RELUME_SHARED_BEGIN namespace relume::kernels {
#define RELUME_SHARED_END }
#define RELUME_SHARED_FUNCTION inline

namespace relume::kernels {
using uint = std::uint32_t;
struct vec4 {
  float x, y, z, w;
};
struct uvec4 {
  uint x, y, z, w;
};
static_assert(sizeof(vec4) == 16 && sizeof(uvec4) == 16);
}  // namespace relume::kernels
#else
#define RELUME_SHARED_BEGIN
#define RELUME_SHARED_END
#define RELUME_SHARED_FUNCTION
#endif

#endif
