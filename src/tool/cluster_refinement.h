// SPDX-License-Identifier: MIT
//
// What the size of clusters costs under the lights that shine: clusters are taken apart into their lumels,
// before the rays of a sample of receivers.
//
//   I_r = sum over rays of b(what the ray meets) / rays,    b: B of the cluster, or M + rho (H + I) of the
//   lumel
//
// The difference, of the same rays, is what one level of refinement of the senders changes.
#pragma once

#include <optional>

#include "tool/lighting_setup.h"
#include "tool/solver.h"

namespace relume {

/// Its root mean square over some hundred lumels, as a share of that of the irradiance there. Noise of the
/// rays is left out: only what both halves of them agree on counts. Nothing without lumels or light. Fails
/// when memory runs out.
Result<std::optional<double>> cluster_size_error(const Model& model, const LightingSetup& setup,
                                                 const SolveOutcome& outcome);

}  // namespace relume
