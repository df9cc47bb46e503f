// SPDX-License-Identifier: MIT
#include "core/probe_coefficients.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "core/model_file.h"
#include "core/quantities.h"
#include "core/sky.h"
#include "support/tiny_model.h"

namespace relume {
namespace {

constexpr std::uint32_t kResolution = 32;

/// A probe in the middle of a sky of 6 x 32 x 32 cells, nothing else.
Model probe_under_the_sky() {
  Model model;
  model.sky_resolution = kResolution;
  model.probe_names = {"p"};
  System& system = model.systems.emplace_back();
  for (std::uint32_t cell = 0; cell < 6 * kResolution * kResolution; ++cell) {
    model.sky_cells.push_back(cell);
    system.imports.push_back({kSkySystem, cell});
    system.probe_senders.push_back({cell, float(sky_cell_solid_angle(cell, kResolution)),
                                    glm::vec3(sky_cell_direction(cell, kResolution))});
  }
  system.probes = {{glm::dvec3(0.0), 0, 0, 0, std::uint32_t(system.imports.size())}};
  return model;
}

template <class Radiance>
ProbeCoefficients under(const Model& model, const Radiance& radiance) {
  Lighting lighting;
  for (const auto cell : model.sky_cells)
    lighting.sky_radiosity.push_back(kPi * Rgb(radiance(sky_cell_direction(cell, kResolution))));
  return probe_coefficients(model, lighting, {}).at(0);
}

void expect_coefficients(const ProbeCoefficients& found, const Harmonics& expected, double tolerance) {
  for (std::size_t h = 0; h < kProbeHarmonics; ++h)
    EXPECT_NEAR(found[h].g, expected[h], tolerance) << "coefficient " << h;
}

TEST(ProbeCoefficients, OfAConstantEnvironmentAreItsMeanAlone) {
  const auto found = under(probe_under_the_sky(), [](const glm::dvec3&) { return 3.0; });
  expect_coefficients(found, {3.0 * std::sqrt(4.0 * kPi)}, 1e-4);
}

TEST(ProbeCoefficients, OfAnEnvironmentWhiteAboveFollowByHand) {
  // Over the upper hemisphere: 2 pi / sqrt(4 pi); sqrt(3 / 4 pi) x pi; of the second band nothing, for even
  // harmonics have half of their integral over the sphere, 0.
  const auto found = under(probe_under_the_sky(), [](const glm::dvec3& d) { return d.y > 0.0 ? 1.0 : 0.0; });
  expect_coefficients(found, {std::sqrt(kPi), std::sqrt(3.0 * kPi) / 2.0}, 2e-3);
}

TEST(ProbeCoefficients, PickOutEachHarmonicOfTheEnvironment) {
  // Radiance 2 + Y_h has coefficient 1 at h, for harmonics are orthonormal.
  for (std::size_t h = 1; h < kProbeHarmonics; ++h) {
    Harmonics expected{2.0 * std::sqrt(4.0 * kPi)};
    expected[h] = 1.0;
    const auto found =
        under(probe_under_the_sky(), [h](const glm::dvec3& d) { return 2.0 + mean_harmonics(d)[h]; });
    expect_coefficients(found, expected, 2e-3);
  }
}

TEST(ProbeCoefficients, HaveTheSignsAndOrderOfTheAxes) {
  const glm::dvec3 d(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);
  // sqrt(3 / 4 pi) = 0.4886025, sqrt(15 / 4 pi) = 1.0925484, sqrt(5 / 16 pi) = 0.3153916.
  const Harmonics expected{0.2820948,           0.4886025 * 3 / 7,   0.4886025 * 6 / 7,
                           0.4886025 * 2 / 7,   1.0925484 * 6 / 49,  1.0925484 * 18 / 49,
                           0.3153916 * 59 / 49, 1.0925484 * 12 / 49, 0.5462742 * -5 / 49};
  const Harmonics found = mean_harmonics(d);
  for (std::size_t h = 0; h < kProbeHarmonics; ++h) EXPECT_NEAR(found[h], expected[h], 1e-6) << h;
}

TEST(ProbeCoefficients, OfACapComeFromItsMeanDirection) {
  // A cap of 20 degrees about z: the means of z and (3 z2 - 1) / 2 are (1 + c) / 2 and c (1 + c) / 2.
  const double c = std::cos(kPi / 9.0), mean = (1.0 + c) / 2.0;
  const Harmonics found = mean_harmonics({0.0, 0.0, mean});
  EXPECT_NEAR(found[2], std::sqrt(3.0 / (4.0 * kPi)) * mean, 1e-12);
  EXPECT_NEAR(found[6], std::sqrt(5.0 / (4.0 * kPi)) * c * mean, 1e-3);
}

TEST(ProbeCoefficients, SurviveTheFileAndAreChecked) {
  Model model = test::tiny_model();
  model.probe_names = {"middle"};
  System& floor = model.systems[0];
  floor.probes = {{glm::dvec3(0.5), 0, kProbeInvalid, 0, 2}};
  floor.probe_senders = {{0, 2.0f, {0.0f, 0.9f, 0.0f}}, {1, 3.0f, {0.0f, 0.0f, 1.0f}}};
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  const auto read = decode_model(encode_model(model), "tiny");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->probe_names, model.probe_names);
  EXPECT_EQ(read->systems[0].probes.at(0).flags, kProbeInvalid);
  EXPECT_EQ(read->systems[0].probe_senders.at(1).solid_angle, 3.0f);

  const auto expect_refused = [&](auto breaks, const std::string& part) {
    Model broken = model;
    breaks(broken.systems[0]);
    const auto checked = check_model(broken);
    ASSERT_FALSE(checked) << part;
    EXPECT_NE(checked.error().message.find(part), std::string::npos) << checked.error().message;
  };
  expect_refused([](System& s) { s.probe_senders[1].column = 2; },
                 "expected ascending columns below 2, found 2");
  expect_refused([](System& s) { std::swap(s.probe_senders[0], s.probe_senders[1]); }, "found 0 after 1");
  expect_refused([](System& s) { s.probe_senders[0].solid_angle = 0.0f; }, "solid angles above 0");
  expect_refused([](System& s) { s.probe_senders[0].direction.x = 1.0f; },
                 "mean directions of length 1 at most");
  expect_refused([](System& s) { s.probe_senders[1].solid_angle = 11.0f; },
                 "add up to 4 pi at most, found 13");
  expect_refused([](System& s) { s.probes[0].position.x = std::nan(""); }, "expected a finite position");
  expect_refused([](System& s) { s.probes[0].name = 1; }, "a name below 1");
  expect_refused([](System& s) { s.probes[0].flags = 2; }, "known flags");
  expect_refused([](System& s) { s.probes[0].first_sender = 1; }, "expected senders from 0 on");
  expect_refused([](System& s) { s.probes[0].sender_count = 3; }, "found 3 from 0 on of 2");
  expect_refused([](System& s) { s.probes[0].sender_count = 1; },
                 "expected 1 senders of probes, as they say, found 2");
}

}  // namespace
}  // namespace relume
