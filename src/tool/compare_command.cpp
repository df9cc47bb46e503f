// SPDX-License-Identifier: MIT
#include "tool/compare_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/compare.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "tool/direct_light.h"

namespace relume {
namespace {

/// Of direct irradiance, mean over all clusters.
constexpr double kDirectTolerance = 1e-3;

/// Values over gather rows, without the sensors of each system or without the lumels.
std::vector<Rgb> pick(const Model& model, const std::vector<Rgb>& gather_rows, bool sensors) {
  std::vector<Rgb> picked;
  auto row = gather_rows.begin();
  for (const System& system : model.systems) {
    const auto lumels_end = row + static_cast<std::ptrdiff_t>(system.lumels.size());
    const auto sensors_end = lumels_end + static_cast<std::ptrdiff_t>(system.sensors.size());
    picked.insert(picked.end(), sensors ? lumels_end : row, sensors ? sensors_end : lumels_end);
    row = sensors_end;
  }
  return picked;
}

std::vector<Comparison> compare_outputs(const Model& model, const SolveOutcome& gpu,
                                        const SolveOutcome& reference) {
  std::vector<Comparison> outputs{
      compare("radiosity of clusters", gpu.solution.radiosity, reference.solution.radiosity)};
  for (const bool sensors : {false, true}) {
    const std::vector<Rgb> values = pick(model, gpu.gathered, sensors);
    if (values.empty()) continue;
    outputs.push_back(compare(sensors ? "irradiance of sensors" : "irradiance of lumels", values,
                              pick(model, reference.gathered, sensors)));
  }
  if (!reference.moments.empty()) {
    const FlatMoments expected = flat_moments(reference.moments, reference.gathered);
    outputs.push_back(compare("directions of irradiance", flat_moments(gpu.moments, gpu.gathered).values,
                              expected.values, expected.magnitudes));
  }
  if (!reference.probes.empty()) {
    const FlatCoefficients expected = flat_coefficients(reference.probes);
    outputs.push_back(compare("coefficients of probes", flat_coefficients(gpu.probes).values, expected.values,
                              expected.magnitudes));
  }
  return outputs;
}

JsonObject output_json(const Comparison& output) {
  return {{"name", output.name},
          {"count", output.count},
          {"max_relative_error", output.max_relative_error},
          {"rms_relative_error", output.rms_relative_error},
          {"max_absolute_error", output.max_absolute_error},
          {"worst", JsonObject{{"index", output.worst_index},
                               {"channel", output.worst_channel},
                               {"value", output.worst_value},
                               {"reference", output.worst_reference}}},
          {"histogram", json_array(output.histogram)}};
}

/// Shares of the errors by power of ten, from large to small; powers that no output has are left out.
void say_histogram(const std::vector<Comparison>& outputs, Console& console) {
  for (std::size_t k = 0; k < outputs.front().histogram.size(); ++k) {
    const auto has = [k](const Comparison& output) { return output.histogram[k] > 0; };
    if (std::none_of(outputs.begin(), outputs.end(), has)) continue;
    const bool last = k + 1 == outputs.front().histogram.size();
    std::string line = last ? fmt::format("  {:<22}", fmt::format("below 1e-{:02}", k))
                            : fmt::format("  {:<22}", fmt::format("1e-{:02} to 1e-{:02}", k + 1, k));
    for (const Comparison& output : outputs) line += fmt::format(" {:>24}", output.histogram[k]);
    console.say(line);
  }
}

void say_table(const std::vector<Comparison>& outputs, Console& console) {
  const auto row = [&](const std::string& title, auto cell) {
    std::string line = fmt::format("  {:<22}", title);
    for (const Comparison& output : outputs) line += fmt::format(" {:>24}", cell(output));
    console.say(line);
  };
  row("relative error", [](const Comparison& output) { return output.name; });
  row("largest", [](const Comparison& output) { return fmt::format("{:.3g}", output.max_relative_error); });
  row("root mean square",
      [](const Comparison& output) { return fmt::format("{:.3g}", output.rms_relative_error); });
  row("worst at", [](const Comparison& output) {
    return fmt::format("{} {}", output.worst_index, "rgb"[output.worst_channel]);
  });
  row("  GPU", [](const Comparison& output) { return fmt::format("{:.9g}", output.worst_value); });
  row("  reference", [](const Comparison& output) { return fmt::format("{:.9g}", output.worst_reference); });
  say_histogram(outputs, console);
}

/// Sum of all differences over the sum of the reference. Shadow rays within rounding of an edge may go either
/// way, and a cluster at such an edge is then off by a sample: the largest error says little.
double mean_error(const std::vector<Rgb>& values, const std::vector<Rgb>& reference) {
  double off = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    for (int c = 0; c < 3; ++c) off += std::abs(values[i][c] - reference[i][c]), whole += reference[i][c];
  }
  return off > 0.0 ? off / whole : 0.0;
}

}  // namespace

Result<int> run(const CompareArguments& arguments, Console& console) {
  const Result<Model> model = read_model(arguments.file);
  if (!model) return tl::unexpected(model.error());
  const Result<LightingSetup> setup = set_up_lighting(*model, arguments.lighting, console);
  if (!setup) return tl::unexpected(setup.error());

  const StopRule rule = arguments.bounces ? StopRule{*arguments.bounces, 0.0} : StopRule{};
  SolverChoice choice;
  choice.reference = true;
  const Result<SolveOutcome> reference = solve(*model, setup->lighting, rule, choice, console);
  if (!reference) return tl::unexpected(reference.error());
  const StopRule same_bounces{reference->solution.bounces, 0.0};
  const Result<SolveOutcome> gpu = solve(*model, setup->lighting, same_bounces, arguments.solver, console);
  if (!gpu) return tl::unexpected(gpu.error());

  const std::vector<Comparison> outputs = compare_outputs(*model, *gpu, *reference);
  const Result<DirectIrradiance> direct =
      direct_by_vulkan(*model, setup->lights, arguments.solver.device_name);
  if (!direct) return tl::unexpected(direct.error());
  const double direct_error = mean_error(direct->clusters, setup->lighting.direct);
  const bool direct_passed = direct_error <= kDirectTolerance;
  const bool passed =
      direct_passed && std::all_of(outputs.begin(), outputs.end(), [&](const Comparison& output) {
        return output.max_relative_error <= arguments.tolerance;
      });
  console.say(fmt::format("{} against the reference after {} bounces: {} (tolerance {:g})", gpu->device,
                          same_bounces.max_bounces, passed ? "passed" : "FAILED", arguments.tolerance));
  say_table(outputs, console);
  console.say(
      fmt::format("Direct irradiance of clusters with shadows: {:.3g} off on average (tolerance {:g}){}",
                  direct_error, kDirectTolerance, direct_passed ? "" : ": FAILED"));
  JsonArray outputs_json;
  for (const Comparison& output : outputs) outputs_json.emplace_back(output_json(output));
  console.finish({{"device", gpu->device},
                  {"kernel", gpu->kernel},
                  {"bounces", same_bounces.max_bounces},
                  {"tolerance", arguments.tolerance},
                  {"lit_by_rig", setup->lit_by_rig},
                  {"direct_mean_error", direct_error},
                  {"outputs", std::move(outputs_json)},
                  {"passed", passed}});
  return passed ? 0 : static_cast<int>(ErrorCode::check_failed);
}

}  // namespace relume
