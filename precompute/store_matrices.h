// SPDX-License-Identifier: MIT
//
// The rows of a model, cut where a budget asks for it, as matrices of the systems with their import tables.
#pragma once

#include <vector>

#include "precompute/assemble_model.h"

namespace relume {

/// Fills trees, imports and both matrices of all systems. `element_orders`: per system, the elements in the
/// order that the model stores. Without a budget rows are full, in tiles of one; with one, of all or of some
/// node's own, in tiles of 8 rows that keep so many nodes, sensors in tiles of one row of four times as many.
/// Fails (usage) when a system sees more senders than columns can name.
Result<void> store_matrices(const ModelParts& parts, const PrecomputeOptions& options,
                            const std::vector<std::vector<std::uint32_t>>& element_orders, Model& model,
                            PrecomputeReport& report);

}  // namespace relume
