// SPDX-License-Identifier: MIT
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/bounce.glsl"
#include "include/tile_shared.glsl"
