// SPDX-License-Identifier: MIT
//
// Places for light probes, and the cells between them.
#pragma once

#include <vector>

#include "core/probe_volume.h"
#include "core/result.h"
#include "precompute/precompute.h"
#include "precompute/probing.h"
#include "precompute/rows.h"

namespace relume {

struct PlacedProbes {
  std::vector<ProbePoint> points;  ///< named by their numbers
  ProbeVolume volume;
};

/// Cells of `spacing` (m) over the box of the geometry, in the middle of it, x fastest. There is no probe
/// inside geometry: one on or just in a surface is moved off it. Refused (usage) beyond a million.
Result<PlacedProbes> place_probe_grid(const Geometry& geometry, const RayCaster& caster, double spacing);

/// A tree of boxes: of its cells, those are halved, and across that axis, that lessen the error between
/// probes most for each probe that this takes, until it is at most `error`: of irradiance, relative to what
/// it is there (or to a tenth of its root mean square in the room), root mean square over free space inside
/// the box of the geometry and over the probing emissions. Free space that no probe sees is off by all of its
/// light. Cells are halved four times at most across each axis; what is off in the smallest ones is not
/// counted. Cancelled when the observer says so.
Result<PlacedProbes> place_probes(const RowScene& scene, const Probing& probing, double error,
                                  RowCounts& counts, const ProgressObserver& observer);

}  // namespace relume
