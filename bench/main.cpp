// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <regex>
#include <string>

#include "benchmarks.h"

namespace relume::bench {
namespace {

struct Arguments {
  bool list = false;
  bool csv = false;
  bool json = false;
  std::string run = ".*";
  std::vector<std::filesystem::path> scenes{{}};
  BenchmarkOptions options;
};

int list_benchmarks() {
  for (const Benchmark& benchmark : benchmarks()) fmt::print("{:<22} {}\n", benchmark.name, benchmark.what);
  return 0;
}

/// One scene after the other; their names go before those of what was measured when there are several.
Measurements run_benchmark(const Benchmark& benchmark, const Arguments& arguments) {
  std::vector<Measurement> all;
  for (const std::filesystem::path& scene : arguments.scenes) {
    BenchmarkOptions options = arguments.options;
    options.scene = scene;
    auto measured = benchmark.run(options);
    if (!measured) return measured;
    for (Measurement& one : *measured) {
      one.benchmark = benchmark.name;
      if (arguments.scenes.size() > 1) one.name = scene.stem().string() + ": " + one.name;
      all.push_back(std::move(one));
    }
  }
  return all;
}

int run_benchmarks(const Arguments& arguments) {
  const std::regex wanted(arguments.run);
  std::vector<Measurement> all;
  for (const Benchmark& benchmark : benchmarks()) {
    if (!std::regex_search(benchmark.name, wanted)) continue;
    const auto measured = run_benchmark(benchmark, arguments);
    if (!measured) {
      fmt::print(stderr, "relume-bench: {}: {}\n", benchmark.name, measured.error().message);
      return static_cast<int>(measured.error().code);
    }
    all.insert(all.end(), measured->begin(), measured->end());
  }
  if (all.empty()) {
    fmt::print(stderr, "relume-bench: no benchmark matches \"{}\"; --list names them\n", arguments.run);
    return static_cast<int>(ErrorCode::usage);
  }
  fmt::print("{}", arguments.json ? as_json(all) : arguments.csv ? as_csv(all) : as_table(all));
  return 0;
}

}  // namespace
}  // namespace relume::bench

int main(int argc, char** argv) {
  relume::bench::Arguments arguments;
  CLI::App app("Measures Relume. Every benchmark checks its answers first.", "relume-bench");
  app.add_flag("--list", arguments.list, "Names the benchmarks");
  app.add_option("--run", arguments.run, "Runs those whose names match a regular expression");
  app.add_option("--repetitions", arguments.options.repetitions, "Times each measurement is taken")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--scene", arguments.scenes, "Scenes instead of the generated room")
      ->check(CLI::ExistingFile);
  app.add_option("--quality", arguments.options.quality, "Rays per lumel")->capture_default_str();
  app.add_option("--texel-size", arguments.options.texel_size,
                 "Metres; 0: about 12 k lumels, or as the precompute chooses for --error")
      ->capture_default_str();
  app.add_option("--error", arguments.options.error,
                 "Error target of the models of bounds, frame and tracking, and the only one of error")
      ->check(CLI::Range(1e-3, 1.0))
      ->capture_default_str();
  app.add_option("--budget", arguments.options.budget,
                 "Nodes of a tile of rows in precompute_vs_embree; 0: full rows")
      ->capture_default_str();
  auto* csv = app.add_flag("--csv", arguments.csv, "Prints CSV");
  app.add_flag("--json", arguments.json, "Prints JSON")->excludes(csv);
  try {
    app.parse(argc, argv);
    arguments.options.error_given = app.count("--error") > 0;
    return arguments.list ? relume::bench::list_benchmarks() : relume::bench::run_benchmarks(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(relume::ErrorCode::usage);
  } catch (const std::exception& error) {
    fmt::print(stderr, "relume-bench: {}\n", error.what());
    return static_cast<int>(relume::ErrorCode::usage);
  }
}
