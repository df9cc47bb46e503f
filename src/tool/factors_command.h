// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "precompute/surface_factors.h"
#include "tool/console.h"

namespace relume {

struct FactorsArguments {
  std::filesystem::path scene;
  FactorGrouping grouping = FactorGrouping::node;
  std::uint32_t rays = 0;  ///< per surface, 0 = as surface_factors chooses
  std::uint64_t seed = 0;
  std::uint32_t threads = 0;  ///< 0 = all
};

/// `relume factors`: form factors between the named surfaces of a scene.
Result<int> run(const FactorsArguments& arguments, Console& console);

}  // namespace relume
