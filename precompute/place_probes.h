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

/// An octree: cells are halved while the irradiance between their probes is off by more than `error`,
/// relative to what it is there and root mean square over the probing emissions, and more than that the
/// smaller they are; and while a place in free space has no probe that sees it. Cancelled when the observer
/// says so.
Result<PlacedProbes> place_probes(const RowScene& scene, const Probing& probing, double error,
                                  RowCounts& counts, const ProgressObserver& observer);

}  // namespace relume
