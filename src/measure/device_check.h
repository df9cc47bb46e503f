// SPDX-License-Identifier: MIT
//
// A device's answer is checked before it is timed.
#pragma once

#include <string>

#include "compute/solver_options.h"
#include "compute/standalone/solver_session.h"
#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// "f32", "unorm16", "sqrt8".
const char* codec_name(ValueCodec codec);

/// How a device stores and multiplies a matrix.
struct KernelVariant {
  RowKernel kernel = RowKernel::tile_shared;
  MatrixFetch fetch = MatrixFetch::texels;
  ValueCodec codec = ValueCodec::unorm16;
  std::uint32_t tile_rows = 8;  ///< 1: CSR
  bool half_senders = false;    ///< SolverOptions::half_senders_up_to
};

/// "tiles, tile_shared, texels, unorm16", and ", half senders" where they are.
std::string name_of(const KernelVariant& variant);

/// Fails (check_failed) when irradiance on the device after some bounces is not that of the reference for the
/// radiosity that the device has, to `tolerance`, relative; `name` is for the sentence. `model` is that of
/// the session.
Result<void> check_device(SolverSession& session, const Model& model, const Lighting& lighting,
                          const std::string& name, double tolerance = 1e-5);

}  // namespace relume
