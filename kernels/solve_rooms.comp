// SPDX-License-Identifier: MIT
//
// (1 - C) c = d of three channels, by Gauss-Jordan elimination in one workgroup, two invocations a room. Rows of C sum
// to less than 1, so that no pivoting is needed; a room whose light would not fade gets no irradiance.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/rooms.glsl"

const float kLeastPivot = 1e-6;

shared float factors[3u * kMaxRooms * kMaxRooms];  // channel, row, column
shared float right[3u * kMaxRooms];                // channel, row

uint at(uint channel, uint row, uint column) {
  return (channel * kMaxRooms + row) * kMaxRooms + column;
}

float inverse_pivot(uint channel, uint row) {
  const float pivot = factors[at(channel, row, row)];
  return pivot > kLeastPivot ? 1.0 / pivot : 0.0;
}

/// Coefficients of the matrix, one after the other, and the right side of a row.
void assemble(uint lane, uint rooms) {
  for (uint i = lane; i < rooms * rooms; i += kWorkgroupSize) {
    const uint row = i / rooms, column = i % rooms;
    vec3 reflected = vec3(0.0);
    for (uint system = 0u; system < range.count; ++system)
      reflected += room_sums[pair_sums(system, row, column)].rgb;
    for (uint channel = 0u; channel < 3u; ++channel)
      factors[at(channel, row, column)] = (row == column ? 1.0 : 0.0) - reflected[channel];
  }
  if (lane >= rooms) return;
  vec3 changed = vec3(0.0);
  for (uint system = 0u; system < range.count; ++system) {
    for (uint column = 0u; column < rooms; ++column)
      changed += room_sums[pair_sums(system, lane, column) + 1u].rgb;
    changed += room_sums[pair_sums(system, lane, kMaxRooms) + 1u].rgb;
  }
  for (uint channel = 0u; channel < 3u; ++channel) right[channel * kMaxRooms + lane] = changed[channel];
}

/// Every other column of a row, from the one behind the pivot on; the first of two also its right side.
void eliminate(uint row, uint part, uint pivot, uint rooms) {
  for (uint channel = 0u; channel < 3u; ++channel) {
    const float factor = factors[at(channel, row, pivot)] * inverse_pivot(channel, pivot);
    for (uint column = pivot + 1u + part; column < rooms; column += 2u)
      factors[at(channel, row, column)] -= factor * factors[at(channel, pivot, column)];
    if (part == 0u) right[channel * kMaxRooms + row] -= factor * right[channel * kMaxRooms + pivot];
  }
}

void main() {
  const uint row = gl_LocalInvocationIndex % kMaxRooms, part = gl_LocalInvocationIndex / kMaxRooms;
  const uint rooms = range.block_row;
  assemble(gl_LocalInvocationIndex, rooms);
  for (uint pivot = 0u; pivot < rooms; ++pivot) {
    memoryBarrierShared();
    barrier();
    if (row < rooms && row != pivot) eliminate(row, part, pivot, rooms);
  }
  memoryBarrierShared();
  barrier();
  if (row >= rooms || part > 0u) return;
  vec4 irradiance = vec4(0.0);
  for (uint channel = 0u; channel < 3u; ++channel)
    irradiance[channel] = right[channel * kMaxRooms + row] * inverse_pivot(channel, row);
  room_sums[first_room() + row] = irradiance;
}
