// SPDX-License-Identifier: MIT
//
// The promises of `solve --bounds` and `solve --certify` on whole scenes: the answer of the full rows of the
// same rays lies inside the bracket at every lumel, and the certificate is not much more than the error.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "benchmarks.h"
#include "core/bracket.h"
#include "core/row_certificate.h"
#include "core/same_surfaces.h"
#include "measure/converged_answer.h"
#include "measure/statistics.h"
#include "measure/test_lights.h"

namespace relume::bench {
namespace {

constexpr std::size_t kFewSensors = 16;  // of the test lights; rows of theirs are compared as well
/// What storing full rows in f32, and iterating, may be off by: of the value, and of the largest.
constexpr double kOfValue = 1e-5, kOfLargest = 1e-6;

struct Answer {
  Lighting lighting;
  std::vector<Rgb> radiosity, irradiance;
};

Result<Answer> answer_of(const Model& model, const ReferenceMatrices& matrices, const TestLight& light,
                         double tolerance) {
  auto lighting = test_lighting(model, light);
  if (!lighting) return tl::unexpected(lighting.error());
  const auto solution = solve_reference(matrices.bounce, *lighting, {10000, tolerance});
  if (!solution) return tl::unexpected(solution.error());
  auto irradiance = gather(matrices.gather, *lighting, solution->radiosity);
  return Answer{std::move(*lighting), solution->radiosity, std::move(irradiance)};
}

/// Values of one model in the order of the other.
std::vector<Rgb> moved(const std::vector<Rgb>& values, const std::vector<std::uint32_t>& at) {
  std::vector<Rgb> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[at[i]] = values[i];
  return out;
}

/// Of one light.
struct Promises {
  double outside = 0.0;      ///< share of rows that leave the bracket
  double width = 0.0;        ///< median of (high - low) / value
  double untold = 0.0;       ///< the same without halvings
  double certificate = 0.0;  ///< over the true error, root mean square
  double off = 0.0;          ///< that error, relative to the answer
};

double outside_share(const Bracket& bracket, const std::vector<Rgb>& exact) {
  double largest = 0.0;
  for (const Rgb& value : exact) largest = std::max({largest, value.x, value.y, value.z});
  std::size_t outside = 0;
  for (std::size_t row = 0; row < exact.size(); ++row) {
    bool inside = true;
    for (int channel = 0; channel < 3; ++channel) {
      const double value = exact[row][channel], slack = kOfValue * value + kOfLargest * largest;
      inside =
          inside && value >= bracket.low[row][channel] - slack && value <= bracket.high[row][channel] + slack;
    }
    if (!inside) ++outside;
  }
  return double(outside) / double(exact.size());
}

/// Two models of the same rays, and their matrices.
struct Pair {
  const Model &cut, &full;
  ReferenceMatrices cut_matrices, full_matrices;
  LooseMatrices loose, untold;  ///< of the cut one, and as they were without halvings
  SameSurfaces same;            ///< numbers of the full one per cluster and row of the cut one
};

Result<Promises> keep(const Pair& pair, const TestLight& light) {
  const auto cut = answer_of(pair.cut, pair.cut_matrices, light, 1e-5);
  if (!cut) return tl::unexpected(cut.error());
  const auto full = answer_of(pair.full, pair.full_matrices, light, 1e-9);
  if (!full) return tl::unexpected(full.error());
  const auto bracket = bracket_solution(pair.loose, cut->lighting, cut->radiosity);
  if (!bracket) return tl::unexpected(bracket.error());
  const auto untold = bracket_solution(pair.untold, cut->lighting, cut->radiosity);
  if (!untold) return tl::unexpected(untold.error());
  const std::vector<Rgb> answer = moved(cut->irradiance, pair.same.gather_rows);
  const auto certificate =
      certify_against(pair.full_matrices, full->lighting, moved(cut->radiosity, pair.same.clusters), answer);
  if (!certificate) return tl::unexpected(certificate.error());
  std::vector<Rgb> exact;
  for (const std::uint32_t row : pair.same.gather_rows) exact.push_back(full->irradiance[row]);
  Promises found;
  found.outside =
      std::max(outside_share(bracket->irradiance, exact), outside_share(untold->irradiance, exact));
  found.untold = median(relative_widths(untold->irradiance, cut->irradiance));
  found.width = median(relative_widths(bracket->irradiance, cut->irradiance));
  found.off = relative_difference(answer, full->irradiance);
  std::vector<Rgb> certified = full->irradiance;
  for (std::size_t row = 0; row < certified.size(); ++row) certified[row] += certificate->irradiance[row];
  found.certificate = relative_difference(certified, full->irradiance) / found.off;
  return found;
}

double halvings_share(const Model& model) {
  std::size_t halvings = 0, matrices = 0;
  for (const System& system : model.systems) {
    halvings += system.bounce_halvings.size() + system.gather_halvings.size();
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) {
      for (const MatrixBlock& block : matrix->blocks) matrices += block_bytes(block);
    }
  }
  return double(halvings) / double(matrices);
}

Result<Pair> pair_up(const Model& cut, const Model& full) {
  auto same = same_surfaces(full, cut);
  if (!same) return tl::unexpected(same.error());
  LooseMatrices loose = loose_matrices(cut), untold = loose;
  for (LooseRows* rows : {&untold.bounce, &untold.gather})
    rows->first_halving.assign(rows->rows.rows, kUntold);
  return Pair{cut,
              full,
              reference_matrices(cut),
              reference_matrices(full),
              std::move(loose),
              std::move(untold),
              std::move(*same)};
}

}  // namespace

Measurements bounds(const BenchmarkOptions& options) {
  auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const auto test = test_scene(std::move(*scene), kFewSensors);
  if (!test) return tl::unexpected(test.error());
  PrecomputeOptions chosen;
  chosen.error = options.error;
  chosen.texel_size = precompute_options(options, test->scene).texel_size;
  chosen.sensors = test->sensors;
  chosen.bounds = true;
  PrecomputeReport report;
  const auto cut = precompute(test->scene, chosen, report);
  if (!cut) return tl::unexpected(cut.error());
  chosen.bounds = false, chosen.budget = 65535, chosen.codec = ValueCodec::f32;
  const auto full = precompute(test->scene, chosen, report);
  if (!full) return tl::unexpected(full.error());
  const auto pair = pair_up(*cut, *full);
  if (!pair) return tl::unexpected(pair.error());
  std::vector<Measurement> result{
      {"bytes of halvings over those of all matrices", "", {halvings_share(*cut)}}};
  for (const TestLight& light : test->lights) {
    const auto found = keep(*pair, light);
    if (!found) return tl::unexpected(found.error());
    if (found->outside > 0.0) {
      return fail(ErrorCode::check_failed, fmt::format("{}: {:.3g} % of the rows lie outside of the bracket",
                                                       light.name, 100.0 * found->outside));
    }
    result.push_back({light.name + ": median width", "", {found->width}});
    result.push_back({light.name + ": median width without halvings", "", {found->untold}});
    result.push_back({light.name + ": error", "", {found->off}});
    result.push_back({light.name + ": certificate over error", "", {found->certificate}});
  }
  return result;
}

}  // namespace relume::bench
