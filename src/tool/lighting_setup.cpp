// SPDX-License-Identifier: MIT
#include "tool/lighting_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <glm/common.hpp>

#include "scene/load_scene.h"
#include "scene/surface_color.h"
#include "tool/interrupt.h"
#include "tool/lights_json.h"
#include "tool/materials_json.h"
#include "tool/model_summary.h"

namespace relume {
namespace {

class Setup {
 public:
  Setup(const Model& model, const LightingOptions& options, Console& console, const DirectLightSource& direct)
      : model_(model),
        options_(options),
        console_(console),
        direct_(direct),
        max_albedo_(options.max_albedo.value_or(model.max_albedo)) {}

  Result<LightingSetup> build() {
    setup_.lighting = stored_lighting(model_);
    setup_.lights = model_.lights;
    setup_.max_albedo = max_albedo_;
    clamp_albedo();
    for (const auto step :
         {&Setup::take_scene, &Setup::take_lights, &Setup::take_materials, &Setup::take_sky}) {
      if (const Result<void> done = (this->*step)(); !done) return tl::unexpected(done.error());
    }
    settle_rig();
    if (const Result<void> go_on = check_interrupted(); !go_on) return tl::unexpected(go_on.error());
    return finish();
  }

 private:
  void clamp_albedo() {
    if (!options_.scene && max_albedo_ > model_.max_albedo) {
      console_.warn(fmt::format(
          "--max-albedo {} does not raise the stored albedos, which were clamped to {}: --scene does.",
          max_albedo_, model_.max_albedo));
    }
    for (Rgb& albedo : setup_.lighting.albedo) albedo = glm::min(albedo, Rgb(max_albedo_));
  }

  Result<void> take_scene() {
    if (!options_.scene) return {};
    Result<Scene> scene = load_scene(*options_.scene);
    if (!scene) return tl::unexpected(scene.error());
    for (const std::string& warning : scene->warnings) console_.warn(warning);
    if (const Result<void> same = check_same_geometry(model_, *scene); !same) return same;
    ClusterColors colors = cluster_colors(model_, *scene, max_albedo_);
    warn_clamped(colors.clamped_materials);
    setup_.lighting.albedo = std::move(colors.albedo);
    setup_.lighting.exitance = std::move(colors.exitance);
    if (!model_.lit_by_rig || !scene->lights.empty()) setup_.lights = scene->lights;
    replaced_lights_ = !scene->lights.empty();
    setup_.scene = std::move(*scene);
    return {};
  }

  Result<void> take_lights() {
    if (!options_.lights) return {};
    Result<std::vector<Light>> lights = read_lights(*options_.lights);
    if (!lights) return tl::unexpected(lights.error());
    setup_.lights = std::move(*lights);
    replaced_lights_ = true;
    return {};
  }

  Result<void> take_materials() {
    if (!options_.materials) return {};
    const auto overrides = read_material_overrides(*options_.materials, model_);
    if (!overrides) return tl::unexpected(overrides.error());
    warn_clamped(apply_material_overrides(model_, *overrides, max_albedo_, setup_.lighting));
    for (const MaterialOverride& entry : *overrides) {
      setup_.replaced_materials.push_back(entry.material);
      const MaterialRecord& material = model_.materials[entry.material];
      if (entry.emission.value_or(Rgb(0.0)) == Rgb(0.0) || material.possible_emitter) continue;
      console_.warn(fmt::format(
          "Material '{}' emits now but was no possible emitter in the precompute: its light is noisier "
          "(extras.relume.emitter on its node prepares it).",
          material.name));
    }
    return {};
  }

  Result<void> take_sky() {
    if (!options_.sky) return {};
    if (model_.sky_cells.empty()) console_.warn("--sky has no effect: no ray of this model reached the sky.");
    if (const std::optional<Rgb> radiance = parse_triple(*options_.sky)) {
      setup_.sky = *radiance;
      return {};
    }
    Result<EquirectangularSky> image = load_sky(*options_.sky);
    if (!image) return tl::unexpected(image.error());
    setup_.sky = std::move(*image);
    return {};
  }

  /// The rig is for scenes that shine with nothing: any other light, emission or sky puts it out.
  void settle_rig() {
    const auto& exitance = setup_.lighting.exitance;
    const bool emits =
        std::any_of(exitance.begin(), exitance.end(), [](const Rgb& m) { return m != Rgb(0.0); });
    setup_.lit_by_rig = model_.lit_by_rig && !replaced_lights_ && !options_.sky && !emits;
    if (setup_.lit_by_rig) {
      setup_.sky = model_.sky_radiance.value_or(Rgb(0.0));
      console_.warn(rig_sentence(model_));
    } else if (model_.lit_by_rig && !replaced_lights_) {
      setup_.lights.clear();
    }
    const Rgb* constant = std::get_if<Rgb>(&setup_.sky);
    if (setup_.lights.empty() && !emits && constant && *constant == Rgb(0.0)) {
      console_.warn("Nothing shines: the result is black.");
    }
  }

  void warn_clamped(std::uint32_t materials) {
    if (materials > 0)
      console_.warn(fmt::format("The albedo of {} materials was clamped to {}.", materials, max_albedo_));
  }

  Result<LightingSetup> finish() {
    Result<DirectIrradiance> direct =
        direct_ ? direct_(model_, setup_.lights) : direct_irradiance(model_, setup_.lights);
    if (!direct) return tl::unexpected(direct.error());
    setup_.lighting.direct = std::move(direct->clusters);
    setup_.gather_direct = std::move(direct->gather);
    setup_.lighting.sky_radiosity = sky_radiosity(setup_.sky, model_.sky_cells, model_.sky_resolution);
    if (const Result<void> sound = check_lighting(model_, setup_.lighting); !sound)
      return tl::unexpected(sound.error());
    return std::move(setup_);
  }

  const Model& model_;
  const LightingOptions& options_;
  Console& console_;
  const DirectLightSource& direct_;
  double max_albedo_;
  bool replaced_lights_ = false;
  LightingSetup setup_;
};

}  // namespace

std::optional<Rgb> parse_triple(const std::string& text) {
  Rgb triple;
  const char* place = text.data();
  const char* const end = text.data() + text.size();
  for (int c = 0; c < 3; ++c) {
    const auto [next, code] = std::from_chars(place, end, triple[c]);
    if (code != std::errc() || !(triple[c] >= 0.0 && triple[c] <= 1e30)) return {};
    if (c < 2 && (next == end || *next != ',')) return {};
    place = c < 2 ? next + 1 : next;
  }
  if (place != end) return {};
  return triple;
}

Result<LightingSetup> set_up_lighting(const Model& model, const LightingOptions& options, Console& console,
                                      const DirectLightSource& direct) {
  return Setup(model, options, console, direct).build();
}

}  // namespace relume
