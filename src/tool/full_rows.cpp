// SPDX-License-Identifier: MIT
#include "tool/full_rows.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/model.h"
#include "precompute/precompute.h"
#include "precompute/row_plan.h"
#include "precompute/rows_file.h"
#include "scene/load_scene.h"
#include "tool/interrupt.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

/// More nodes than a tile can see: nothing is cut.
constexpr std::uint32_t kNoBudget = 65535;

Result<fs::path> scene_of(const fs::path& rows, const Model& model, const std::optional<fs::path>& given) {
  const fs::path beside = rows.parent_path() / model.provenance.scene_file;
  std::error_code code;
  if (fs::is_regular_file(beside, code)) return beside;
  if (given) return *given;
  return fail(
      ErrorCode::bad_input,
      fmt::format("{}: expected the scene that its rays were traced in, {} beside it or --scene, found "
                  "neither",
                  rows.string(), model.provenance.scene_file));
}

/// What the model was asked for, but for its budget and how values are stored.
PrecomputeOptions options_of(const Model& model, const Scene& scene) {
  const auto said = nlohmann::json::parse(model.provenance.options, nullptr, /*allow_exceptions=*/false);
  const auto number = [&said](const char* key, auto otherwise) {
    if (!said.is_object() || !said.contains(key) || !said[key].is_number()) return otherwise;
    return said[key].get<decltype(otherwise)>();
  };
  PrecomputeOptions options;
  options.error = number("error", 0.0);
  // Where clusters are as small as the error asks for, their size was not.
  if (!said.is_object() || !said.contains("clearance")) options.cluster_size = number("cluster_size", 0.0);
  options.system_lumels = number("system_lumels", options.system_lumels);
  options.seed = number("seed", options.seed);
  options.max_albedo = model.max_albedo;
  options.reciprocal = said.is_object() && said.contains("reciprocal");
  options.keep_hollows = said.is_object() && said.contains("hollows");
  options.budget = kNoBudget, options.codec = ValueCodec::f32;
  const RowPlan chosen = plan_rows(options, scene);
  const std::uint32_t lumels = number("quality", 0u), sensors = number("sensor_quality", 0u);
  if (lumels != chosen.lumels.rays) options.quality = lumels;
  if (sensors != chosen.sensors.rays) options.sensor_quality = sensors;
  for (const System& system : model.systems) {
    for (const Sensor& sensor : system.sensors)
      options.sensors.push_back(
          {model.sensor_names[sensor.name], sensor.position, glm::dvec3(sensor.normal)});
  }
  return options;
}

}  // namespace

Result<Model> full_rows(const fs::path& rows, const Model& model, const std::optional<fs::path>& scene,
                        Console& console) {
  const auto rays = read_rows(rows);
  if (!rays) return tl::unexpected(rays.error());
  const auto file = scene_of(rows, model, scene);
  if (!file) return tl::unexpected(file.error());
  const Result<Scene> loaded = load_scene(*file);
  if (!loaded) return tl::unexpected(loaded.error());
  PrecomputeOptions options = options_of(model, *loaded);
  options.old_rows = &*rays, options.old_rows_name = rows.string();
  PrecomputeReport report;
  auto full = precompute(*loaded, options, report, [&console](std::string_view stage, double fraction) {
    console.progress(stage, fraction);
    return !interrupted();
  });
  console.end_progress();
  return full;
}

}  // namespace relume
