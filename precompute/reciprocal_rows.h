// SPDX-License-Identifier: MIT
//
// Rows of clusters projected to what exact form factors obey: reciprocity, A_i F_ij = A_j F_ji, and row sums
// that stay what the rays measured (1 in a closed room).
//
// Rays see each pair of clusters twice, from both ends. With S_ij = A_i F_ij, whose variance is about
// A_i S_ij / N_i for N_i rays,
//
//   S'_ij = (w_i S_ij + w_j S_ji) / (w_i + w_j),  w = N / A       on the union of both patterns
//   S''   = D S' D,  D diagonal, sum_j S''_ij = A_i sum_j F_ij    (symmetric scaling)
//
// D by d_i <- sqrt(d_i t_i / (S' d)_i) (R. Sinkhorn, A Relationship between Arbitrary Positive Matrices and
// Doubly Stochastic Matrices, 1964; in the symmetric form of P. Knight, D. Ruiz and B. Ucar, A Symmetry
// Preserving Algorithm for Matrix Scaling, 2014), none below 1/2 or above 2. Where surfaces nearly touch,
// their sampled areas contradict each other and no D exists: these rows end at the limits and are multiplied
// by what their sums lack, which costs their reciprocity. Sky patches have no rows: their columns stay.
#pragma once

#include <cstdint>
#include <span>

#include "core/result.h"
#include "precompute/precompute.h"
#include "precompute/row_tracer.h"

namespace relume {

/// A cluster's row, and what it counts.
struct ProjectedRow {
  FormFactorRow* row = nullptr;
  double area = 0.0;  ///< m2, of what its rays started from
  double rays = 0.0;
};

/// `rows`: of all clusters of the model, in the order of their numbers as senders; they have no moments. In
/// the calling task arena, the same for any number of threads. Fails (check_failed), and changes nothing,
/// where no scaling exists for a tenth of the area or more.
Result<Projection> project_to_reciprocity(std::span<const ProjectedRow> rows);

}  // namespace relume
