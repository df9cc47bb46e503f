// SPDX-License-Identifier: MIT
#include "precompute/complete_model.h"

#include <tbb/parallel_invoke.h>

#include <chrono>
#include <glm/geometric.hpp>
#include <utility>

#include "precompute/light_samples.h"
#include "precompute/views.h"

namespace relume {
namespace {

void add_sensors(const ModelParts& parts, const PrecomputeOptions& options, Model& model) {
  for (std::uint32_t i = 0; i < options.sensors.size(); ++i) {
    const SensorPoint& sensor = options.sensors[i];
    model.systems[parts.sensor_systems[i]].sensors.push_back(
        {sensor.position, glm::vec3(glm::normalize(sensor.normal)), i});
    model.sensor_names.push_back(sensor.name);
  }
}

void sample_light(const ModelParts& parts, const PrecomputeOptions& options, const RayCaster& caster,
                  RowsKeeper* keeper, Model& model) {
  WholeElements whole;
  if (keeper != nullptr) whole = keeper->known_whole(parts.element_orders);
  Views views(parts.geometry, caster, keeper != nullptr ? keeper->change() : nullptr, options.keep_rows);
  add_light_samples(parts.geometry, caster, model, views, whole);
  if (keeper != nullptr) keeper->keep_whole(parts.element_orders, whole, views.take_answers());
}

}  // namespace

Result<Model> complete_model(ScenePart& scene_part, const ModelParts& parts, const PrecomputeOptions& options,
                             ValueCodec codec, const RayCaster& caster, RowsKeeper* keeper, bool takes_rays,
                             PrecomputeReport& report) {
  const auto known = scene_part.get();
  if (!known) return tl::unexpected(known.error());
  if (keeper != nullptr) keeper->keep_looks((*known)->looked);
  Model model = (*known)->model;
  start_model(parts, options.max_albedo, model);
  add_sensors(parts, options, model);
  Result<void> rows;
  std::vector<std::string> of_surfaces;
  const auto complete_surfaces = [&] {
    store_surfaces(parts, model, report);
    tbb::parallel_invoke([&] { sample_light(parts, options, caster, keeper, model); },
                         [&] {
                           store_colors(parts.scene, options.max_albedo, model, of_surfaces);
                           warn_of_invalid_lumels(model, of_surfaces);
                         });
  };
  const auto take_rays = [&] {
    if (takes_rays) keeper->take_rays();
  };
  const auto complete_rows = [&] {
    const auto start = std::chrono::steady_clock::now();
    rows = store_rows(parts, codec, model, report);
    report.seconds_rows = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  // The longest one last: the calling thread begins with it.
  tbb::parallel_invoke(complete_rows, take_rays, complete_surfaces);
  if (!rows) return tl::unexpected(rows.error());
  const std::vector<std::string>& of_lights = (*known)->warnings;
  for (const auto* warnings : {&std::as_const(of_surfaces), &of_lights})
    report.warnings.insert(report.warnings.end(), warnings->begin(), warnings->end());
  return model;
}

}  // namespace relume
