// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "precompute/precompute.h"
#include "scene/scene.h"

namespace relume {

enum class FactorGrouping { node, material };

struct SurfaceFactors {
  std::vector<std::string> surfaces;  ///< node paths or material names
  std::vector<double>
      areas;  ///< m2, of what is solid (core/opacity.h); a double-sided surface counts both sides
  std::vector<std::vector<double>>
      factors;  ///< [i][j]: fraction of what leaves i (diffusely) that arrives at j
  std::vector<std::vector<double>> standard_error;
};

/// Form factors between named surfaces by `rays` cosine-distributed rays per surface, origins spread by area
/// (Owen-scrambled Sobol points; the standard error comes from independent scrambles). What hits a back face
/// of a single-sided surface arrives nowhere. 0 rays: 2^26 in all, but 2^16 to 2^22 per surface (2^22 give a
/// unit cube's factors within 1e-4). Surfaces without triangles are left out; more than 4096 are
/// refused (usage). The same for any number of threads (0 = all).
Result<SurfaceFactors> surface_factors(const Scene& scene, FactorGrouping grouping, std::uint32_t rays,
                                       std::uint64_t seed = 0, std::uint32_t threads = 0,
                                       const ProgressObserver& observer = {});

}  // namespace relume
