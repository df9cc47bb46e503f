// SPDX-License-Identifier: MIT
#pragma once

#include "core/model.h"

namespace relume::test {

/// A valid model with something in every field: a floor (system "floor", y = 0) and a ceiling (system "lid",
/// y = 1) of 1 m2, each one cluster, element and lumel of two pieces; a sensor, a sky patch, three lights, a
/// camera.
///
///        imports of "floor": lid, sky        imports of "lid": floor
///        bounce  [ 0.2   0.5 ]               bounce  [ 0.2 ]
///        gather  [ 0.2   0.5 ] lumel         gather  [ 0.2 ] lumel
///                [ 0.25  0   ] sensor
Model tiny_model();

}  // namespace relume::test
