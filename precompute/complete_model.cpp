// SPDX-License-Identifier: MIT
#include "precompute/complete_model.h"

#include <tbb/parallel_invoke.h>

#include <chrono>
#include <glm/geometric.hpp>
#include <iterator>

#include "precompute/light_samples.h"
#include "precompute/rig.h"
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

Result<void> sample_light(const ModelParts& parts, const PrecomputeOptions& options, const RayCaster& caster,
                          RowsKeeper* keeper, Model& model) {
  WholeElements whole;
  if (keeper != nullptr) whole = keeper->known_whole(parts.element_orders);
  Views views(parts.geometry, caster, keeper != nullptr ? keeper->change() : nullptr, options.keep_rows);
  if (auto added = add_light_samples(parts.geometry, caster, model, views, whole); !added) return added;
  if (keeper != nullptr) keeper->keep_whole(parts.element_orders, whole, views.take_answers());
  return {};
}

void light(const ModelParts& parts, const RayCaster& caster, RowsKeeper* keeper, Model& model,
           std::vector<std::string>& warnings) {
  const auto earlier = keeper != nullptr ? keeper->earlier_looks() : std::nullopt;
  EnclosedGrid looked;
  light_model(parts.scene, parts.geometry, caster, earlier ? &*earlier : nullptr, model, warnings, &looked);
  if (keeper != nullptr) keeper->keep_looks(std::move(looked));
}

}  // namespace

Result<Model> complete_model(const ModelParts& parts, const PrecomputeOptions& options, ValueCodec codec,
                             const RayCaster& caster, RowsKeeper* keeper, bool takes_rays,
                             PrecomputeReport& report) {
  Model model = start_model(parts, options.max_albedo);
  add_sensors(parts, options, model);
  Result<void> rows, samples;
  std::vector<std::string> of_surfaces, of_lights;
  const auto complete_surfaces = [&] {
    store_surfaces(parts, model, report);
    tbb::parallel_invoke([&] { samples = sample_light(parts, options, caster, keeper, model); },
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
  tbb::parallel_invoke(
      complete_rows, take_rays, [&] { light(parts, caster, keeper, model, of_lights); }, complete_surfaces);
  if (!rows) return tl::unexpected(rows.error());
  if (!samples) return tl::unexpected(samples.error());
  for (auto* warnings : {&of_surfaces, &of_lights})
    std::move(warnings->begin(), warnings->end(), std::back_inserter(report.warnings));
  return model;
}

}  // namespace relume
