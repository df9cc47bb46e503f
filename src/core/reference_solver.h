// SPDX-License-Identifier: MIT
//
// The reference: plain, sequential, in double precision. It says what is right; nobody optimises it.
#pragma once

#include <functional>
#include <vector>

#include "core/block_matrix.h"
#include "core/model.h"
#include "core/solve.h"

namespace relume {

/// A matrix over all senders, and P, which spreads the radiosity of leaves to nodes. Senders are numbered
/// through: the clusters of all systems, then the sky patches (together the leaves), then the nodes. What is
/// not loaded has no radiosity and is left out: rows then sum to less.
struct SenderMatrix {
  /// Without nodes: senders are leaves.
  SenderMatrix(CsrMatrix all_rows = {}, CsrMatrix all_nodes = {});

  CsrMatrix rows;   ///< rows x senders
  CsrMatrix nodes;  ///< nodes x leaves: weights of the mean, each row sums to 1 where all is loaded
};

/// Decoded matrices of all systems.
struct ReferenceMatrices {
  SenderMatrix bounce;  ///< rows: clusters
  SenderMatrix gather;  ///< rows: gather rows
};

/// The model must be valid (check_model).
ReferenceMatrices reference_matrices(const Model& model);

/// The first of them alone.
SenderMatrix reference_bounce_matrix(const Model& model);

/// One application of K: M + rho (H + K b), b = `radiosity` of the clusters, then the sky's, then that of the
/// nodes by P.
std::vector<Rgb> bounce(const SenderMatrix& bounce_matrix, const Lighting& lighting,
                        const std::vector<Rgb>& radiosity);

/// Weights from a few products of rho K_c P on ones; see ContractionBound. q < 1 is needed by
/// solve_reference.
ContractionBound contraction_bound(const SenderMatrix& bounce_matrix, const std::vector<Rgb>& albedo);

/// rho K_c v by whoever holds the matrix.
using ClusterProduct = std::function<Result<std::vector<Rgb>>(const std::vector<Rgb>& v)>;

/// The same from products that are off by at most the share `rounding` in each entry. Fails as a product
/// does.
Result<ContractionBound> contraction_bound(const ClusterProduct& multiply, const std::vector<Rgb>& albedo,
                                           double rounding);

/// Refuses (check_failed) when q >= 1 in any channel: with the rate at which light would grow where the lower
/// end of the bracket of the spectral radius is 1 or more; else it is undecided, and the sentence says after
/// how many products.
Result<void> check_contraction(const ContractionBound& contraction);

/// The lengths of the lighting's arrays fit the matrix.
Result<void> check_shapes(const SenderMatrix& bounce_matrix, const Lighting& lighting);
/// The same of the parts of one.
Result<void> check_shapes(const CsrMatrix& rows, const CsrMatrix& nodes, const Lighting& lighting);

/// Called after each bounce; return false to cancel.
using BounceObserver = std::function<bool(std::uint32_t bounces, double error_bound)>;

/// Plain bounces until the rule stops them. Refused by check_contraction when q >= 1.
Result<Solution> solve_reference(const SenderMatrix& bounce_matrix, const Lighting& lighting,
                                 const StopRule& rule, const BounceObserver& observer = {});

/// Irradiance (lm/m2) per gather row: I = G b.
std::vector<Rgb> gather(const SenderMatrix& gather_matrix, const Lighting& lighting,
                        const std::vector<Rgb>& radiosity);

}  // namespace relume
