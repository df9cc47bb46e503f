// SPDX-License-Identifier: MIT
//
// The rows of a model, cut where a budget asks for it, as matrices of the systems with their import tables;
// probes too.
#pragma once

#include <vector>

#include "precompute/assemble_model.h"

namespace relume {

/// Fills trees, imports, both matrices and probes of all systems. Fails (usage) when a system sees more
/// senders than columns can name.
Result<void> store_matrices(const ModelParts& parts, ValueCodec codec, Model& model,
                            PrecomputeReport& report);

}  // namespace relume
