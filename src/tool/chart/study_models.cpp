// SPDX-License-Identifier: MIT
#include "tool/chart/study_models.h"

#include <fmt/format.h>

#include <map>

#include "compute/row_kernels.h"
#include "compute/standalone/solve_on_device.h"
#include "measure/recoded.h"

namespace relume {
namespace {

/// The light that is up while a device is checked and timed.
constexpr std::size_t kTimedLight = 2;

/// Studies the variants of one model.
class VariantStudy {
 public:
  VariantStudy(const ChartTest& test, StandaloneDevice& device, const Model& model,
               std::vector<Lighting> lightings, ModelStudy& study)
      : test_(test), device_(device), model_(model), lightings_(std::move(lightings)), study_(study) {}

  Result<void> add(const VariantPlan& plan) {
    if (plan.own_kernel && !supports_row_kernel(device_.host(), plan.kernel.kernel)) return {};
    const bool as_stored = study_.models.back().plan.options.error > 0.0;
    KernelVariant kernel = plan.kernel;
    if (as_stored) kernel.codec = model_.systems.front().bounce.blocks.front().codec;
    const Model variant = as_stored ? model_ : recoded(model_, kernel.codec, kernel.tile_rows);
    if (!plan.own_kernel) kernel.kernel = default_row_kernel(device_, variant);
    const auto relight = relit(kernel.codec, variant);
    if (!relight) return tl::unexpected(relight.error());
    Candidate candidate;
    candidate.relight = *relight;
    candidate.model = study_.models.size() - 1;
    candidate.point = make_point(plan, kernel, *relight);
    if (plan.role == PointRole::centre) study_.centre = variant, study_.centre_lightings = lightings_;
    return time_later(without_sensors(variant), std::move(candidate));
  }

 private:
  RelightPoint make_point(const VariantPlan& plan, const KernelVariant& kernel,
                          const SensorRelight& relight) const {
    RelightPoint point;
    point.axis = plan.axis, point.value = plan.value, point.role = plan.role;
    point.kernel = kernel;
    point.products = relight.products;
    point.error = measure_error(test_.answer.rooms, relight.stopped, test_.answer.values);
    return point;
  }

  /// The same values give the same light, however they are multiplied.
  Result<SensorRelight> relit(ValueCodec codec, const Model& variant) {
    const auto known = relights_.find(codec);
    if (known != relights_.end()) return known->second;
    auto relight = relight_sensors(sensor_matrices(variant), lightings_, test_.answer.rooms);
    if (relight) relights_.emplace(codec, *relight);
    return relight;
  }

  Result<void> time_later(const Model& bare, Candidate candidate) {
    candidate.point.form_factors = form_factors(bare), candidate.point.bytes = matrix_bytes(bare);
    const KernelVariant& kernel = *candidate.point.kernel;
    auto session = SolverSession::create(device_, bare, {.kernel = kernel.kernel, .fetch = kernel.fetch}, {});
    if (!session) return tl::unexpected(session.error());
    study_.sessions.push_back(std::move(*session));
    candidate.session = &study_.sessions.back();
    study_.candidates.push_back(std::move(candidate));
    return check_device(study_.sessions.back(), bare, lightings_[kTimedLight], name_of(kernel));
  }

  const ChartTest& test_;
  StandaloneDevice& device_;
  const Model& model_;
  std::vector<Lighting> lightings_;
  ModelStudy& study_;
  std::map<ValueCodec, SensorRelight> relights_;
};

PrecomputePoint make_point(const ModelPlan& plan, const ChartTest& test, const Model& model,
                           const PrecomputeReport& report, const SensorValues& values) {
  PrecomputePoint point;
  point.axis = plan.axis, point.value = plan.value, point.role = plan.role;
  point.error = measure_error(test.answer.rooms, values, test.answer.values);
  point.seconds = {report.seconds_total};
  point.rays = report.rays + report.occlusion_rays;
  const Model bare = without_sensors(model);
  point.form_factors = form_factors(bare), point.bytes = matrix_bytes(bare);
  return point;
}

void describe_centre(const Model& model, const PrecomputeReport& report, ChartData& data) {
  data.texel_size = report.texel_size, data.cluster_size = report.cluster_size;
  data.clusters = cluster_offsets(model).back();
  data.lumels = gather_offsets(model).back() - std::uint32_t(model.sensor_names.size());
}

Result<void> study_model(const ModelPlan& plan, const ChartTest& test, StandaloneDevice& device,
                         ChartProgress& progress, ModelStudy& study, ChartData& data) {
  PrecomputeOptions options = plan.options;
  options.sensors = test.scene.sensors;
  PrecomputeReport report;
  const auto model = precompute(test.scene.scene, options, report, progress.within(guessed_seconds(options)));
  if (!model) return tl::unexpected(model.error());
  auto lightings = test_lightings(*model, test.scene);
  if (!lightings) return tl::unexpected(lightings.error());
  const auto relight = relight_sensors(sensor_matrices(*model), *lightings, test.answer.rooms);
  if (!relight) return tl::unexpected(relight.error());
  study.models.push_back(
      {plan, report.error, relight->converged, make_point(plan, test, *model, report, relight->converged)});
  if (plan.role == PointRole::centre) describe_centre(*model, report, data);
  VariantStudy variants(test, device, *model, std::move(*lightings), study);
  for (const VariantPlan& variant : plan.variants) {
    if (auto added = variants.add(variant); !added) return added;
    if (auto go_on = check_interrupted(); !go_on) return go_on;
  }
  return {};
}

}  // namespace

double guessed_seconds(const PrecomputeOptions& options) {
  return options.error > 0.0 ? 8.0 : 1.0 + double(options.quality) / 400.0;
}

Result<ModelStudy> study_models(const ChartPlan& plan, const ChartTest& test, StandaloneDevice& device,
                                ChartProgress& progress, ChartData& data) {
  ModelStudy study;
  for (const ModelPlan& model : plan.models) {
    const auto studied = study_model(model, test, device, progress, study, data);
    const bool impossible =
        !studied && studied.error().code == ErrorCode::usage && model.role != PointRole::centre;
    if (impossible)
      data.notes.push_back(fmt::format("{} {}: {}", model.axis, model.value, studied.error().message));
    else if (!studied)
      return tl::unexpected(studied.error());
    if (auto go_on = progress.did(guessed_seconds(model.options) + 2.0); !go_on)
      return tl::unexpected(go_on.error());
  }
  return study;
}

Result<void> repeat_precomputes(std::uint32_t repetitions, const ChartTest& test, ChartProgress& progress,
                                ModelStudy& study) {
  for (std::uint32_t r = 0; r < repetitions; ++r) {
    for (StudiedModel& model : study.models) {
      PrecomputeOptions options = model.plan.options;
      options.sensors = test.scene.sensors;
      PrecomputeReport report;
      const double guessed = guessed_seconds(options);
      const auto again = precompute(test.scene.scene, options, report, progress.within(guessed));
      if (!again) return tl::unexpected(again.error());
      model.point.seconds.push_back(report.seconds_total);
      if (auto go_on = progress.did(guessed); !go_on) return go_on;
    }
  }
  return {};
}

Result<void> time_relights(std::uint32_t repetitions, ModelStudy& study) {
  for (std::uint32_t r = 0; r < repetitions; ++r) {
    for (Candidate& candidate : study.candidates) {
      const auto times =
          candidate.session->run({.restart = true, .bounces = candidate.point.products, .gather = true});
      if (!times) return tl::unexpected(times.error());
      candidate.point.milliseconds.push_back(
          1e3 * (times->gpu_seconds > 0.0 ? times->gpu_seconds : times->seconds));
      if (auto go_on = check_interrupted(); !go_on) return go_on;
    }
  }
  return {};
}

}  // namespace relume
