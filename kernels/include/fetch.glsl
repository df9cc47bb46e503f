// SPDX-License-Identifier: MIT
//
// Whether storage buffers or the texel buffers that show the same bytes are read.
#ifndef RELUME_FETCH_GLSL
#define RELUME_FETCH_GLSL

#include "../shared/bindings.h"

layout(constant_id = kFetchConstant) const uint kFetch = kFetchStorage;

#endif
