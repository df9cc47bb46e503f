// SPDX-License-Identifier: MIT
//
// What is right without clusters, lumels or form factors: indirect irradiance at the sensors of a TestScene
// by paths from them, which no model had a hand in. It is noisy, but knows how much: squared differences from
// it are freed of its noise, so that few paths tell an error well below their own.
#pragma once

#include <cstdint>
#include <vector>

#include "core/quantities.h"
#include "core/result.h"
#include "measure/test_lights.h"

namespace relume {

struct PathOptions {
  std::uint32_t paths = 4096;          ///< per sensor, eight batches of a power of two
  std::vector<std::uint32_t> sensors;  ///< which of them are asked for, the others get 0; empty: all
  bool sky = false;                    ///< for `ambient`: the sky shines; else all surfaces glow
  double max_albedo = 0.95;            ///< Model::max_albedo of what is compared
  std::uint32_t threads = 0;           ///< 0: all
};

struct PathIrradiance {
  std::vector<std::vector<Rgb>> values;    ///< lm/m2 at the sensors, per light
  std::vector<std::vector<double>> noise;  ///< the same: squared standard error, channels added
};

/// Paths end by roulette. Point and spot lights and the lamp are connected to every vertex, the sky and what
/// glows are met. Colours are those of the points that paths meet, not means. The same for any number of
/// threads. Fails when memory runs out.
Result<PathIrradiance> path_irradiance(const TestScene& test, const PathOptions& options);

}  // namespace relume
