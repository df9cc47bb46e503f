// SPDX-License-Identifier: MIT
#pragma once

#include "precompute/assemble_model.h"
#include "precompute/ray_caster.h"
#include "precompute/rows_keeper.h"
#include "precompute/scene_part.h"

namespace relume {

/// Everything but probes' volume, camera and provenance, from what the scene alone says and from rows that
/// were traced; what does not depend on each other side by side. In the calling task arena. The keeper, if
/// any, learns what it keeps of surfaces and lights, and takes its rays where `takes_rays`. Fails with usage
/// or out_of_memory.
Result<Model> complete_model(ScenePart& scene_part, const ModelParts& parts, const PrecomputeOptions& options,
                             ValueCodec codec, const RayCaster& caster, RowsKeeper* keeper, bool takes_rays,
                             PrecomputeReport& report);

}  // namespace relume
