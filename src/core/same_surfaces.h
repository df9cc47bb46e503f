// SPDX-License-Identifier: MIT
//
// Two models over the same lumels and clusters, which differ in what their rows keep, and so in the order in
// which they store them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/model.h"
#include "core/result.h"

namespace relume {

/// Numbers in one model of what another has.
struct SameSurfaces {
  std::vector<std::uint32_t> clusters;     ///< per cluster of `to`: that of `from`
  std::vector<std::uint32_t> gather_rows;  ///< per gather row of `to`: that of `from`
};

/// Clusters are the same when they are made of the same elements, told by their positions and normals to the
/// bit; lumels by element, sensors by name. Fails with bad_input, naming the first thing that differs.
Result<SameSurfaces> same_surfaces(const Model& from, const Model& to);

}  // namespace relume
