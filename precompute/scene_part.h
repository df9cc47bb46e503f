// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/task_group.h>

#include <optional>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/result.h"
#include "precompute/enclosed_grid.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"
#include "scene/scene.h"

namespace relume {

/// What of a model depends on the scene alone: hashes, the tree of the occluders, lights. It is made in the
/// calling task arena, by threads that have nothing else to do while surfaces are cut and rows are traced.
class ScenePart {
 public:
  struct Made {
    Model model;                        ///< a part of one
    EnclosedGrid looked;                ///< what the rig saw, where lights are of the rig
    std::vector<std::string> warnings;  ///< of lights
  };

  /// Begins with it. Borrows all but `earlier`, which may be missing. While this makes it, nobody may make or
  /// release another caster: Embree may hang where two threads do so.
  ScenePart(const Scene& scene, const Geometry& geometry, const RayCaster& caster,
            std::optional<EarlierLooks> earlier);
  ScenePart(const ScenePart&) = delete;
  /// Waits.
  ~ScenePart();

  /// Waits; lives as long as this. Fails with out_of_memory.
  Result<const Made*> get();

 private:
  Made made_;
  Result<void> built_;
  tbb::task_group tasks_;
};

}  // namespace relume
