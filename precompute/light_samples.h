// SPDX-License-Identifier: MIT
#pragma once

#include "core/model.h"
#include "core/result.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"

namespace relume {

/// What direct light at run time needs beyond surfaces and occluders: the tree of occluders, which patches
/// belong to their elements (System::own_patches), and where sensors measure. `geometry` and `caster` are
/// those of the occluders. Fails with out_of_memory.
Result<void> add_light_samples(const Geometry& geometry, const RayCaster& caster, Model& model);

/// The same for a model by itself.
Result<void> add_light_samples(Model& model);

/// The occluders as far as rays need them: origin, positions, triangles, normals, bounds and offset only.
Geometry occluder_geometry(const Model& model);

}  // namespace relume
