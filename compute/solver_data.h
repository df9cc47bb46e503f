// SPDX-License-Identifier: MIT
//
// What a model and its lighting look like in the buffers of a solver.
#pragma once

#include <vector>

#include "compute/solver_layout.h"
#include "compute/upload.h"
#include "core/model.h"
#include "core/solve.h"

namespace relume {

/// See GpuSolver::model_data.
UploadData model_upload(const Model& model, const SolverLayout& layout);

/// See GpuSolver::lighting_data.
UploadData lighting_upload(const Lighting& lighting, const std::vector<Rgb>& weights,
                           const SolverLayout& layout);

/// See GpuSolver::radiosity_data.
UploadData radiosity_upload(const std::vector<Rgb>& radiosity, SolveBuffer half);

}  // namespace relume
