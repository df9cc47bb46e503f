// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/model.h"
#include "core/solve.h"
#include "scene/scene.h"
#include "tool/seen_point.h"

namespace relume {

/// Colours finer than clusters, for pictures: those of an edited scene.
struct FineColors {
  const Scene* scene = nullptr;  ///< of the model's geometry; null: none, clusters must do
  double max_albedo = 1.0;
  std::vector<std::uint32_t> replaced{};  ///< materials whose colours do not come from the scene
};

/// What surfaces look like under a solved lighting. Holds references to model, lighting and the scene of
/// `colors`.
class SurfaceShading {
 public:
  /// `irradiance` is per gather row, direct + indirect, lux.
  SurfaceShading(const Model& model, const Lighting& lighting, std::span<const Rgb> irradiance,
                 FineColors colors = {});

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
  Rgb radiance_of(const SeenPoint& point, const Sum& sum) const;
  enum class Use { valid, all };
  void add_lumels(const SeenPoint& point, const glm::vec2& texel, int reach, Use use, Sum& sum) const;
  void add_lumel(const SeenPoint& point, std::uint32_t lumel, float weight, Sum& sum) const;

  const Model& model_;
  const Lighting& lighting_;
  FineColors colors_;
  std::vector<SystemLumels> systems_;
};

}  // namespace relume
