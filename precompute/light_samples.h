// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/model.h"
#include "core/result.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"

namespace relume {

class Views;

/// Per system and element, as the model has them: whether all of its light patches belong to it.
using WholeElements = std::vector<std::vector<std::uint8_t>>;

/// What direct light at run time needs beyond surfaces, occluders and their tree: which patches belong to
/// their elements (System::own_patches), and where sensors measure. `geometry` and `caster` are those of the
/// occluders, `views` asks them. Elements that are whole, as far as is known beforehand (`whole`, or
/// nothing), are not asked; afterwards it says which are.
void add_light_samples(const Geometry& geometry, const RayCaster& caster, Model& model, Views& views,
                       WholeElements& whole);

/// The same for a model by itself, and the tree. Fails with out_of_memory.
Result<void> add_light_samples(Model& model);

/// The occluders as far as rays need them: origin, positions, triangles, normals, bounds and offset only.
Geometry occluder_geometry(const Model& model);

}  // namespace relume
