// SPDX-License-Identifier: MIT
//
// How far a model is from the converged answer, cause by cause, as its precompute can tell.
#pragma once

#include "core/block_matrix.h"
#include "precompute/precompute.h"
#include "precompute/probing.h"
#include "precompute/surfaces.h"
#include "precompute/trace_rows.h"

namespace relume {

/// Writes PrecomputeReport::error, and a warning where a target (`asked`, 0: none) is missed by a fifth.
void estimate_errors(const TracedRows& rows, const Surfaces& surfaces, const Probing& probing, double asked,
                     ValueCodec codec, PrecomputeReport& report);

}  // namespace relume
