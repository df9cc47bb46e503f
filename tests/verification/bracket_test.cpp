// SPDX-License-Identifier: MIT
//
// What the bracket of a cut model promises: the solution of the full rows of the same rays lies inside.
#include "core/bracket.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

#include "core/row_certificate.h"
#include "core/same_surfaces.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

struct CutAndCode {
  std::uint32_t budget;
  ValueCodec codec;
  bool bounds = false;
};

PrecomputeOptions coarse() {
  PrecomputeOptions options;
  options.cluster_size = 0.3, options.texel_size = 0.15, options.quality = 128;
  return options;
}

Light bulb() {
  Light light;
  light.intensity = Rgb(100.0);
  light.position = {1.0, 1.7, 2.2};
  return light;
}

SolutionBracket bracket(const Model& model, const Lighting& lighting) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lighting, {});
  if (!solution) throw std::runtime_error(solution.error().message);
  auto bracket = bracket_solution(loose_matrices(model), lighting, solution->radiosity);
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
  options.bounds = GetParam().bounds;
  const Model cut = precompute_or_throw(scene, options);
  const LightSources sources{{bulb()}, {}};
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
  EXPECT_EQ(GetParam().bounds, !cut.systems[0].bounce_halvings.empty());
  std::vector<double> widths = relative_widths(irradiance, exact);
  std::nth_element(widths.begin(), widths.begin() + widths.size() / 2, widths.end());
  RecordProperty("median_width", std::to_string(widths[widths.size() / 2]));
}

INSTANTIATE_TEST_SUITE_P(Budgets, BracketOfCutRows,
                         testing::Values(CutAndCode{64, ValueCodec::sqrt8},
                                         CutAndCode{64, ValueCodec::sqrt8, true},
                                         CutAndCode{256, ValueCodec::unorm16},
                                         CutAndCode{0, ValueCodec::sqrt8}));

/// In the order of another model: value i goes to place `at[i]`.
std::vector<Rgb> moved(const std::vector<Rgb>& values, const std::vector<std::uint32_t>& at) {
  std::vector<Rgb> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[at[i]] = values[i];
  return out;
}

// Against the rows before they were cut, for the lights that shine: never less than what the solution is off,
// and hardly more.
TEST(RowCertificate, IsHardlyMoreThanTheCutCosts) {
  const Scene scene = two_rooms();
  PrecomputeOptions options = coarse();
  options.cluster_size = 0.5, options.texel_size = 0.25;
  const Model full = precompute_or_throw(scene, options);
  options.budget = 64, options.codec = ValueCodec::sqrt8;
  const Model cut = precompute_or_throw(scene, options);
  const LightSources sources{{bulb()}, {}};
  const auto same = same_surfaces(full, cut);
  ASSERT_TRUE(same) << same.error().message;
  const Lighting of_cut = light(cut, scene, sources).lighting;
  const ReferenceMatrices cut_matrices = reference_matrices(cut);
  const auto answer = solve_reference(cut_matrices.bounce, of_cut, {});
  const Lighting lighting = light(full, scene, sources).lighting;
  const ReferenceMatrices matrices = reference_matrices(full);
  const auto exact = solve_reference(matrices.bounce, lighting, {10000, 1e-10});
  ASSERT_TRUE(answer && exact);
  const std::vector<Rgb> irradiance = gather(matrices.gather, lighting, exact->radiosity);
  const std::vector<Rgb> gathered =
      moved(gather(cut_matrices.gather, of_cut, answer->radiosity), same->gather_rows);

  const auto certificate =
      certify_against(matrices, lighting, moved(answer->radiosity, same->clusters), gathered);
  ASSERT_TRUE(certificate) << certificate.error().message;
  double bound = 0.0, off = 0.0;
  for (std::size_t row = 0; row < irradiance.size(); ++row) {
    const Rgb error = glm::abs(gathered[row] - irradiance[row]);
    for (int c = 0; c < 3; ++c) {
      ASSERT_LE(error[c], certificate->irradiance[row][c] * (1.0 + 1e-9) + 1e-9 * irradiance[row][c]) << row;
    }
    bound += glm::dot(certificate->irradiance[row], certificate->irradiance[row]);
    off += glm::dot(error, error);
  }
  EXPECT_GT(off, 0.0);
  EXPECT_LE(std::sqrt(bound), 1.2 * std::sqrt(off));
  EXPECT_LE(certificate->products, 12u);
}

TEST(RowCertificate, RefusesOtherSurfaces) {
  PrecomputeOptions options = coarse();
  options.quality = 8;
  const Model room = precompute_or_throw(box_room({}), options);
  EXPECT_NE(
      same_surfaces(room, precompute_or_throw(sealed_rooms(0.1), options)).error().message.find("scenes"),
      std::string::npos);
  options.cluster_size = 0.45;
  EXPECT_NE(same_surfaces(room, precompute_or_throw(box_room({}), options)).error().message.find("clusters"),
            std::string::npos);
}

}  // namespace
}  // namespace relume::test
