// SPDX-License-Identifier: MIT
#include "compute/standalone/tune_row_kernel.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "compute/row_kernels.h"
#include "compute/standalone/solver_session.h"

namespace relume {
namespace {

constexpr std::uint32_t kSenders = 2048, kTiles = 1024, kTileRows = 8, kEntries = 128;
constexpr int kTimes = 5;

/// A fixed sequence of numbers below 256 that look random.
std::uint32_t noise(std::uint32_t index) {
  return ((index * 2654435761u) ^ (index >> 7) * 40503u) >> 16 & 0xffu;
}

BlockMatrix tuning_matrix(ValueCodec codec) {
  BlockMatrixBuilder builder(kSenders, codec);
  std::vector<std::uint16_t> columns(kEntries);
  std::vector<double> values(std::size_t{kTileRows} * kEntries);
  constexpr std::uint32_t kStride = kSenders / kEntries;
  for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
    for (std::uint32_t c = 0; c < kEntries; ++c)
      columns[c] = static_cast<std::uint16_t>(c * kStride + noise(tile + c) % kStride);
    for (std::size_t v = 0; v < values.size(); ++v)
      values[v] = (1.0 + noise(tile + static_cast<std::uint32_t>(v))) / (256.0 * kEntries);
    builder.append_tile(columns, values, kTileRows);
  }
  return std::move(builder).finish();
}

/// One system whose gather matrix is the one above; its bounces have nothing to do.
Model tuning_model(ValueCodec codec) {
  Model model;
  System& system = model.systems.emplace_back();
  system.clusters.resize(kSenders);
  BlockMatrixBuilder empty(kSenders, codec);
  for (std::uint32_t i = 0; i < kSenders; ++i) {
    system.imports.push_back({0, i});
    empty.append_row({}, {});
  }
  system.bounce = std::move(empty).finish();
  system.gather = tuning_matrix(codec);
  return model;
}

Lighting tuning_lighting() {
  Lighting lighting{std::vector<Rgb>(kSenders, Rgb(0.5)), {}, std::vector<Rgb>(kSenders, Rgb(0.0)), {}};
  for (std::uint32_t i = 0; i < kSenders; ++i)
    lighting.exitance.emplace_back(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2));
  return lighting;
}

Result<double> least_seconds(SolverSession& session) {
  double least = 0.0;
  for (int i = 0; i < kTimes; ++i) {
    const auto times = session.run({.gather = true});
    if (!times) return tl::unexpected<Error>(times.error());
    const double seconds = times->gpu_seconds > 0.0 ? times->gpu_seconds : times->seconds;
    least = i == 0 ? seconds : std::min(least, seconds);
  }
  return least;
}

/// The irradiance, and the time that it took to find it again.
Result<std::pair<std::vector<Rgb>, double>> try_kernel(StandaloneDevice& device, const Model& model,
                                                       RowKernel kernel, MatrixFetch fetch) {
  auto session = SolverSession::create(device, model, {.kernel = kernel, .fetch = fetch}, {});
  if (!session) return tl::unexpected<Error>(session.error());
  if (auto lit = session->light(tuning_lighting(), {}); !lit) return tl::unexpected<Error>(lit.error());
  // The first run compiles on some drivers.
  if (auto ran = session->run({.restart = true, .gather = true}); !ran)
    return tl::unexpected<Error>(ran.error());
  auto irradiance = session->read_irradiance();
  if (!irradiance) return tl::unexpected<Error>(irradiance.error());
  const auto seconds = least_seconds(*session);
  if (!seconds) return tl::unexpected<Error>(seconds.error());
  return std::pair{std::move(*irradiance), *seconds};
}

}  // namespace

Result<std::vector<RowKernelTime>> time_row_kernels(StandaloneDevice& device, ValueCodec codec) {
  const Model model = tuning_model(codec);
  std::optional<std::vector<Rgb>> expected;
  std::vector<RowKernelTime> times;
  for (const RowKernel kernel : kRowKernels) {
    if (!supports_row_kernel(device.host(), kernel)) continue;
    for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
      auto tried = try_kernel(device, model, kernel, fetch);
      if (!tried) return tl::unexpected<Error>(tried.error());
      if (!expected) expected = tried->first;
      if (tried->first == *expected) times.push_back({kernel, fetch, tried->second});
    }
  }
  std::sort(times.begin(), times.end(),
            [](const RowKernelTime& a, const RowKernelTime& b) { return a.seconds < b.seconds; });
  return times;
}

}  // namespace relume
