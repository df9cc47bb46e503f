// SPDX-License-Identifier: MIT
//
// The standard error that one model tells of its rays, against how far models of other rays lie apart.
#include "core/ray_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <tuple>

#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

constexpr std::uint64_t kSeeds = 5;

Light bulb() {
  Light light;
  light.intensity = Rgb(100.0);
  light.position = {1.0, 1.7, 2.2};
  return light;
}

/// Of one lumel, over models that differ in their rays.
struct Sample {
  Rgb sum{0.0}, squares{0.0};
  double told = 0.0;  ///< sum of the variances that the models tell, of all channels
  std::uint64_t models = 0;

  /// Unbiased, of all channels.
  double variance() const {
    const Rgb mean = sum / double(models);
    const Rgb own = (squares - double(models) * mean * mean) / double(models - 1);
    return own.x + own.y + own.z;
  }
};
using Texel = std::tuple<std::size_t, std::uint16_t, std::uint16_t>;

void add_model(const Model& model, const RunTimeLighting& lit, std::map<Texel, Sample>& samples) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lit.lighting, {});
  ASSERT_TRUE(solution) << solution.error().message;
  const std::vector<Rgb> irradiance = gather(matrices.gather, lit.lighting, solution->radiosity);
  const auto noise = ray_noise(model, matrices, lit.lighting, solution->radiosity);
  ASSERT_TRUE(noise);
  const auto first = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    for (std::size_t l = 0; l < model.systems[s].lumels.size(); ++l) {
      const Lumel& lumel = model.systems[s].lumels[l];
      if ((lumel.flags & kLumelInvalid) != 0) continue;
      const Rgb &value = irradiance[first[s] + l], &error = noise->irradiance[first[s] + l];
      Sample& sample = samples[{s, lumel.x, lumel.y}];
      sample.sum += value, sample.squares += value * value;
      sample.told += glm::dot(error, error);
      ++sample.models;
    }
  }
}

/// Told over found, standard errors: of all lumels, and of the thirds of them that are told to err least,
/// more, and most.
struct Calibration {
  double all = 0.0;
  std::vector<double> thirds;
};

Calibration calibrate(const std::map<Texel, Sample>& samples) {
  std::vector<Sample> sorted;
  for (const auto& [texel, sample] : samples)
    if (sample.models == kSeeds) sorted.push_back(sample);
  std::sort(sorted.begin(), sorted.end(), [](const Sample& a, const Sample& b) { return a.told < b.told; });
  const auto ratio = [&](std::size_t from, std::size_t to) {
    double told = 0.0, found = 0.0;
    for (std::size_t i = from; i < to; ++i)
      told += sorted[i].told / double(kSeeds), found += sorted[i].variance();
    return std::sqrt(told / found);
  };
  const std::size_t third = sorted.size() / 3;
  return {ratio(0, sorted.size()), {ratio(0, third), ratio(third, 2 * third), ratio(2 * third, 3 * third)}};
}

/// Under a bulb that the precompute did not know, and under the lamps of the scene.
struct Calibrations {
  Calibration bulb, lamps;
};

Calibrations calibrations(PrecomputeOptions options) {
  const Scene scene = two_rooms();
  options.cluster_size = 0.5, options.texel_size = 0.25;
  std::map<Texel, Sample> by_bulb, by_lamps;
  for (options.seed = 0; options.seed < kSeeds; ++options.seed) {
    const Model model = precompute_or_throw(scene, options);
    add_model(model, light(model, scene, {}), by_lamps);
    RunTimeLighting lit = light(model, scene, {{bulb()}, {}});
    std::fill(lit.lighting.exitance.begin(), lit.lighting.exitance.end(), Rgb(0.0));
    add_model(model, lit, by_bulb);
  }
  return {calibrate(by_bulb), calibrate(by_lamps)};
}

void expect_between(const char* name, double least, double most, const Calibration& found) {
  const auto text = [](double value) { return std::to_string(value); };
  const std::string thirds =
      text(found.thirds[0]) + " " + text(found.thirds[1]) + " " + text(found.thirds[2]);
  testing::Test::RecordProperty(name, text(found.all) + ", by thirds " + thirds);
  EXPECT_GT(found.all, least) << thirds;
  EXPECT_LT(found.all, most) << thirds;
  for (const double third : found.thirds) {
    EXPECT_GT(third, 0.75 * least) << thirds;
    EXPECT_LT(third, 1.25 * most) << thirds;
  }
}

// Rows are full, for cuts differ with the seed as well.
TEST(RayNoise, IsHowFarModelsOfOtherRaysLieApart) {
  PrecomputeOptions options;
  options.error = 0.05, options.budget = 65535, options.codec = ValueCodec::f32;
  const Calibrations found = calibrations(options);
  expect_between("bulb", 0.8, 2.0, found.bulb);
  expect_between("lamps", 0.8, 2.0, found.lamps);
}

// Without a target nobody compares halves: rays count as independent, and rays of a sequence that fills the
// hemisphere evenly, or that samples of emitters help, are better than that.
TEST(RayNoise, IsMoreThanThatWhereNobodyMeasuredIt) {
  PrecomputeOptions options;
  options.quality = 128;
  const Calibrations found = calibrations(options);
  expect_between("bulb", 1.2, 8.0, found.bulb);
  expect_between("lamps", 1.2, 40.0, found.lamps);
}

}  // namespace
}  // namespace relume::test
