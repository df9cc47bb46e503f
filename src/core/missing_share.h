// SPDX-License-Identifier: MIT
//
// What a solve leaves open while some systems are not loaded. A sender that is not loaded has no radiosity:
// each row that sees it has a hole, and light that would come through it is missing, here and after every
// further bounce.
#pragma once

#include <vector>

#include "core/model.h"
#include "core/solve.h"

namespace relume {

/// Sum of the form factors of a row towards senders that are not loaded: the share of its hemisphere. A node
/// above the systems of which a part is loaded counts with the share of its area that is not.
struct MissingShare {
  std::vector<double> clusters;  ///< per cluster of the loaded systems
  std::vector<double> gather;    ///< per gather row of the loaded systems
};

/// All zero when every system is loaded. The model must be valid (check_model).
MissingShare missing_share(const Model& model);

/// The lighting under which the missing light itself is solved for. If no surface that is not loaded has more
/// radiosity than `largest_radiosity` (lm/m2), then the solution B of `lighting` misses at most the radiosity
/// D that solves
///   D = rho (share x largest_radiosity + K D),
/// because products of K are monotone, and a gather row misses at most its share x largest_radiosity + G D.
/// Never less than it would be with all systems loaded and all of them that bright; zero without a hole.
Lighting missing_light(const Lighting& lighting, const MissingShare& share, const Rgb& largest_radiosity);

}  // namespace relume
