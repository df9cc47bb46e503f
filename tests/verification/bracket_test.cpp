// SPDX-License-Identifier: MIT
//
// What the bracket of a cut model promises: the solution of the full rows of the same rays lies inside.
#include "core/bracket.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

struct CutAndCode {
  std::uint32_t budget;
  ValueCodec codec;
};

PrecomputeOptions coarse() {
  PrecomputeOptions options;
  options.cluster_size = 0.3, options.texel_size = 0.15, options.quality = 128;
  return options;
}

SolutionBracket bracket(const Model& model, const Lighting& lighting) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lighting, {});
  if (!solution) throw std::runtime_error(solution.error().message);
  auto bracket = bracket_solution(matrices, reference_slack(model), lighting, solution->radiosity);
  if (!bracket) throw std::runtime_error(bracket.error().message);
  return std::move(*bracket);
}

/// `values` per gather row of `from`, in the order of the rows of `to`: lumels are told by their texel.
std::vector<Rgb> reordered(const Model& from, const std::vector<Rgb>& values, const Model& to) {
  std::map<std::tuple<std::size_t, std::uint16_t, std::uint16_t>, Rgb> by_texel;
  const auto first = gather_offsets(from);
  for (std::size_t s = 0; s < from.systems.size(); ++s) {
    const std::vector<Lumel>& lumels = from.systems[s].lumels;
    for (std::size_t l = 0; l < lumels.size(); ++l)
      by_texel[{s, lumels[l].x, lumels[l].y}] = values[first[s] + l];
  }
  std::vector<Rgb> result;
  for (std::size_t s = 0; s < to.systems.size(); ++s)
    for (const Lumel& lumel : to.systems[s].lumels) result.push_back(by_texel.at({s, lumel.x, lumel.y}));
  return result;
}

class BracketOfCutRows : public testing::TestWithParam<CutAndCode> {};

TEST_P(BracketOfCutRows, HoldsTheSolutionOfFullRowsAtEveryLumel) {
  const Scene scene = two_rooms();
  PrecomputeOptions options = coarse();
  const Model full = precompute_or_throw(scene, options);
  options.budget = GetParam().budget, options.codec = GetParam().codec;
  const Model cut = precompute_or_throw(scene, options);
  Light bulb;
  bulb.intensity = Rgb(100.0);
  bulb.position = {1.0, 1.7, 2.2};
  const LightSources sources{{bulb}, {}};
  const std::vector<Rgb> exact =
      reordered(full, solve_and_gather(full, light(full, scene, sources)).indirect, cut);
  const Bracket irradiance = bracket(cut, light(cut, scene, sources).lighting).irradiance;
  ASSERT_EQ(exact.size(), irradiance.low.size());
  for (std::size_t row = 0; row < exact.size(); ++row) {
    for (int channel = 0; channel < 3; ++channel) {
      // The solution of the full rows was iterated to 1e-6 of the largest radiosity, and stored as f32.
      const double slack = 1e-5 * exact[row][channel] + 1e-3;
      ASSERT_GE(exact[row][channel], irradiance.low[row][channel] - slack) << row;
      ASSERT_LE(exact[row][channel], irradiance.high[row][channel] + slack) << row;
    }
  }
  std::vector<double> widths = relative_widths(irradiance, exact);
  std::nth_element(widths.begin(), widths.begin() + widths.size() / 2, widths.end());
  RecordProperty("median_width", std::to_string(widths[widths.size() / 2]));
}

INSTANTIATE_TEST_SUITE_P(Budgets, BracketOfCutRows,
                         testing::Values(CutAndCode{64, ValueCodec::sqrt8},
                                         CutAndCode{256, ValueCodec::unorm16},
                                         CutAndCode{0, ValueCodec::sqrt8}));

}  // namespace
}  // namespace relume::test
