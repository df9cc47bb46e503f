// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/result.h"
#include "measurement.h"
#include "precompute/precompute.h"
#include "scene/scene.h"

namespace relume::bench {

struct BenchmarkOptions {
  std::uint32_t repetitions = 7;
  std::filesystem::path scene;  ///< empty: the generated furnished room
  std::uint32_t quality = 512;  ///< rays per lumel
  double texel_size = 0.0;      ///< m; 0: about 12 k lumels, or as the precompute chooses for an error
  double error = 0.05;          ///< target of the models of whole frames
  bool error_given = false;     ///< by the user
  std::uint32_t budget = 0;     ///< nodes of a tile where rays are counted; 0: full rows
};

/// Each checks its answers before it takes times, and fails (check_failed) when they are wrong.
using Measurements = Result<std::vector<Measurement>>;

struct Benchmark {
  const char* name;
  const char* what;
  Measurements (*run)(const BenchmarkOptions& options);
};

std::span<const Benchmark> benchmarks();

/// Time of a precompute, with as many rays for each row and rows cut where there is a budget, against that of
/// bare Embree for the same rays.
Measurements precompute_vs_embree(const BenchmarkOptions& options);

/// Form factors a second of the plain reference product and of each device kernel, against what memory gives.
Measurements solve(const BenchmarkOptions& options);

/// Errors of --error and --budget at sensors, for lights that the precompute has not seen, against paths
/// traced from them (measure/path_irradiance.h); of several targets and budgets, or of the target that was
/// given.
Measurements error(const BenchmarkOptions& options);

/// How wide the bracket of the full rows' answer is at the median lumel, for lights that the precompute has
/// not seen, and how much the certificate is over the error. Fails where an answer lies outside.
Measurements bounds(const BenchmarkOptions& options);

/// Errors of rows over clusters of 0.5 m, and rays a second, of our rays and of independent random ones.
Measurements sampling(const BenchmarkOptions& options);

/// Shadow rays a second of the device against Embree's, and the time that lights take.
Measurements shadow_rays(const BenchmarkOptions& options);

/// Products and milliseconds of the methods that a device does, with albedos raised.
Measurements levels(const BenchmarkOptions& options);

/// Milliseconds of a bounce and a gather for each of several lightings that a solver does at once, against
/// one alone.
Measurements lightings(const BenchmarkOptions& options);

/// Milliseconds of the stages of a frame, of lights that move, of new albedos, and to the first frame.
Measurements frame(const BenchmarkOptions& options);

/// How far frames are behind a lamp that moves, against the converged answer of each frame.
Measurements tracking(const BenchmarkOptions& options);

/// Errors of the light between light probes, placed automatically and on grids, for lights that the placement
/// has not seen, against probes at the points themselves; and how many probes a grid needs to be as good.
Measurements probes(const BenchmarkOptions& options);

/// The scene of `options`, and its precompute options.
Result<Scene> benchmark_scene(const BenchmarkOptions& options);
PrecomputeOptions precompute_options(const BenchmarkOptions& options, const Scene& scene);

/// A model of the scene with the error target of `options`.
Result<Model> model_with_error(const BenchmarkOptions& options, const Scene& scene);

}  // namespace relume::bench
