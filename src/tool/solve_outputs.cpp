// SPDX-License-Identifier: MIT
#include "tool/solve_outputs.h"

#include <fmt/format.h>

#include <algorithm>

#include "tool/auto_camera.h"
#include "tool/heat_color.h"
#include "tool/ktx2.h"
#include "tool/lightmap_image.h"
#include "tool/model_glb.h"
#include "tool/preview.h"
#include "tool/result_tables.h"
#include "tool/surface_shading.h"

namespace relume {
namespace {

/// The part of an array over gather rows that belongs to the lumels of system `s`.
std::span<const Rgb> lumels_of(const Model& model, std::size_t s, std::span<const Rgb> gather_rows) {
  return gather_rows.subspan(gather_offsets(model)[s], model.systems[s].lumels.size());
}

/// `stem`.exr, and `stem`.ktx2 when a format for it is asked for.
Result<void> add_lightmap(const System& system, std::span<const Rgb> lumels, const std::string& stem,
                          std::optional<LightmapFormat> ktx2, OutputFolder& folder, Console& console) {
  const auto too_bright = std::count_if(lumels.begin(), lumels.end(), [](const Rgb& value) {
    return std::max({value.x, value.y, value.z}) > double{kLargestHalf};
  });
  if (too_bright > 0) {
    console.warn(fmt::format("{}.exr: {} lumels above {} lux were clamped to what half precision holds.",
                             stem, too_bright, kLargestHalf));
  }
  const ColorImage image = lightmap_image(system, lumels);
  if (ktx2) folder.add(stem + ".ktx2", encode_ktx2(image, *ktx2));
  return folder.add(stem + ".exr", encode_exr(image));
}

Result<void> add_lightmaps(const Model& model, std::span<const Rgb> direct, std::span<const Rgb> indirect,
                           std::optional<LightmapFormat> ktx2, OutputFolder& folder, Console& console) {
  const std::vector<std::string> names = system_file_names(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    if (system.lightmap_width == 0) continue;
    const std::string stem = "lightmaps/" + names[s];
    const auto first =
        add_lightmap(system, lumels_of(model, s, direct), stem + ".direct", ktx2, folder, console);
    if (!first) return first;
    const auto second =
        add_lightmap(system, lumels_of(model, s, indirect), stem + ".indirect", ktx2, folder, console);
    if (!second) return second;
  }
  folder.add("lightmaps.json", lightmaps_json(model));
  return {};
}

/// Dominant directions of the indirect irradiance, of models that have them.
Result<void> add_directional(const Model& model, std::span<const Rgb> indirect,
                             const std::vector<IrradianceMoments>& moments, bool ktx2, OutputFolder& folder) {
  if (moments.empty()) return {};
  std::vector<Rgb> directions;
  for (std::size_t row = 0; row < moments.size(); ++row)
    directions.push_back(dominant_direction(moments[row], indirect[row]));
  const std::vector<std::string> names = system_file_names(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    if (model.systems[s].lightmap_width == 0) continue;
    const ColorImage image = lightmap_image(model.systems[s], lumels_of(model, s, directions));
    const std::string stem = "lightmaps/" + names[s] + ".directional";
    if (const auto added = folder.add(stem + ".exr", encode_exr(image)); !added) return added;
    if (ktx2) folder.add(stem + ".ktx2", encode_ktx2(image, LightmapFormat::direction_rgba16f));
  }
  return {};
}

/// Least, most and width of the indirect irradiance.
Result<void> add_bounds(const Model& model, std::span<const Rgb> indirect, const Bracket& bracket,
                        OutputFolder& folder, Console& console) {
  const std::vector<std::string> names = system_file_names(model);
  std::vector<Rgb> heat;
  for (const double width : relative_widths(bracket, {indirect.begin(), indirect.end()}))
    heat.push_back(heat_color(width));
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    if (system.lightmap_width == 0) continue;
    const std::string stem = "lightmaps/" + names[s];
    const auto add = [&](const std::vector<Rgb>& values, const char* what) {
      return add_lightmap(system, lumels_of(model, s, values), stem + what, {}, folder, console);
    };
    if (const auto low = add(bracket.low, ".low"); !low) return low;
    if (const auto high = add(bracket.high, ".high"); !high) return high;
    const ColorImage image = lightmap_image(system, lumels_of(model, s, heat));
    if (const auto width = folder.add(stem + ".width.png", encode_png(srgb_image(image))); !width)
      return width;
  }
  return {};
}

/// Standard errors of the indirect irradiance.
Result<void> add_noise(const Model& model, std::span<const Rgb> noise, OutputFolder& folder,
                       Console& console) {
  const std::vector<std::string> names = system_file_names(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    if (model.systems[s].lightmap_width == 0) continue;
    const auto added = add_lightmap(model.systems[s], lumels_of(model, s, noise),
                                    "lightmaps/" + names[s] + ".noise", {}, folder, console);
    if (!added) return added;
  }
  return {};
}

Result<void> add_probes(const Model& model, std::span<const ProbeCoefficients> coefficients,
                        OutputFolder& folder) {
  if (coefficients.empty()) return {};
  folder.add("probes.csv", probes_csv(model, coefficients));
  return folder.add("probes.exr", probes_exr(model, coefficients));
}

/// What each lumel looks like on a screen.
ByteImage shaded_lightmap(const Model& model, std::size_t s, const Lighting& lighting,
                          std::span<const Rgb> irradiance, const ToneCurve& curve) {
  const System& system = model.systems[s];
  const std::span<const Rgb> lumels = lumels_of(model, s, irradiance);
  const std::uint32_t first_cluster = cluster_offsets(model)[s];
  std::vector<Rgb> radiance;
  for (std::size_t i = 0; i < system.lumels.size(); ++i) {
    const std::size_t cluster = first_cluster + system.elements[system.lumels[i].element].cluster;
    radiance.push_back(
        radiance_from_radiosity(lighting.exitance[cluster] + lighting.albedo[cluster] * lumels[i]));
  }
  const ColorImage linear = lightmap_image(system, radiance);
  ByteImage image(linear.width, linear.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = srgb_bytes(tone_mapped(curve, Rgb(linear.pixels[i])));
  }
  return image;
}

Result<void> add_pictures(const Model& model, const LightingSetup& setup, const std::vector<Rgb>& irradiance,
                          OutputFolder& folder) {
  const Result<RayCaster> caster =
      RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
  if (!caster) return tl::unexpected(caster.error());
  const FineColors colors{setup.scene ? &*setup.scene : nullptr, setup.max_albedo, setup.replaced_materials};
  const SurfaceShading shading(model, setup.lighting, irradiance, colors);
  const auto radiance = [&](const SeenPoint& point) { return shading.radiance(point); };
  const ViewedScene scene{model, *caster, radiance, setup.sky};
  const std::vector<Rgb> samples = cast_picture(scene, choose_camera(scene));
  const ToneCurve curve = fit_tone_curve(samples);

  std::vector<ByteImage> textures;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    textures.push_back(shaded_lightmap(model, s, setup.lighting, irradiance, curve));
  }
  if (const auto added = folder.add("result.glb", encode_model_glb(model, textures)); !added) return added;
  return folder.add("preview.png", encode_png(develop(samples, curve)));
}

}  // namespace

Result<void> make_solve_outputs(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome,
                                const ToldErrors& told, std::optional<LightmapFormat> ktx2,
                                OutputFolder& folder, Console& console) {
  const std::vector<Rgb>& indirect = outcome.gathered;
  const std::vector<Rgb>& direct = setup.gather_direct;
  if (const auto added = add_lightmaps(model, direct, indirect, ktx2, folder, console); !added) return added;
  if (const auto added = add_directional(model, indirect, outcome.moments, ktx2.has_value(), folder); !added)
    return added;
  if (told.bracket) {
    const auto added = add_bounds(model, indirect, told.bracket->irradiance, folder, console);
    if (!added) return added;
  }
  if (told.noise) {
    const auto added = add_noise(model, told.noise->irradiance, folder, console);
    if (!added) return added;
  }
  const Bracket* radiosity = told.bracket ? &told.bracket->radiosity : nullptr;
  const Bracket* irradiance_bounds = told.bracket ? &told.bracket->irradiance : nullptr;
  folder.add("clusters.csv", clusters_csv(model, setup.lighting, outcome.solution.radiosity, radiosity,
                                          told.noise ? &told.noise->radiosity : nullptr));
  folder.add("sensors.csv", sensors_csv(model, direct, indirect, irradiance_bounds));
  if (const auto added = add_probes(model, outcome.probes, folder); !added) return added;
  std::vector<Rgb> irradiance(direct);
  for (std::size_t row = 0; row < irradiance.size(); ++row) irradiance[row] += indirect[row];
  return add_pictures(model, setup, irradiance, folder);
}

}  // namespace relume
