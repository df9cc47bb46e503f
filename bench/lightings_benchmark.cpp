// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <limits>

#include "benchmarks.h"
#include "compute/row_kernels.h"
#include "compute/standalone/solver_session.h"
#include "measure/device_check.h"
#include "measure/recoded.h"

namespace relume::bench {
namespace {

constexpr std::array<std::uint32_t, 3> kCounts{1, 2, 4};
/// A time is the least of so many, one after the other.
constexpr int kTriesTogether = 5;

/// A solver of so many lightings.
struct Candidate {
  std::uint32_t lightings = 1;
  SolverSession session;
  std::vector<double> bounces{}, gathers{};  ///< seconds, of each repetition
};

/// Lamps of its own for each lighting.
Lighting lighting_number(const Lighting& base, std::uint32_t number) {
  Lighting lighting = base;
  for (std::size_t i = 0; i < lighting.direct.size(); ++i)
    lighting.direct[i] = i % (number + 2) == 0 ? double(number + 1) * base.direct[i] : Rgb(0.0);
  return lighting;
}

/// Every lighting of `many` has the bits that `alone` gives it, whose own were checked.
Result<void> check(Candidate& alone, Candidate& many, const Lighting& base) {
  constexpr PassWishes kWishes{.restart = true, .bounces = 2, .gather = true};
  for (std::uint32_t i = 0; i < many.lightings; ++i) {
    if (auto lit = many.session.light(lighting_number(base, i), {}, i); !lit) return lit;
  }
  if (auto ran = many.session.run(kWishes); !ran) return tl::unexpected(ran.error());
  for (std::uint32_t i = 0; i < many.lightings; ++i) {
    const auto found = many.session.read_irradiance(i);
    if (!found) return tl::unexpected(found.error());
    if (auto lit = alone.session.light(lighting_number(base, i), {}); !lit) return lit;
    if (auto ran = alone.session.run(kWishes); !ran) return tl::unexpected(ran.error());
    const auto expected = alone.session.read_irradiance();
    if (!expected) return tl::unexpected(expected.error());
    if (*found != *expected)
      return fail(ErrorCode::check_failed,
                  fmt::format("lighting {} of {} is not what it is alone", i, many.lightings));
  }
  return {};
}

Result<double> least_seconds(SolverSession& session, const PassWishes& wishes) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTriesTogether; ++i) {
    const auto times = session.run(wishes);
    if (!times) return tl::unexpected(times.error());
    least = std::min(least, times->gpu_seconds > 0.0 ? times->gpu_seconds : times->seconds);
  }
  return least;
}

Result<void> take_times(Candidate& candidate) {
  const auto bounce = least_seconds(candidate.session, {.bounces = 1});
  if (!bounce) return tl::unexpected(bounce.error());
  const auto gather = least_seconds(candidate.session, {.gather = true});
  if (!gather) return tl::unexpected(gather.error());
  candidate.bounces.push_back(*bounce);
  candidate.gathers.push_back(*gather);
  return {};
}

Result<std::deque<Candidate>> make_candidates(StandaloneDevice& device, const Model& model,
                                              const Lighting& base, const KernelVariant& variant) {
  std::deque<Candidate> candidates;
  for (const std::uint32_t count : kCounts) {
    SolverOptions options{.kernel = variant.kernel, .fetch = variant.fetch};
    options.lightings = count;
    auto session = SolverSession::create(device, model, options, {~std::uint64_t{0}});
    if (!session) return tl::unexpected(session.error());
    candidates.push_back({count, std::move(*session)});
    if (count == 1) {
      auto checked = check_device(candidates[0].session, model, base, name_of(variant));
      if (!checked) return tl::unexpected(checked.error());
    }
    if (auto checked = check(candidates[0], candidates.back(), base); !checked)
      return tl::unexpected(checked.error());
  }
  return candidates;
}

/// Milliseconds of a lighting, and how many times as long a solver of one takes for it.
void report(const std::string& name, const Candidate& alone, const Candidate& many,
            std::vector<double> Candidate::*times, std::vector<Measurement>& result) {
  const std::string label = fmt::format("{}, {} at once", name, many.lightings);
  Measurement milliseconds{label, "ms/lighting", {}}, ratio{label + " / alone", "x", {}};
  for (std::size_t r = 0; r < (many.*times).size(); ++r) {
    const double seconds = (many.*times)[r] / many.lightings;
    milliseconds.values.push_back(1e3 * seconds);
    ratio.values.push_back(seconds / (alone.*times)[r]);
  }
  result.push_back(std::move(milliseconds));
  if (many.lightings > 1) result.push_back(std::move(ratio));
}

}  // namespace

Measurements lightings(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const auto stored = model_with_error(options, *scene);
  if (!stored) return tl::unexpected(stored.error());
  Lighting base = stored_lighting(*stored);
  for (Rgb& direct : base.direct) direct = Rgb(1000.0, 900.0, 800.0);
  auto device = StandaloneDevice::create({});
  if (!device) return tl::unexpected(device.error());
  std::vector<Measurement> result;
  for (const ValueCodec codec : {ValueCodec::unorm16, ValueCodec::sqrt8}) {
    const KernelVariant variant{default_tile_kernel(device->host()), MatrixFetch::texels, codec};
    const Model model = recoded(*stored, codec, variant.tile_rows);
    auto candidates = make_candidates(*device, model, base, variant);
    if (!candidates) return tl::unexpected(candidates.error());
    for (std::uint32_t r = 0; r < options.repetitions; ++r) {
      for (Candidate& candidate : *candidates) {
        if (auto timed = take_times(candidate); !timed) return tl::unexpected(timed.error());
      }
    }
    for (const Candidate& candidate : *candidates) {
      report(name_of(variant) + ": bounce", candidates->front(), candidate, &Candidate::bounces, result);
      report(name_of(variant) + ": gather", candidates->front(), candidate, &Candidate::gathers, result);
    }
  }
  return result;
}

}  // namespace relume::bench
