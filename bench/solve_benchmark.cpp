// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <numeric>

#include "benchmarks.h"
#include "compute/row_kernels.h"
#include "compute/standalone/solver_session.h"
#include "compute/standalone/tune_row_kernel.h"
#include "measure/device_check.h"
#include "measure/recoded.h"

namespace relume::bench {
namespace {

/// Of irradiance, relative: sums of 32-bit numbers, and of halves, which are rounded by 2^-11.
constexpr double kTolerance = 1e-5, kHalfTolerance = 5e-4;
/// lm/m2: all light of the products that are timed.
constexpr double kLargestRadiosity = 1e5;
/// A time is the least of so many, one after the other.
constexpr int kTries = 7;
/// And takes no less than this, of one product so many times over if need be.
constexpr double kLeastSeconds = 2e-3, kMostTimes = 256.0;

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

using Variant = KernelVariant;

/// The first is plain CSR.
std::vector<Variant> variants(const StandaloneDevice& device) {
  using enum ValueCodec;
  std::vector<Variant> all;
  for (const ValueCodec codec : {f32, unorm16})
    all.push_back({RowKernel::row_per_thread, MatrixFetch::storage, codec, 1});
  all.push_back({RowKernel::row_per_thread, MatrixFetch::texels, unorm16, 1});
  for (const ValueCodec codec : {f32, unorm16, sqrt8}) {
    for (const RowKernel kernel : kRowKernels) {
      for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
        if (supports_row_kernel(device.host(), kernel)) all.push_back({kernel, fetch, codec, 8});
      }
    }
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels})
      all.push_back({default_tile_kernel(device.host()), fetch, codec, 8, true});
  }
  return all;
}

/// Something that does the gather product, and how long each time took.
struct Candidate {
  std::string name;
  std::function<Result<double>()> seconds;  ///< of one product
  std::vector<double> times{};
};

double seconds_taken(const SubmitTimes& times) {
  return times.gpu_seconds > 0.0 ? times.gpu_seconds : times.seconds;
}

/// The gather product on the device: imports and rows. What else its pass does is timed apart and taken off.
Result<double> device_seconds(SolverSession& session) {
  const auto once = session.run({.gather = true});
  if (!once) return tl::unexpected(once.error());
  const auto times = std::uint32_t(std::clamp(kLeastSeconds / seconds_taken(*once), 1.0, kMostTimes));
  double least_with = std::numeric_limits<double>::infinity(), least_without = least_with;
  for (int i = 0; i < kTries; ++i) {
    const auto with = session.run({.gather = true}, times);
    if (!with) return tl::unexpected(with.error());
    const auto without = session.run({}, times);
    if (!without) return tl::unexpected(without.error());
    least_with = std::min(least_with, seconds_taken(*with));
    least_without = std::min(least_without, seconds_taken(*without));
  }
  return std::max(least_with - least_without, 1e-9) / times;
}

Result<Candidate> device_candidate(StandaloneDevice& device, const Model& stored, const Lighting& lighting,
                                   const Variant& variant, std::deque<SolverSession>& sessions) {
  const std::string name = device.name().substr(0, 8) + ": " + name_of(variant);
  const Model model = recoded(stored, variant.codec, variant.tile_rows);
  SolverOptions options{.kernel = variant.kernel, .fetch = variant.fetch};
  if (variant.half_senders) options.half_senders_up_to = kLargestRadiosity;
  auto session = SolverSession::create(device, model, options, {});
  if (!session) return tl::unexpected(session.error());
  sessions.push_back(std::move(*session));
  SolverSession& kept = sessions.back();
  if (auto checked =
          check_device(kept, model, lighting, name, variant.half_senders ? kHalfTolerance : kTolerance);
      !checked)
    return tl::unexpected(checked.error());
  return Candidate{name, [&kept] { return device_seconds(kept); }};
}

using EigenMatrix = Eigen::SparseMatrix<float, Eigen::RowMajor>;
using EigenColors = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// The gather matrices of all systems in Eigen.
struct EigenProducts {
  std::vector<EigenMatrix> matrices;
  std::vector<EigenColors> in, out;
  std::vector<Eigen::VectorXf> channel_in, channel_out;

  explicit EigenProducts(const Model& model) {
    for (const System& system : model.systems) {
      const CsrMatrix rows = decode(system.gather);
      std::vector<Eigen::Triplet<float>> triplets;
      for (std::uint32_t row = 0; row < rows.rows; ++row) {
        for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e)
          triplets.emplace_back(int(row), int(rows.column_indices[e]), float(rows.values[e]));
      }
      EigenMatrix& matrix = matrices.emplace_back(rows.rows, rows.columns);
      matrix.setFromTriplets(triplets.begin(), triplets.end());
      in.push_back(EigenColors::Random(rows.columns, 4));
      out.push_back(EigenColors::Zero(rows.rows, 4));
      channel_in.push_back(in.back().col(0));
      channel_out.push_back(Eigen::VectorXf::Zero(rows.rows));
    }
  }

  template <class In, class Out>
  static void multiply(const EigenMatrix& matrix, const In& in, Out& out, bool all_cores) {
    if (!all_cores) {
      out.noalias() = matrix * in;
      return;
    }
    tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, matrix.rows(), 512), [&](const auto& range) {
      out.middleRows(range.begin(), Eigen::Index(range.size())).noalias() =
          matrix.middleRows(range.begin(), Eigen::Index(range.size())) * in;
    });
  }

  /// Red, green and blue: together in four right-hand sides, or one after the other.
  void colors(bool together, bool all_cores) {
    for (std::size_t s = 0; s < matrices.size(); ++s) {
      if (together) multiply(matrices[s], in[s], out[s], all_cores);
      for (int channel = 0; channel < 3 && !together; ++channel)
        multiply(matrices[s], channel_in[s], channel_out[s], all_cores);
    }
  }

  /// Whether the last products were what Eigen gives in double precision.
  bool right(bool together) const {
    for (std::size_t s = 0; s < matrices.size(); ++s) {
      const Eigen::VectorXd expected = matrices[s].cast<double>() * channel_in[s].cast<double>();
      const Eigen::VectorXd found =
          (together ? Eigen::VectorXf(out[s].col(0)) : channel_out[s]).cast<double>();
      if (!((found - expected).norm() <= 1e-5 * expected.norm())) return false;
    }
    return true;
  }
};

Result<Candidate> eigen_candidate(EigenProducts& products, bool together, bool all_cores) {
  const std::string name =
      fmt::format("Eigen RowMajor f32, {}, {}", together ? "4 right-hand sides" : "3 x 1 right-hand side",
                  all_cores ? "all cores" : "one core");
  products.colors(together, all_cores);
  if (!products.right(together)) return fail(ErrorCode::check_failed, name + " is wrong");
  return Candidate{name, [&products, together, all_cores]() -> Result<double> {
                     double least = std::numeric_limits<double>::infinity();
                     for (int i = 0; i < kTries; ++i)
                       least = std::min(least, seconds_of([&] { products.colors(together, all_cores); }));
                     return least;
                   }};
}

Result<Model> make_model(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  PrecomputeOptions chosen;
  chosen.error = options.error;
  chosen.texel_size = options.texel_size;
  chosen.codec = ValueCodec::f32;
  PrecomputeReport report;
  return precompute(*scene, chosen, report);
}

/// How many times as long `slow` takes as `fast`, in each repetition.
Measurement ratio(const std::string& name, const Candidate& slow, const Candidate& fast) {
  Measurement measured{name, "x", {}};
  for (std::size_t r = 0; r < slow.times.size(); ++r)
    measured.values.push_back(slow.times[r] / fast.times[r]);
  return measured;
}

/// The fastest in tiles with the codec, or null.
const Candidate* fastest_tiles(std::span<const Candidate> candidates, const std::string& codec) {
  const Candidate* best = nullptr;
  for (const Candidate& candidate : candidates) {
    const bool fits = candidate.name.find(": tiles") != std::string::npos && candidate.name.ends_with(codec);
    if (fits && (best == nullptr || median(candidate.times) < median(best->times))) best = &candidate;
  }
  return best;
}

void add_ratios(std::span<const Candidate> candidates, std::vector<Measurement>& result) {
  for (const char* codec : {"unorm16", "sqrt8"}) {
    const Candidate* best = fastest_tiles(candidates, codec);
    if (best == nullptr) return;
    for (const Candidate& other : candidates) {
      const bool plain = other.name.find("CSR") != std::string::npos, eigen = other.name.starts_with("Eigen");
      if (plain || eigen)
        result.push_back(ratio(fmt::format("{} / best {}", other.name, codec), other, *best));
    }
  }
}

/// What a program that starts would choose, from its own made-up matrix.
Result<void> add_tuned(StandaloneDevice& device, std::vector<Measurement>& result) {
  for (const ValueCodec codec : {ValueCodec::unorm16, ValueCodec::sqrt8}) {
    const auto times = time_row_kernels(device, codec);
    if (!times) return tl::unexpected(times.error());
    const RowKernelTime& best = times->front();
    result.push_back({"tuner: " + name_of({best.choice.kernel, best.choice.fetch, codec, 8}),
                      "s/product",
                      {best.seconds}});
  }
  return {};
}

}  // namespace

Measurements solve(const BenchmarkOptions& options) {
  const auto model = make_model(options);
  if (!model) return tl::unexpected(model.error());
  Lighting lighting = stored_lighting(*model);
  for (Rgb& direct : lighting.direct) direct = Rgb(1.0, 0.9, 0.8);
  EigenProducts products(*model);
  std::vector<Candidate> candidates;
  for (const bool together : {false, true}) {
    for (const bool all_cores : {false, true}) {
      auto candidate = eigen_candidate(products, together, all_cores);
      if (!candidate) return tl::unexpected(candidate.error());
      candidates.push_back(std::move(*candidate));
    }
  }
  auto device = StandaloneDevice::create({});
  std::deque<SolverSession> sessions;
  for (const Variant& variant : device ? variants(*device) : std::vector<Variant>{}) {
    auto candidate = device_candidate(*device, *model, lighting, variant, sessions);
    if (!candidate) return tl::unexpected(candidate.error());
    candidates.push_back(std::move(*candidate));
  }
  std::vector<double> bandwidth;
  for (std::uint32_t r = 0; r < options.repetitions; ++r) {
    bandwidth.push_back(read_bandwidth());
    for (Candidate& candidate : candidates) {
      const auto seconds = candidate.seconds();
      if (!seconds) return tl::unexpected(seconds.error());
      candidate.times.push_back(*seconds);
    }
  }
  double nonzeros = 0.0;
  for (const EigenMatrix& matrix : products.matrices) nonzeros += double(matrix.nonZeros());
  std::vector<Measurement> result{{"read bandwidth, all cores", "bytes/s", bandwidth},
                                  {"form factors of the gather", "", {nonzeros}}};
  for (const Candidate& candidate : candidates)
    result.push_back({candidate.name, "s/product", candidate.times});
  add_ratios(candidates, result);
  if (device) {
    if (auto tuned = add_tuned(*device, result); !tuned) return tl::unexpected(tuned.error());
  }
  return result;
}

}  // namespace relume::bench
