// SPDX-License-Identifier: MIT
#include "benchmarks.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <string>
#include <system_error>

#include "measure/converged_answer.h"
#include "scene/generate_scene.h"
#include "scene/load_scene.h"
#include "scene/write_glb.h"

namespace relume::bench {
namespace {

constexpr double kLumels = 12000.0;

constexpr std::array<Benchmark, 11> kBenchmarks{{
    {"precompute_vs_embree", "time of a precompute against that of bare Embree for the same rays",
     precompute_vs_embree},
    {"error", "error and size of models for error targets and flat budgets, against paths", error},
    {"bounds", "width of the bracket, and the certificate over the error, of models for an error target",
     bounds},
    {"sampling", "error of rows over clusters of 0.5 m and speed, of our rays and of random ones", sampling},
    {"shadow_rays", "shadow rays a second of the device against Embree, and milliseconds for lights",
     shadow_rays},
    {"solve", "form factors a second of the reference product and of each device kernel", solve},
    {"levels", "products of the methods that a device does, with albedos raised", levels},
    {"lightings", "a bounce and a gather for each of several lightings at once, against one alone",
     lightings},
    {"frame", "milliseconds of the stages of a frame, of what changes in it, and to the first one", frame},
    {"probes", "light between probes that are placed automatically, and between those of grids", probes},
    {"tracking", "how far frames of one and two bounces are behind a lamp on a circle", tracking},
}};

/// Through a file, as everybody's scene comes.
Result<Scene> generated_room() {
  const auto glb = generate_scene("demo");
  if (!glb) return tl::unexpected(glb.error());
  const auto file =
      std::filesystem::temp_directory_path() / ("relume-bench-" + std::to_string(getpid()) + ".glb");
  if (auto written = write_glb(*glb, file); !written) return tl::unexpected(written.error());
  auto scene = load_scene(file);
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return scene;
}

}  // namespace

std::span<const Benchmark> benchmarks() {
  return kBenchmarks;
}

Result<Scene> benchmark_scene(const BenchmarkOptions& options) {
  return options.scene.empty() ? generated_room() : load_scene(options.scene);
}

PrecomputeOptions precompute_options(const BenchmarkOptions& options, const Scene& scene) {
  PrecomputeOptions chosen;
  chosen.texel_size = options.texel_size > 0.0 ? options.texel_size : std::sqrt(area_of(scene) / kLumels);
  chosen.cluster_size = 3.0 * chosen.texel_size;
  chosen.quality = options.quality;
  return chosen;
}

Result<Model> model_with_error(const BenchmarkOptions& options, const Scene& scene) {
  PrecomputeOptions chosen;
  chosen.error = options.error;
  chosen.texel_size = options.texel_size;
  PrecomputeReport report;
  return precompute(scene, chosen, report);
}

}  // namespace relume::bench
