// SPDX-License-Identifier: MIT
#include "tool/chart/measure_charts.h"

#include "compute/standalone/standalone_device.h"
#include "tool/chart/split_errors.h"
#include "tool/chart/study_methods.h"
#include "tool/chart/study_models.h"
#include "tool/chart/study_tracking.h"

namespace relume {
namespace {

constexpr double kMethodsSeconds = 10.0, kTrackingSeconds = 10.0;

/// Of two precomputes that cast hardly more than the rays of the sensors.
double answer_seconds(const ChartPlan& plan) {
  return 2.0 + 2e-7 * double(plan.sensors) * double(plan.answer.sensor_quality);
}

double guessed_total(const ChartPlan& plan) {
  double total = answer_seconds(plan) + kMethodsSeconds + kTrackingSeconds + kGuessedSecondsOfSplit +
                 guessed_seconds_of_products(plan);
  for (const ModelPlan& model : plan.models)
    total += plan.precompute_repetitions * guessed_seconds(model.options) + 2.0;
  return total;
}

Result<ChartTest> make_test(Scene scene, const ChartPlan& plan, ChartProgress& progress) {
  auto made = test_scene(std::move(scene), plan.sensors);
  if (!made) return tl::unexpected(made.error());
  PrecomputeOptions options;
  options.sensors = made->sensors, options.threads = plan.models.front().options.threads;
  auto answer = converged_answer(*made, options, plan.answer, progress.within(answer_seconds(plan)));
  if (!answer) return tl::unexpected(answer.error());
  if (auto go_on = progress.did(answer_seconds(plan)); !go_on) return tl::unexpected(go_on.error());
  return ChartTest{std::move(*made), std::move(*answer)};
}

void describe(const ChartTest& test, const StandaloneDevice& device, ChartData& data) {
  data.densest_alone = measure_error(test.answer.rooms, test.answer.densest, test.answer.values).all_lights;
  data.densest_clusters = test.answer.clusters;
  data.sensors = std::uint32_t(test.scene.sensors.size()),
  data.lights = std::uint32_t(test.scene.lights.size());
  data.device = device.name(), data.driver = device.driver();
}

/// All that needs the models.
Result<void> measure_models(const ChartPlan& plan, const ChartTest& test, StandaloneDevice& device,
                            ChartProgress& progress, ChartData& data) {
  auto study = study_models(plan, test, device, progress, data);
  if (!study) return tl::unexpected(study.error());
  if (auto timed = time_relights(plan.relight_repetitions, *study); !timed) return timed;
  if (auto repeated = repeat_precomputes(plan.precompute_repetitions - 1, test, progress, *study); !repeated)
    return repeated;
  if (auto split = split_errors(test, progress, *study); !split) return split;
  auto methods = time_methods(test, *study, data);
  if (!methods) return tl::unexpected(methods.error());
  if (auto go_on = progress.did(kMethodsSeconds); !go_on) return go_on;
  auto tracking = track_light(plan, test, *study);
  if (!tracking) return tl::unexpected(tracking.error());
  data.tracking = std::move(*tracking);
  for (Candidate& candidate : study->candidates) data.relights.push_back(std::move(candidate.point));
  data.relights.insert(data.relights.end(), methods->begin(), methods->end());
  for (StudiedModel& model : study->models) data.precomputes.push_back(std::move(model.point));
  return progress.did(kTrackingSeconds);
}

}  // namespace

Result<ChartData> measure_charts(Scene scene, const ChartPlan& plan, const std::string& device_name,
                                 const std::function<void(double)>& show) {
  auto device = StandaloneDevice::create({.device_name = device_name});
  if (!device) return tl::unexpected(device.error());
  ChartProgress progress(show, guessed_total(plan));
  const auto test = make_test(std::move(scene), plan, progress);
  if (!test) return tl::unexpected(test.error());
  ChartData data;
  describe(*test, *device, data);
  if (auto measured = measure_models(plan, *test, *device, progress, data); !measured)
    return tl::unexpected(measured.error());
  if (auto counted = count_products(plan, *test, progress, data); !counted)
    return tl::unexpected(counted.error());
  return data;
}

}  // namespace relume
