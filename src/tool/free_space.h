// SPDX-License-Identifier: MIT
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "core/model.h"
#include "precompute/ray_caster.h"

namespace relume {

/// A box, relative to Model::origin.
struct Bounds {
  glm::dvec3 low{0.0};
  glm::dvec3 high{0.0};
  double diagonal() const { return glm::distance(low, high); }
};

/// All of the scene, or the busy part of one that lies in a wide plane.
Bounds interesting_bounds(const Occluders& occluders);

/// A place to look from, relative to Model::origin.
struct Eye {
  glm::dvec3 position{0.0};
  double worth = 0.0;     ///< 0: not usable
  double enclosed = 0.0;  ///< share of directions that meet a front
};

/// Eyes in the free space in front of surfaces, the most open among the enclosed first; those inside of
/// things or with a nose at a wall are left out. `diagonal` is that of the bounds.
std::vector<Eye> eyes_in_free_space(const Model& model, const RayCaster& caster, double diagonal);

}  // namespace relume
