// SPDX-License-Identifier: MIT
//
// Light patches and what a light gives them: core/light_patches.h and core/light.h in single precision.
#ifndef RELUME_LIGHT_PATCH_GLSL
#define RELUME_LIGHT_PATCH_GLSL

#include "direct_light.glsl"
#include "shadow_ray.glsl"

const uint kMaxPatchCuts = 5u;

struct Patch {
  vec3 a, b, c;
  uint key;
};

uint light_type(LightRecord light) {
  return floatBitsToUint(light.direction.w);
}

uint patch_key(uint a, uint b) {
  uint x = a + 0x9e3779b9u * (b + 1u);
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

Patch patch_of_piece(LightPiece piece, uint index) {
  const uint rows = floatBitsToUint(piece.a.w) & kPieceRowsMask;
  uint row = 0u, left = index;
  while (left >= 2u * (rows - row) - 1u) {
    left -= 2u * (rows - row) - 1u;
    ++row;
  }
  const vec3 along = (piece.b.xyz - piece.a.xyz) / float(rows);
  const vec3 across = (piece.c.xyz - piece.a.xyz) / float(rows);
  const vec3 corner = piece.a.xyz + along * float(left / 2u) + across * float(row);
  const uint key = patch_key(floatBitsToUint(piece.b.w), index);
  if ((left & 1u) == 0u) return Patch(corner, corner + along, corner + across, key);
  return Patch(corner + along + across, corner + across, corner + along, key);
}

vec3 patch_point(Patch patch_) {
  const uint bits = patch_key(patch_.key, 4u);
  const float u = (float(bits >> 16) + 0.5) / 65536.0, v = (float(bits & 0xffffu) + 0.5) / 65536.0;
  const float s = v > u ? 0.5 * u : u - 0.5 * v, t = v > u ? v - 0.5 * u : 0.5 * v;
  return patch_.a + (patch_.b - patch_.a) * s + (patch_.c - patch_.a) * t;
}

Patch quarter_of_patch(Patch patch_, uint child) {
  const vec3 ab = 0.5 * (patch_.a + patch_.b), bc = 0.5 * (patch_.b + patch_.c), ca = 0.5 * (patch_.c + patch_.a);
  const uint key = patch_key(patch_.key, child);
  if (child == 0u) return Patch(patch_.a, ab, ca, key);
  if (child == 1u) return Patch(ab, patch_.b, bc, key);
  if (child == 2u) return Patch(ca, bc, patch_.c, key);
  return Patch(bc, ca, ab, key);
}

/// Patch number `path` of those after `depth` cuts: two bits a cut, the last lowest.
Patch patch_at(Patch patch_, uint path, uint depth) {
  for (uint level = depth; level-- > 0u;) patch_ = quarter_of_patch(patch_, (path >> (2u * level)) & 3u);
  return patch_;
}

/// sr (A. van Oosterom, J. Strackee, The Solid Angle of a Plane Triangle, 1983); the volume from edges, which
/// small triangles far away keep.
float solid_angle(vec3 from, Patch patch_) {
  const vec3 a = patch_.a - from, b = patch_.b - from, c = patch_.c - from;
  const float la = length(a), lb = length(b), lc = length(c);
  const float volume = abs(dot(a, cross(patch_.b - patch_.a, patch_.c - patch_.a)));
  const float denominator = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
  return volume > 0.0 ? 2.0 * atan(volume, denominator) : 0.0;
}

/// The share of its intensity that a point or spot light sends along `way`, from the light.
float intensity_share(LightRecord light, vec3 way) {
  const float distance = length(way);
  if (distance == 0.0) return 0.0;
  float share = 1.0;
  if (light.position.w > 0.0) {
    const float ratio = distance / light.position.w;
    share = clamp(1.0 - ratio * ratio * ratio * ratio, 0.0, 1.0);
  }
  if (light_type(light) != kLightSpot) return share;
  const float falloff =
      clamp((dot(way, light.direction.xyz) / distance - light.cone.x) * light.cone.y, 0.0, 1.0);
  return share * falloff * falloff;
}

/// False: neither cone nor range of a point or spot light reaches the ball around the patch.
bool may_reach(LightRecord light, Patch patch_) {
  const vec3 centre = (patch_.a + patch_.b + patch_.c) / 3.0;
  const float radius =
      1.0001 * max(length(patch_.a - centre), max(length(patch_.b - centre), length(patch_.c - centre)));
  const vec3 way = centre - light.position.xyz;
  const float distance = length(way);
  if (light.position.w > 0.0 && distance - radius >= light.position.w) return false;
  if (light_type(light) == kLightPoint) return true;
  const float along = dot(way, light.direction.xyz);
  const float across = sqrt(max(distance * distance - along * along, 0.0));
  return across * light.cone.x - along * light.cone.z <= radius + 1e-5 * distance;
}

/// The share of the light that reaches a surface point, from this far off it.
float lit_share(LightRecord light, vec3 point, vec3 normal) {
  const vec3 from = point + normal * range.offset;
  if (light_type(light) == kLightDirectional) {
    return shadow_transmittance(from, from - light.direction.xyz * range.far);
  }
  // The ray ends just before the light: a lamp on a surface is not blocked by it.
  const vec3 way = light.position.xyz - from;
  const float distance = length(way);
  const float gap = 4.0 * range.offset;
  if (distance <= gap) return 1.0;
  return shadow_transmittance(from, from + way * (1.0 - gap / distance));
}

/// Flux that a patch receives over the light's intensity; `arriving` < 0: by shadow rays, else it is the share that
/// arrives. A walk over the patches that it is cut into, without a stack.
float flux_share(LightRecord light, Patch whole, vec3 normal, uint max_cuts, float arriving) {
  const bool directional = light_type(light) == kLightDirectional;
  const float facing = directional ? -dot(light.direction.xyz, normal) : dot(light.position.xyz - whole.a, normal);
  if (facing <= 0.0) return 0.0;
  float sum = 0.0;
  uint depth = 0u, path = 0u;
  while (true) {
    const Patch part = patch_at(whole, path, depth);
    bool cut = false;
    if (directional || may_reach(light, part)) {
      const float size = directional ? facing * 0.5 * length(cross(part.b - part.a, part.c - part.a))
                                     : solid_angle(light.position.xyz, part);
      cut = !directional && depth < max_cuts && size > light.cone.w;
      if (!cut) {
        const vec3 point = patch_point(part);
        const float share = directional ? 1.0 : intensity_share(light, point - light.position.xyz);
        if (share > 0.0) sum += size * share * (arriving < 0.0 ? lit_share(light, point, normal) : arriving);
      }
    }
    if (cut) {
      ++depth;
      path <<= 2;
      continue;
    }
    while (depth > 0u && (path & 3u) == 3u) {
      path >>= 2;
      --depth;
    }
    if (depth == 0u) return sum;
    ++path;
  }
  return sum;
}

/// H at a sensor over the light's intensity.
float sensor_share(LightRecord light, vec3 point, vec3 normal, float arriving) {
  float unblocked = max(0.0, -dot(normal, light.direction.xyz));
  if (light_type(light) != kLightDirectional) {
    const vec3 way = light.position.xyz - point;
    const float squared = dot(way, way);
    if (squared == 0.0) return 0.0;
    unblocked = intensity_share(light, -way) * max(0.0, dot(normal, way) / sqrt(squared)) / squared;
  }
  if (unblocked <= 0.0) return 0.0;
  return unblocked * (arriving < 0.0 ? lit_share(light, point, vec3(0.0)) : arriving);
}

#endif
