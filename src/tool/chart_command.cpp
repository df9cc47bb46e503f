// SPDX-License-Identifier: MIT
#include "tool/chart_command.h"

#include <fmt/format.h>

#include "measure/statistics.h"
#include "scene/load_scene.h"
#include "tool/chart/charts.h"
#include "tool/chart/measure_charts.h"
#include "tool/chart/page.h"
#include "tool/output_folder.h"
#include "tool/stopwatch.h"

namespace relume {
namespace {

/// Charts that cannot be written later should not be measured first.
Result<void> check_output(const std::filesystem::path& output) {
  std::error_code code;
  std::filesystem::path existing = std::filesystem::absolute(output, code);
  while (!std::filesystem::exists(existing, code) && existing.has_relative_path())
    existing = existing.parent_path();
  if (std::filesystem::is_directory(existing, code)) return {};
  return fail(ErrorCode::bad_input,
              fmt::format("{}: expected a folder, or a place for one, found that {} is none.",
                          output.string(), existing.string()));
}

/// Without folders, which are this machine's own.
std::string command_line(const ChartArguments& arguments) {
  const ChartOptions& options = arguments.options;
  std::string line = "relume chart " + arguments.scene.filename().string() + " -o DIR";
  if (options.quick) line += " --quick";
  if (options.texel_size > 0.0) line += fmt::format(" --texel-size {:g}", options.texel_size);
  if (options.cluster_size > 0.0) line += fmt::format(" --cluster-size {:g}", options.cluster_size);
  if (options.threads > 0) line += fmt::format(" --threads {}", options.threads);
  if (!options.device_name.empty()) line += " --device vulkan:" + options.device_name;
  return line;
}

Facts all_facts(const ChartArguments& arguments, const ChartData& data, const std::string& load_before,
                double seconds) {
  Facts facts{{"scene", arguments.scene.filename().string()}, {"command", command_line(arguments)}};
  const Facts run = facts_of_this_run();
  facts.insert(facts.end(), run.begin(), run.end());
  facts.insert(
      facts.end(),
      {{"device", data.device},
       {"driver", data.driver},
       {"load average", fmt::format("before {}; after {} (1, 5, 15 minutes)", load_before, load_text())},
       {"took", fmt::format("{:.0f} s", seconds)},
       {"centre", fmt::format("{} clusters of {:.3g} m, {} lumels of {:.3g} m", data.clusters,
                              data.cluster_size, data.lumels, data.texel_size)},
       {"error",
        fmt::format("indirect irradiance at {} sensors spread over all surfaces by area, |I - I*| / |I*|, "
                    "root mean square over {} lights that no precompute knew; I* is extrapolated from "
                    "{} clusters and twice their size, and the finer alone is {:.2g} % from it",
                    data.sensors, data.lights, data.densest_clusters, 100.0 * data.densest_alone)}});
  return facts;
}

void say_front(const ChartData& data, Console& console) {
  console.say("  fastest for its error:");
  for (const RelightPoint& point : front_of(data)) {
    console.say(fmt::format("    {:>9.3g} ms {:>8.3g} %   {}", median(point.milliseconds),
                            100.0 * point.error.all_lights, name_of(point)));
  }
}

JsonArray front_json(const ChartData& data) {
  JsonArray front;
  for (const RelightPoint& point : front_of(data)) {
    front.emplace_back(JsonObject{{"axis", point.axis},
                                  {"value", point.value},
                                  {"milliseconds", median(point.milliseconds)},
                                  {"error", point.error.all_lights},
                                  {"bytes", point.bytes}});
  }
  return front;
}

JsonObject facts_json(const Facts& facts) {
  JsonObject object;
  for (const auto& [name, value] : facts) object.emplace_back(name, value);
  return object;
}

}  // namespace

Result<int> run(const ChartArguments& arguments, Console& console) {
  if (const Result<void> ready = check_output(arguments.output); !ready) return tl::unexpected(ready.error());
  Result<Scene> scene = load_scene(arguments.scene);
  if (!scene) return tl::unexpected(scene.error());
  for (const std::string& warning : scene->warnings) console.warn(warning);
  const ChartPlan plan = make_chart_plan(arguments.options, area_of(*scene));
  Stopwatch watch;
  const std::string load_before = load_text();
  const auto data = measure_charts(std::move(*scene), plan, arguments.options.device_name,
                                   [&](double fraction) { console.progress("charts", fraction); });
  console.end_progress();
  if (!data) return tl::unexpected(data.error());
  for (const std::string& note : data->notes) console.warn(note);

  const Facts facts = all_facts(arguments, *data, load_before, watch.lap());
  const std::vector<ChartAndTable> charts = make_charts(*data);
  OutputFolder folder(arguments.output);
  for (const ChartAndTable& one : charts) {
    folder.add(one.chart.name + ".csv", one.csv);
    folder.add(one.chart.name + ".svg", to_svg(one.chart));
  }
  const std::string title = "Relume, speed against error: " + arguments.scene.filename().string();
  folder.add("chart.html", chart_page(title, charts, facts, data->notes));
  if (auto written = folder.write(); !written) return tl::unexpected(written.error());

  console.say(fmt::format("{}: {} charts", (arguments.output / "chart.html").string(), charts.size()));
  say_front(*data, console);
  JsonArray files;
  for (const std::filesystem::path& path : folder.paths()) files.emplace_back(path);
  console.finish({{"files", std::move(files)}, {"facts", facts_json(facts)}, {"front", front_json(*data)}});
  return 0;
}

}  // namespace relume
