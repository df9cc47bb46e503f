// SPDX-License-Identifier: MIT
//
// `solve --certify FULL`: how far the answer is from that of full rows.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tool/lighting_setup.h"
#include "tool/solver.h"

namespace relume {

struct AnswerCertificate {
  std::vector<Rgb> irradiance;  ///< per gather row, lux: the answer is off by no more
  double relative = 0.0;        ///< its root mean square over that of the answer, of valid lumels
  double worst = 0.0;           ///< its largest over the root mean square of the answer
  std::uint32_t products = 0;
};

/// Of what `outcome` solved. `full` is a model that must have the same surfaces (core/same_surfaces.h), or a
/// .rows file of this one (full_rows.h).
Result<AnswerCertificate> certify_answer(const Model& model, const SolveOutcome& outcome,
                                         const std::filesystem::path& full, const LightingOptions& options,
                                         Console& console);

/// One sentence for people.
std::string certificate_sentence(const AnswerCertificate& certificate, const std::filesystem::path& full);

/// The object `certificate` of `solve --json`.
JsonValue certificate_json(const AnswerCertificate& certificate);

}  // namespace relume
