// SPDX-License-Identifier: MIT
#include "tool/precompute_command.h"

#include <fmt/format.h>

#include <charconv>
#include <future>

#include "core/model_file.h"
#include "precompute/process_memory.h"
#include "precompute/rows_file.h"
#include "scene/load_scene.h"
#include "tool/interrupt.h"
#include "tool/model_summary.h"
#include "tool/sensors_csv.h"

namespace relume {
namespace {

void say_update(const PrecomputeReport& report, Console& console) {
  constexpr std::size_t kNodesNamed = 5;
  const auto& nodes = report.changed_nodes;
  const std::size_t shown = std::min(nodes.size(), kNodesNamed);
  console.say(fmt::format("  {:.2f} of {:.1f} million rays traced again; {}{}{}",
                          1e-6 * double(report.traced_rays),
                          1e-6 * double(report.traced_rays + report.kept_rays),
                          nodes.empty() ? "no geometry has changed" : "changed: ",
                          fmt::join(nodes.begin(), nodes.begin() + std::ptrdiff_t(shown), ", "),
                          nodes.size() > shown ? fmt::format(" and {} more", nodes.size() - shown) : ""));
}

void say_report(const PrecomputeArguments& arguments, const PrecomputeReport& report,
                const ModelSummary& summary, std::uint64_t file_bytes, Console& console) {
  console.say(fmt::format("{}: {:.1f} MB in {:.1f} s, {:.1f} million rays", arguments.output.string(),
                          1e-6 * static_cast<double>(file_bytes), report.seconds_total,
                          1e-6 * static_cast<double>(report.rays + report.occlusion_rays)));
  for (const std::string& line : summary_lines(summary)) console.say("  " + line);
  const bool by_clearance = arguments.options.error > 0.0 && arguments.options.cluster_size <= 0.0;
  console.say(fmt::format("  --texel-size {:.3g} {} (m)", report.texel_size,
                          by_clearance ? "and clusters as small as the error asks for"
                                       : fmt::format("--cluster-size {:.3g}", report.cluster_size)));
  if (report.error.total() > 0.0) {
    console.say(fmt::format(
        "  estimated error {:.2g} %: clusters {:.2g} %, rays {:.2g} %, cut {:.2g} %, precision {:.2g} %",
        100.0 * report.error.total(), 100.0 * report.error.clusters, 100.0 * report.error.rays,
        100.0 * report.error.cut, 100.0 * report.error.precision));
  }
  if (report.projection) {
    console.say(fmt::format(
        "  reciprocity: form factors of the rays were off by {:.2g} %, changed by {:.2g} %; not reached at "
        "{:.2g} % of the area",
        100.0 * report.projection->asymmetry, 100.0 * report.projection->change,
        100.0 * report.projection->left));
  }
  if (arguments.update) say_update(report, console);
  if (report.hollow_area > 0.0) {
    console.say(
        fmt::format("  {:.6g} m2 inside of solids left out (--keep-hollows keeps them)", report.hollow_area));
  }
  if (report.invalid_lumels + report.split_lumels > 0) {
    console.say(fmt::format("  {} lumels inside geometry, {} split by a wall", report.invalid_lumels,
                            report.split_lumels));
  }
}

JsonValue projection_json(const std::optional<Projection>& projection) {
  if (!projection) return {};
  return JsonObject{{"asymmetry", projection->asymmetry},
                    {"change", projection->change},
                    {"left", projection->left},
                    {"iterations", projection->iterations}};
}

JsonObject report_json(const PrecomputeArguments& arguments, const PrecomputeReport& report,
                       const ModelSummary& summary, std::uint64_t file_bytes) {
  JsonObject object{{"file", arguments.output}};
  for (auto& member : summary_json(summary, file_bytes)) object.push_back(std::move(member));
  object.insert(object.end(), {{"texel_size", report.texel_size},
                               {"cluster_size", report.cluster_size},
                               {"rays", report.rays},
                               {"peak_memory", peak_resident_bytes()},
                               {"occlusion_rays", report.occlusion_rays},
                               {"traced_rays", report.traced_rays},
                               {"kept_rays", report.kept_rays},
                               {"changed_nodes", json_array(report.changed_nodes)},
                               {"invalid_lumels", report.invalid_lumels},
                               {"split_lumels", report.split_lumels},
                               {"hollow_area", report.hollow_area},
                               {"estimated_error", JsonObject{{"clusters", report.error.clusters},
                                                              {"rays", report.error.rays},
                                                              {"cut", report.error.cut},
                                                              {"precision", report.error.precision},
                                                              {"total", report.error.total()}}},
                               {"projection", projection_json(report.projection)},
                               {"seconds", JsonObject{{"surfaces", report.seconds_surfaces},
                                                      {"rays", report.seconds_rays},
                                                      {"rows", report.seconds_rows},
                                                      {"total", report.seconds_total}}}});
  return object;
}

Result<int> say_estimate(const PrecomputeArguments& arguments, const PrecomputeEstimate& estimate,
                         const PrecomputeReport& report, Console& console) {
  for (const std::string& warning : report.warnings) console.warn(warning);
  console.say(fmt::format("{}: about {} rows, {:.3g} million form factors, {:.1f} million rays",
                          arguments.scene.string(), estimate.rows, 1e-6 * double(estimate.nonzeros),
                          1e-6 * double(estimate.rays)));
  console.say(fmt::format("  about {:.1f} MB of file, {:.1f} s, {:.0f} MB of memory; nothing is written",
                          1e-6 * double(estimate.file_bytes), estimate.seconds,
                          1e-6 * double(estimate.memory_bytes)));
  console.say(
      fmt::format("  --texel-size {:.3g} --cluster-size {:.3g} (m)", report.texel_size, report.cluster_size));
  console.finish({{"dry_run", true},
                  {"rows", estimate.rows},
                  {"nonzeros", estimate.nonzeros},
                  {"rays", estimate.rays},
                  {"bytes", estimate.file_bytes},
                  {"seconds", estimate.seconds},
                  {"memory", estimate.memory_bytes},
                  {"texel_size", report.texel_size},
                  {"cluster_size", report.cluster_size}});
  return 0;
}

/// A word, or a spacing, or else a file.
Result<void> choose_probes(const std::string& asked, PrecomputeOptions& options) {
  if (asked == "none") return {};
  options.auto_probes = asked == "auto";
  if (options.auto_probes) return {};
  const auto [end, code] = std::from_chars(asked.data(), asked.data() + asked.size(), options.probe_spacing);
  if (code == std::errc() && end == asked.data() + asked.size()) {
    if (options.probe_spacing > 0.0) return {};
    return fail(ErrorCode::usage,
                fmt::format("--probes: expected none, auto, a spacing above 0 or a CSV, found '{}'.", asked));
  }
  options.probe_spacing = 0.0;
  auto probes = read_probes(asked);
  if (!probes) return tl::unexpected(probes.error());
  options.probes = std::move(*probes);
  return {};
}

/// Where the rows of a model lie.
std::filesystem::path rows_of(std::filesystem::path model) {
  return model += ".rows";
}

/// Whether what can be done beside other work may have a thread of its own.
std::launch policy_of(const PrecomputeArguments& arguments) {
  return arguments.options.threads == 1 ? std::launch::deferred : std::launch::async;
}

/// The rows of the model that is to be updated.
Result<std::optional<RowsFile>> read_old_rows(const PrecomputeArguments& arguments) {
  if (!arguments.update) return std::optional<RowsFile>();
  auto rows = start_reading_rows(rows_of(*arguments.update), policy_of(arguments));
  if (!rows) return tl::unexpected(rows.error());
  return std::optional<RowsFile>(std::move(*rows));
}

/// All that a precompute starts from.
struct Input {
  PrecomputeOptions options;
  Scene scene;
  std::optional<RowsFile> old_rows{};
};

/// Valid as long as the input stays where it is.
PrecomputeOptions options_of(const Input& input) {
  PrecomputeOptions options = input.options;
  if (input.old_rows) options.old_rows = &*input.old_rows;
  return options;
}

/// A scene that cannot be written later should not be traced first.
Result<Input> read_input(const PrecomputeArguments& arguments, Console& console) {
  if (const Result<void> ready = check_output(arguments.output); !ready && !arguments.dry_run)
    return tl::unexpected(ready.error());
  Input input{arguments.options, {}};
  if (arguments.sensors) {
    Result<std::vector<SensorPoint>> sensors = read_sensors(*arguments.sensors);
    if (!sensors) return tl::unexpected(sensors.error());
    input.options.sensors = std::move(*sensors);
  }
  if (const auto chosen = choose_probes(arguments.probes, input.options); !chosen)
    return tl::unexpected(chosen.error());
  auto reading = std::async(policy_of(arguments), [&] { return read_old_rows(arguments); });
  Result<Scene> scene = load_scene(arguments.scene);
  auto old_rows = reading.get();
  if (!old_rows) return tl::unexpected(old_rows.error());
  input.old_rows = std::move(*old_rows);
  if (arguments.update) input.options.old_rows_name = rows_of(*arguments.update).string();
  if (!scene) return tl::unexpected(scene.error());
  for (const std::string& warning : scene->warnings) console.warn(warning);
  input.scene = std::move(*scene);
  return input;
}

ProgressObserver observer(Console& console, const std::function<bool()>& go_on = {}) {
  return [&console, go_on](std::string_view stage, double fraction) {
    console.progress(stage, fraction);
    return !interrupted() && (!go_on || go_on());
  };
}

Result<int> run_dry(const PrecomputeArguments& arguments, Console& console) {
  const Result<Input> input = read_input(arguments, console);
  if (!input) return tl::unexpected(input.error());
  PrecomputeReport report;
  const auto estimate = estimate_precompute(input->scene, options_of(*input), report, observer(console));
  console.end_progress();
  if (!estimate) return tl::unexpected(estimate.error());
  return say_estimate(arguments, *estimate, report, console);
}

}  // namespace

Result<void> check_output(const std::filesystem::path& output) {
  const std::filesystem::path folder = output.has_parent_path() ? output.parent_path() : ".";
  std::error_code code;
  if (std::filesystem::is_directory(folder, code) && !std::filesystem::is_directory(output, code)) return {};
  return fail(ErrorCode::bad_input,
              fmt::format("{}: expected a file name in an existing folder, found none.", output.string()));
}

Result<PrecomputedFile> precompute_to_file(const PrecomputeArguments& arguments, Console& console,
                                           const std::function<bool()>& go_on) {
  const Result<Input> input = read_input(arguments, console);
  if (!input) return tl::unexpected(input.error());
  PrecomputedFile file;
  Result<Model> model = precompute(input->scene, options_of(*input), file.report, observer(console, go_on));
  console.end_progress();
  if (!model) return tl::unexpected(model.error());
  for (const std::string& warning : file.report.warnings) console.warn(warning);
  if (const Result<void> still = check_interrupted(); !still) return tl::unexpected(still.error());
  if (go_on && !go_on()) return fail(ErrorCode::cancelled, "stopped before the file was written");
  let_finish();
  auto writing = std::async(policy_of(arguments), [&] {
    return input->options.keep_rows ? write_parts(rows_of(arguments.output), file.report.rows.parts)
                                    : Result<void>();
  });
  auto summing = std::async(policy_of(arguments), [&] { return summarise_model(*model); });
  const Result<void> written = write_model(*model, arguments.output), rows_written = writing.get();
  file.summary = summing.get();
  for (const Result<void>* done : {&written, &rows_written}) {
    if (!*done) return tl::unexpected(done->error());
  }
  file.model = std::move(*model);
  file.bytes = std::filesystem::file_size(arguments.output);
  return file;
}

Result<int> run(const PrecomputeArguments& arguments, Console& console) {
  if (arguments.dry_run) return run_dry(arguments, console);
  const Result<PrecomputedFile> file = precompute_to_file(arguments, console);
  if (!file) return tl::unexpected(file.error());
  say_report(arguments, file->report, file->summary, file->bytes, console);
  console.finish(report_json(arguments, file->report, file->summary, file->bytes));
  return 0;
}

}  // namespace relume
