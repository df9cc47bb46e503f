// SPDX-License-Identifier: MIT
//
// The shared truth set: rooms with irradiance at sensors, and form factors in closed form. It is not part of
// the repository; tests skip where it is missing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/probe_coefficients.h"
#include "core/quantities.h"
#include "precompute/precompute.h"

namespace relume::test {

/// RELUME_SHARED_DIR, else "shared" beside the source; nothing when there is no such folder.
std::optional<std::filesystem::path> shared_folder();

/// Irradiance (lm/m2) at the sensors of one room under one lighting.
struct RoomTruth {
  std::vector<std::string> surface;  ///< per sensor
  std::vector<std::string> room;     ///< per sensor; empty for single rooms
  std::vector<Rgb> punctual;
  std::vector<Rgb> emitted;
  std::vector<Rgb> indirect;  ///< total - punctual
  std::vector<Rgb> standard_error;
};

/// All throw std::runtime_error with a sentence when the file is not as expected.
RoomTruth read_room_truth(const std::filesystem::path& json);
std::vector<SensorPoint> read_sensors(const std::filesystem::path& csv);

/// Incident radiance without punctual lights, in the order of core/probe_coefficients.h.
struct ProbeTruth {
  std::vector<ProbePoint> points;
  std::vector<ProbeCoefficients> coefficients;
};
ProbeTruth read_probe_truth(const std::filesystem::path& json);

/// One case of form_factors.json.
struct FactorTruth {
  struct Pair {
    std::string from, to;
    double value = 0.0;
  };
  std::string name;
  std::filesystem::path mesh;  ///< relative to the truth folder
  std::vector<Pair> pairs;
  std::vector<std::string> closed_rows;
};
std::vector<FactorTruth> read_factor_truth(const std::filesystem::path& json);

}  // namespace relume::test
