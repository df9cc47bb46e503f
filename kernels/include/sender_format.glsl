// SPDX-License-Identifier: MIT
//
// How the radiosity of the senders that a system imports is kept: four floats each, or four halves of it times
// kSenderScale, a power of two, so that the largest fits. What is a normal half is rounded to nearest; what is
// smaller may not survive a device, and is black.
#ifndef RELUME_SENDER_FORMAT_GLSL
#define RELUME_SENDER_FORMAT_GLSL

#include "../shared/bindings.h"

layout(constant_id = kHalfSendersConstant) const uint kHalfSenders = 0u;
layout(constant_id = kSenderScaleConstant) const float kSenderScale = 1.0;

#endif
