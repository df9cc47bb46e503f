// SPDX-License-Identifier: MIT
//
// How far a solution is from that of other rows, for given lights: of a model with full rows, how much the
// cut and the codes of another cost. Where a bracket (bracket.h) holds for all that could have been cut, this
// is what it did cost, and as sure.
//
//   B0 the solution that is asked about, B(k+1) = M + rho (H + K B(k)) with the other rows
//   |B0 - B| <= |B0 - B(n)| + v w_n,    w_n = max (|B(n) - B(n-1)| / v) q / (1 - q)
//
// with v and q of contraction_bound. n grows until w_n is a small part of the distance.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

struct RowCertificate {
  std::vector<Rgb> radiosity;   ///< per cluster, lm/m2: the solution is off by no more
  std::vector<Rgb> irradiance;  ///< per gather row, lux
  std::uint32_t products = 0;
};

/// `matrices` and `lighting` are of the other rows; so is the order of `radiosity` (per cluster) and
/// `irradiance` (per gather row), which the solution has. Refused as by check_contraction; `cancelled` when
/// `go_on` (asked before each product) returns false.
Result<RowCertificate> certify_against(const ReferenceMatrices& matrices, const Lighting& lighting,
                                       const std::vector<Rgb>& radiosity, const std::vector<Rgb>& irradiance,
                                       const std::function<bool()>& go_on = {});

}  // namespace relume
