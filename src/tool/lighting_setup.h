// SPDX-License-Identifier: MIT
//
// From the options that `solve` and `compare` share to what a solve needs.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/sky.h"
#include "core/solve.h"
#include "precompute/direct_irradiance.h"
#include "scene/scene.h"
#include "tool/console.h"

namespace relume {

struct LightingOptions {
  std::optional<std::filesystem::path>
      scene;  ///< edited copy: its colours and lights replace the stored ones
  std::optional<std::filesystem::path> lights;     ///< replaces all punctual lights
  std::optional<std::filesystem::path> materials;  ///< replaces colours and emission by material
  std::optional<std::string> sky;                  ///< "R,G,B" in cd/m2, or an equirectangular .hdr
  std::optional<double> max_albedo;                ///< absent: as precomputed
};

struct LightingSetup {
  Lighting lighting;
  std::vector<Rgb> gather_direct;  ///< from punctual lights, lux, per gather row
  std::vector<Light> lights;
  Sky sky = Rgb(0.0);
  bool lit_by_rig = false;
  std::optional<Scene> scene;                     ///< of --scene
  std::vector<std::uint32_t> replaced_materials;  ///< of --materials
  double max_albedo = 1.0;
};

/// Who computes direct irradiance with shadows.
using DirectLightSource = std::function<Result<DirectIrradiance>(const Model&, std::span<const Light>)>;

/// Parses "R,G,B"; nothing when the text is anything else.
std::optional<Rgb> parse_triple(const std::string& text);

/// Stored colours and lights, replaced step by step by --scene, --lights, --materials, --sky; then direct
/// irradiance with shadows, by `direct` (empty: the processor). The stated rig shines only while nothing else
/// does. Warnings go to `console`.
Result<LightingSetup> set_up_lighting(const Model& model, const LightingOptions& options, Console& console,
                                      const DirectLightSource& direct = {});

}  // namespace relume
