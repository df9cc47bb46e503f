// SPDX-License-Identifier: MIT
#include "tool/solve_command.h"

#include <fmt/format.h>

#include <new>

#include "core/model_file.h"
#include "tool/answer_certificate.h"
#include "tool/direct_light.h"
#include "tool/missing_systems.h"
#include "tool/named_errors.h"
#include "tool/solution_bounds.h"
#include "tool/solve_outputs.h"
#include "tool/stopwatch.h"

namespace relume {
namespace {

void say_result(const SolveArguments& arguments, const SolveOutcome& outcome, const OutputFolder& folder,
                double seconds, Console& console) {
  const Solution& solution = outcome.solution;
  const std::string& method = method_names()[std::size_t(outcome.method)];
  console.say(fmt::format("{} {} on {} in {:.2f} s in all", solution.bounces,
                          outcome.method == Method::bounces ? "bounces" : "products by " + method,
                          outcome.device, seconds));
  console.say(fmt::format("  method {}: {}", method, outcome.method_reason));
  console.say(fmt::format(
      "  residual {:.2g}, error bound {:.2g} (rounding {:.2g}), relative to the largest radiosity",
      solution.relative_residual, solution.error_bound, outcome.rounding_bound));
  console.say(fmt::format("  wrote {} files into {}", folder.paths().size(), arguments.output.string()));
  for (const std::filesystem::path& path : folder.paths()) console.say("    " + path.string());
}

JsonValue scene_json(const std::optional<ScenePrediction>& scene) {
  if (!scene) return {};
  return JsonObject{
      {"spectral_radius", scene->spectral_radius},
      {"closure", scene->closure},
      {"symmetry_defect", scene->symmetry_defect ? JsonValue(*scene->symmetry_defect) : JsonValue()},
      {"bounces_needed", scene->bounces}};
}

JsonObject result_json(const LightingSetup& setup, const std::string& direct_by, const SolveOutcome& outcome,
                       JsonObject seconds, const std::optional<MissingSystems>& missing,
                       const OutputFolder& folder) {
  const Solution& solution = outcome.solution;
  return {{"device", outcome.device},
          {"method", method_names()[std::size_t(outcome.method)]},
          {"method_reason", outcome.method_reason},
          {"method_fallback", solution.fallback.empty() ? JsonValue() : JsonValue(solution.fallback)},
          {"scene", scene_json(outcome.scene)},
          {"kernel", outcome.kernel.empty() ? JsonValue() : JsonValue(outcome.kernel)},
          {"bounces", solution.bounces},
          {"relative_residual", solution.relative_residual},
          {"error_bound", solution.error_bound},
          {"rounding_bound", outcome.rounding_bound},
          {"direct_light", direct_by},
          {"lit_by_rig", setup.lit_by_rig},
          {"missing_systems", missing_json(missing)},
          {"seconds", std::move(seconds)},
          {"files", json_array(folder.paths())}};
}

/// What is said of the answer beside its iteration.
struct Assurance {
  std::optional<NamedErrors> errors;
  std::optional<SolutionBounds> bounds;
  std::optional<AnswerCertificate> certificate;
};

Result<Assurance> assure(const SolveArguments& arguments, const Model& model, const LightingSetup& setup,
                         const SolveOutcome& outcome, Console& console) {
  Assurance assurance;
  if (arguments.bounds) {
    Result<NamedErrors> named = name_errors(model, setup, outcome);
    if (!named) return tl::unexpected(named.error());
    assurance.errors = *named;
    Result<SolutionBounds> found = bound_solution(model, setup.lighting, outcome, console);
    if (!found) return tl::unexpected(found.error());
    assurance.bounds = std::move(*found);
  }
  if (!arguments.certify.empty()) {
    Result<AnswerCertificate> found =
        certify_answer(model, outcome, arguments.certify, arguments.lighting, console);
    if (!found) return tl::unexpected(found.error());
    assurance.certificate = std::move(*found);
  }
  return assurance;
}

void say_assurance(const SolveArguments& arguments, const Assurance& assurance, Console& console) {
  if (assurance.errors) console.say(errors_sentence(*assurance.errors));
  if (assurance.bounds) console.say(bounds_sentence(*assurance.bounds));
  if (assurance.certificate) console.say(certificate_sentence(*assurance.certificate, arguments.certify));
}

/// Bytes that a solve takes beside the model: each form factor as a double and a column, once more while
/// rows are put together; with bounds, what it may be off by in two ways; a few numbers per row, and images.
std::uint64_t needed_memory(const Model& model, const SolveArguments& arguments) {
  constexpr std::uint64_t kOfFactor = 24, kOfBounds = 48, kOfRow = 1024, kOfTexel = 64;
  const std::uint64_t of_factor = kOfFactor + (arguments.bounds ? kOfBounds : 0);
  std::uint64_t bytes = 0;
  for (const System& system : model.systems) {
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather})
      bytes += of_factor * summarise(*matrix).nonzeros + kOfRow * matrix->rows;
    bytes += kOfTexel * system.lightmap_width * system.lightmap_height;
  }
  return bytes;
}

Result<int> solve_model(const SolveArguments& arguments, const Result<Model>& model, const Stopwatch& started,
                        double read_seconds, Console& console) {
  Stopwatch total = started;
  Stopwatch watch;
  std::string direct_by = kProcessor;
  DirectLightSource direct;
  if (!arguments.solver.reference)
    direct = direct_light_of_device(arguments.solver.device_name, console, direct_by);
  const Result<LightingSetup> setup = set_up_lighting(*model, arguments.lighting, console, direct);
  if (!setup) return tl::unexpected(setup.error());
  const double lighting_seconds = watch.lap();
  const Result<SolveOutcome> outcome =
      solve(*model, setup->lighting, arguments.rule, arguments.solver, console);
  if (!outcome) return tl::unexpected(outcome.error());
  watch.lap();
  const auto missing = bound_missing_light(*model, setup->lighting, *outcome, arguments.missing_radiosity,
                                           arguments.rule, arguments.solver, console);
  if (!missing) return tl::unexpected(missing.error());
  const double missing_seconds = watch.lap();
  if (*missing) {
    console.warn(missing_sentence(**missing, model->systems.size(), arguments.missing_radiosity.has_value()));
  }

  const Result<Assurance> assurance = assure(arguments, *model, *setup, *outcome, console);
  if (!assurance) return tl::unexpected(assurance.error());
  const std::optional<SolutionBounds>& bounds = assurance->bounds;
  const double bounds_seconds = watch.lap();

  OutputFolder folder(arguments.output);
  const std::optional<NamedErrors>& errors = assurance->errors;
  const ToldErrors told{bounds ? &bounds->bracket : nullptr,
                        errors && errors->noise ? &*errors->noise : nullptr};
  const auto made = make_solve_outputs(*model, *setup, *outcome, told, arguments.ktx2, folder, console);
  if (!made) return tl::unexpected(made.error());
  if (const Result<void> written = folder.write(); !written) return tl::unexpected(written.error());

  JsonObject seconds{{"read", read_seconds}, {"lighting", lighting_seconds}};
  for (const auto& member : outcome->seconds) seconds.push_back(member);
  seconds.emplace_back("missing", missing_seconds);
  seconds.emplace_back("bounds", bounds_seconds);
  seconds.emplace_back("outputs", watch.lap());
  const double total_seconds = total.lap();
  seconds.emplace_back("total", total_seconds);
  say_assurance(arguments, *assurance, console);
  say_result(arguments, *outcome, folder, total_seconds, console);
  JsonObject result = result_json(*setup, direct_by, *outcome, std::move(seconds), *missing, folder);
  if (errors) result.emplace_back("errors", errors_json(*errors));
  if (bounds) result.emplace_back("bounds", bounds_json(*bounds));
  if (assurance->certificate) result.emplace_back("certificate", certificate_json(*assurance->certificate));
  console.finish(std::move(result));
  return 0;
}

}  // namespace

Result<int> run(const SolveArguments& arguments, Console& console) {
  const Stopwatch started;
  Stopwatch watch;
  const Result<Model> model = arguments.systems.empty() ? read_model(arguments.file)
                                                        : read_systems(arguments.file, arguments.systems);
  if (!model) return tl::unexpected(model.error());
  try {
    return solve_model(arguments, model, started, watch.lap(), console);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory,
                fmt::format("{}: memory ran out: expected about {:.0f} MB beside the model, found less",
                            arguments.file.string(), 1e-6 * double(needed_memory(*model, arguments))));
  }
}

}  // namespace relume
