// SPDX-License-Identifier: MIT
#pragma once

#include "compute/standalone/solver_session.h"
#include "core/methods/methods.h"
#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// BiCGSTAB, or GMRES over `levels` unless it is null, with products by the session's device and the rest by
/// the processor, in double precision. A bounce of the device is off by at most `rounding` of its result: a
/// change that is no larger ends the solve. Leaves the session with the lighting and the radiosity of the
/// solution. Fails as the session, or with cancelled.
Result<Solution> solve_by_products(SolverSession& session, const Model& model, const Lighting& lighting,
                                   const ContractionBound& contraction, double rounding,
                                   const NearAndFar* levels, const StopRule& rule,
                                   const BounceObserver& observer);

}  // namespace relume
