// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/model.h"
#include "core/solve.h"
#include "tool/seen_point.h"

namespace relume {

/// What surfaces look like under a solved lighting. Holds references to model and lighting.
class SurfaceShading {
 public:
  /// `irradiance` is per gather row, direct + indirect, lux.
  SurfaceShading(const Model& model, const Lighting& lighting, std::span<const Rgb> irradiance);

  /// Radiance (cd/m2): albedo x irradiance / pi + emission, all interpolated bilinearly among the valid
  /// lumels of the same chart. Black where a surface has no lumels near, and on the back of single-sided
  /// materials.
  Rgb radiance(const SeenPoint& point) const;

 private:
  struct SystemLumels {
    std::vector<std::uint32_t> lumel_at;  ///< per texel, kNone: none
    std::vector<Rgb> irradiance;          ///< per lumel; of invalid ones, what the lightmap shows
    std::uint32_t first_cluster = 0;
  };
  struct Sum;
  enum class Use { valid, all };
  void add_lumels(const SeenPoint& point, const glm::vec2& texel, int reach, Use use, Sum& sum) const;
  void add_lumel(const SeenPoint& point, std::uint32_t lumel, float weight, Sum& sum) const;

  const Model& model_;
  const Lighting& lighting_;
  std::vector<SystemLumels> systems_;
};

}  // namespace relume
