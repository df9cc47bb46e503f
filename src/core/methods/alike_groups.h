// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/rooms.h"

namespace relume {

/// Clusters in groups of about one area whose irradiance stays alike however light falls: those on which
/// random signs, averaged a few times over what each cluster sees, come out nearly equal (after the relaxed
/// test vectors of A. Brandt, O. Livne, Lean Algebraic Multigrid, 2012; groups by k-means, weighted by area,
/// of S. Lloyd, Least Squares Quantization in PCM, 1982). At most `most` groups. A group holds no clusters
/// that no chain of form factors joins, so that no light gets into what is sealed off: of these the larger
/// part stays, and the others are in no group. `areas` per cluster, m2, above 0. Costs about as much as 50
/// products.
Rooms alike_groups(const SenderMatrix& bounce_matrix, const std::vector<double>& areas, std::uint32_t most);

}  // namespace relume
