// SPDX-License-Identifier: MIT
//
// What stored values of few bits cost a solution: rows of the same rays, encoded three ways.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/scene_builder.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

/// Two furnished rooms, a door between them, a lamp in each; albedo 0.8 everywhere.
Scene bright_rooms() {
  Scene scene = two_rooms();
  for (SceneMaterial& material : scene.materials) material.base_color = Rgb(0.8);
  return scene;
}

struct Codes {
  std::uint32_t budget;
  ValueCodec codec;
  double most;  ///< of the relative error
};

/// Relative error (root mean square over lumels) of indirect irradiance, the worse of lamps and a point.
double precision_error(const Codes& codes) {
  const Scene lit = bright_rooms();
  Scene dark = lit;
  for (SceneMaterial& material : dark.materials) material.emission = Rgb(0.0);
  Light bulb;
  bulb.intensity = Rgb(100.0);
  bulb.position = {1.0, 1.7, 2.2};
  PrecomputeOptions options;
  options.cluster_size = 0.25, options.texel_size = 0.125, options.quality = 256;
  options.budget = codes.budget;
  const Model exact = precompute_or_throw(lit, options);
  options.codec = codes.codec;
  const Model coded = precompute_or_throw(lit, options);
  const auto compare = [&](const Scene& scene, const LightSources& sources) {
    const auto indirect = [&](const Model& model) {
      return solve_and_gather(model, light(model, scene, sources)).indirect;
    };
    return agreement(indirect(coded), indirect(exact)).nrmse;
  };
  return std::max(compare(lit, {}), compare(dark, {{bulb}, {}}));
}

class Precision : public testing::TestWithParam<Codes> {};

TEST_P(Precision, AloneCostsLittle) {
  const double error = precision_error(GetParam());
  RecordProperty("error", std::to_string(error));
  EXPECT_LE(error, GetParam().most);
  EXPECT_GT(error, 0.0);
}

// Full rows, and rows of a tight budget, whose values are fewer and larger.
INSTANTIATE_TEST_SUITE_P(Codecs, Precision,
                         testing::Values(Codes{0, ValueCodec::unorm16, 5e-4},
                                         Codes{0, ValueCodec::sqrt8, 0.01},
                                         Codes{64, ValueCodec::unorm16, 5e-4},
                                         Codes{64, ValueCodec::sqrt8, 0.01}));

}  // namespace
}  // namespace relume::test
