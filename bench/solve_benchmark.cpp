// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <numeric>

#include "benchmarks.h"
#include "compute/standalone/solve_on_device.h"
#include "core/compare.h"
#include "core/reference_solver.h"

namespace relume::bench {
namespace {

constexpr const char* kName = "solve";
constexpr std::uint32_t kBounces = 32;

/// Bytes a second that all cores read from an array far larger than the caches.
double read_bandwidth() {
  static const std::vector<std::uint32_t> data(std::size_t{1} << 27, 1u);
  std::uint32_t sum = 0;
  const double seconds = seconds_of([&] {
    using Range = tbb::blocked_range<std::size_t>;
    sum = tbb::parallel_reduce(
        Range(0, data.size(), 1 << 20), 0u,
        [&](const Range& range, std::uint32_t start) {
          return std::accumulate(data.begin() + std::ptrdiff_t(range.begin()),
                                 data.begin() + std::ptrdiff_t(range.end()), start);
        },
        std::plus<std::uint32_t>());
  });
  return sum == data.size() ? double(data.size() * sizeof(std::uint32_t)) / seconds : 0.0;
}

struct Variant {
  RowKernel kernel;
  MatrixFetch fetch;
  ValueCodec codec;
};

std::string name_of(const Variant& variant) {
  return fmt::format("{}, {}, {}", row_kernel_name(variant.kernel),
                     variant.fetch == MatrixFetch::texels ? "texels" : "storage",
                     variant.codec == ValueCodec::f32 ? "f32" : "unorm16");
}

std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16}) {
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
      for (const RowKernel kernel : {RowKernel::row_per_thread, RowKernel::row_per_8_lanes})
        all.push_back({kernel, fetch, codec});
    }
  }
  return all;
}

/// One model with all that a variant needs.
struct Problem {
  Model model;
  Lighting lighting;
  ReferenceMatrices matrices;
};

Result<Problem> make_problem(const BenchmarkOptions& options, const Scene& scene, ValueCodec codec) {
  PrecomputeOptions chosen = precompute_options(options, scene);
  chosen.codec = codec;
  PrecomputeReport report;
  auto model = precompute(scene, chosen, report);
  if (!model) return tl::unexpected(model.error());
  Problem problem{std::move(*model), {}, {}};
  problem.lighting = stored_lighting(problem.model);
  for (Rgb& direct : problem.lighting.direct) direct = Rgb(1.0, 0.9, 0.8);
  problem.matrices = reference_matrices(problem.model);
  return problem;
}

/// Form factors a second of plain bounces on the device, once per repetition; checked against the reference
/// first.
Result<std::vector<double>> device_speeds(StandaloneDevice& device, const Problem& problem,
                                          const Variant& variant, std::uint32_t repetitions) {
  const StopRule rule{kBounces, 0.0};
  DeviceSolveOptions options;
  options.kernel = variant.kernel;
  options.fetch = variant.fetch;
  const auto reference = solve_reference(problem.matrices.bounce, problem.lighting, rule);
  if (!reference) return tl::unexpected(reference.error());
  std::vector<double> speeds;
  for (std::uint32_t r = 0; r <= repetitions; ++r) {
    const auto solved = solve_on_device(device, problem.model, problem.lighting, rule, options);
    if (!solved) return tl::unexpected(solved.error());
    const double error =
        compare("radiosity", solved->solution.radiosity, reference->radiosity).max_relative_error;
    if (error > 1e-5) {
      return fail(ErrorCode::check_failed,
                  fmt::format("{}: {} differs from the reference by {}", kName, name_of(variant), error));
    }
    const double seconds =
        solved->seconds.gpu_bounces > 0.0 ? solved->seconds.gpu_bounces : solved->seconds.bounces;
    // The first run compiles kernels.
    if (r > 0) speeds.push_back(double(problem.matrices.bounce.rows.values.size()) * kBounces / seconds);
  }
  return speeds;
}

}  // namespace

Measurements solve(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  auto device = StandaloneDevice::create({});
  std::vector<Measurement> result;
  std::vector<double> bandwidth;
  for (std::uint32_t r = 0; r < options.repetitions; ++r) bandwidth.push_back(read_bandwidth());
  result.push_back({kName, "read bandwidth, all cores", "bytes/s", bandwidth});
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16}) {
    const auto problem = make_problem(options, *scene, codec);
    if (!problem) return tl::unexpected(problem.error());
    const double nonzeros = double(problem->matrices.bounce.rows.values.size());
    if (codec == ValueCodec::f32) {
      result.push_back({kName, "form factors of one bounce", "", {nonzeros}});
      std::vector<double> speeds;
      for (std::uint32_t r = 0; r < options.repetitions; ++r) {
        speeds.push_back(
            nonzeros / seconds_of([&] {
              if (bounce(problem->matrices.bounce, problem->lighting, problem->lighting.direct).empty())
                return;
            }));
      }
      result.push_back({kName, "reference product, one core, double", "form factors/s", speeds});
    }
    if (!device) continue;
    for (const Variant& variant : variants()) {
      if (variant.codec != codec) continue;
      const auto speeds = device_speeds(*device, *problem, variant, options.repetitions);
      if (!speeds) return tl::unexpected(speeds.error());
      result.push_back(
          {kName, device->name().substr(0, 8) + ": " + name_of(variant), "form factors/s", *speeds});
    }
  }
  return result;
}

}  // namespace relume::bench
