// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/model.h"
#include "core/sender_leaves.h"
#include "core/solve.h"

namespace relume {

/// Radiosity of the leaves: the clusters of all systems (`radiosity`), then the sky patches.
std::vector<Rgb> leaf_radiosity(const Lighting& lighting, const std::vector<Rgb>& radiosity);

/// Radiosity of what the columns of a system mean; `leaves`: leaf_radiosity().
std::vector<Rgb> import_radiosity(const System& system, const LeafNumbers& numbers,
                                  const std::vector<Rgb>& leaves);

}  // namespace relume
