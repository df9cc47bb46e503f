// SPDX-License-Identifier: MIT
//
// Products of a SenderMatrix with values of the clusters, per channel.
#pragma once

#include <cstdint>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

/// sum_j K_ij b_j of one row; `b` per column.
Rgb row_product(const CsrMatrix& matrix, std::uint32_t row, const std::vector<Rgb>& b);

/// K_c P x: the irradiance that clusters of radiosity `x` send to the rows. Sky patches, and with them the
/// nodes of the sky, do not feed back.
std::vector<Rgb> cluster_product(const SenderMatrix& matrix, const std::vector<Rgb>& x);

/// Entries of the longest row.
std::uint64_t longest_row(const CsrMatrix& matrix);

/// The largest value of each channel, at least 0.
Rgb largest(const std::vector<Rgb>& values);

}  // namespace relume
