// SPDX-License-Identifier: MIT
#include "tool/factors_command.h"

#include <fmt/format.h>

#include "scene/load_scene.h"
#include "tool/interrupt.h"

namespace relume {
namespace {

void say_factors(const SurfaceFactors& result, Console& console) {
  for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
    console.say(fmt::format("from {} ({:.6g} m2) to", result.surfaces[i], result.areas[i]));
    double sum = 0.0;
    for (std::size_t j = 0; j < result.surfaces.size(); ++j) {
      const double factor = result.factors[i][j];
      sum += factor;
      if (factor > 0.0) {
        console.say(
            fmt::format("  {:.6f} +- {:.6f}  {}", factor, result.standard_error[i][j], result.surfaces[j]));
      }
    }
    console.say(fmt::format("  {:.6f} in all", sum));
  }
}

JsonArray rows_json(const std::vector<std::vector<double>>& rows) {
  JsonArray array;
  for (const std::vector<double>& row : rows) array.emplace_back(json_array(row));
  return array;
}

}  // namespace

Result<int> run(const FactorsArguments& arguments, Console& console) {
  const Result<Scene> scene = load_scene(arguments.scene);
  if (!scene) return tl::unexpected(scene.error());
  for (const std::string& warning : scene->warnings) console.warn(warning);
  const auto observe = [&](std::string_view stage, double fraction) {
    console.progress(stage, fraction);
    return !interrupted();
  };
  const Result<SurfaceFactors> result =
      surface_factors(*scene, arguments.grouping, arguments.rays, arguments.seed, arguments.threads, observe);
  console.end_progress();
  if (!result) return tl::unexpected(result.error());
  say_factors(*result, console);
  console.finish({{"surfaces", json_array(result->surfaces)},
                  {"areas", json_array(result->areas)},
                  {"factors", rows_json(result->factors)},
                  {"standard_error", rows_json(result->standard_error)}});
  return 0;
}

}  // namespace relume
