// SPDX-License-Identifier: MIT
//
// What a model and its lighting look like in the buffers of a solver.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "compute/solver_layout.h"
#include "compute/upload.h"
#include "core/model.h"
#include "core/quantities.h"

namespace relume {

/// Nodes and weights of the sky, a black sky, and probes that know nothing; buffers by SolveBuffer, as in the
/// layout.
UploadData model_upload(const Model& model, const SolverLayout& layout);

/// Imports, nodes, matrices, and albedo and, in every lighting, exitance as stored; no direct light, weights
/// of 1. Refers to `model`. Buffers as in the layout.
UploadData system_upload(const Model& model, std::uint32_t system, const SystemLayout& layout);

/// RGB values as the device stores them.
std::vector<std::byte> rgb_bytes(std::span<const Rgb> values);

}  // namespace relume
