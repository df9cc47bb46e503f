// SPDX-License-Identifier: MIT
//
// Lights, albedos and emissions that jump at random, on one running solver: each bounce is that of the
// reference from what was there before, light never grows, and the error is within its bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "compute/device_fixture.h"
#include "compute/standalone/frame_session.h"
#include "core/reference_solver.h"
#include "support/repeats.h"
#include "verification/changing_room.h"

namespace relume::test {
namespace {

using FlipsTest = DeviceTest;

constexpr int kFlipsPerFrame = 50;
constexpr double kMostAlbedo = 0.95;
constexpr double kRounding = 1e-5;  ///< of sums of some hundred terms, none below zero, in 32 bits

/// What a host shows, and one random change of it.
class Shower {
 public:
  explicit Shower(std::size_t clusters) : states_(clusters) {
    for (auto& state : states_) state = replaced_material(Rgb(0.5), Rgb(0.0));
    for (int i = 0; i < 6; ++i) {
      Light light;
      light.position = {0.9 + 0.85 * i, 1.4, 2.1};
      light.intensity = Rgb(0.0);
      lights_.push_back(light);
    }
  }

  void flip() {
    auto& state = states_[random_() % states_.size()];
    switch (random_() % 3) {
      case 0:
        lights_[random_() % lights_.size()].intensity = any_of_magnitude();
        break;
      case 1:
        state.albedo = replaced_material(any_albedo(), std::nullopt).albedo;
        break;
      default:
        state.exitance = replaced_material(std::nullopt, any_of_magnitude()).exitance;
    }
  }

  const std::vector<Light>& lights() const { return lights_; }
  const std::vector<kernels::MaterialState>& states() const { return states_; }

 private:
  double share() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }

  /// Black half of the time, else from 1e-6 to 1e9.
  Rgb any_of_magnitude() {
    if (random_() % 2 == 0) return Rgb(0.0);
    const double magnitude = std::pow(10.0, -6.0 + 15.0 * share());
    return magnitude * Rgb(share(), share(), share());
  }

  Rgb any_albedo() {
    switch (random_() % 4) {
      case 0:
        return Rgb(0.0);
      case 1:
        return Rgb(2.0);  // the pass lowers it to the most
      default:
        return Rgb(share(), share(), share());
    }
  }

  std::mt19937_64 random_{17};
  std::vector<Light> lights_;
  std::vector<kernels::MaterialState> states_;
};

double largest(const std::vector<Rgb>& values) {
  double most = 0.0;
  for (const Rgb& value : values) most = std::max({most, value.x, value.y, value.z});
  return most;
}

/// Every channel of every cluster.
testing::AssertionResult is_bounce(const std::vector<Rgb>& found, const std::vector<Rgb>& expected) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (std::abs(found[i][c] - expected[i][c]) <= kRounding * expected[i][c] + 1e-30) continue;
      return testing::AssertionFailure() << "cluster " << i << ", channel " << c << ": " << found[i][c]
                                         << ", expected " << expected[i][c];
    }
  }
  return testing::AssertionSuccess();
}

/// |B_i - exact_i| <= v_i max_j (|r_j| / v_j) / (1 - q): the bound of DESIGN section 7 for any method, with
/// the change r that one more bounce makes.
void expect_within_bound(const SenderMatrix& matrix, const Lighting& lighting,
                         const std::vector<Rgb>& radiosity) {
  const auto exact = solve_reference(matrix, lighting, {10000, 1e-10});
  ASSERT_TRUE(exact) << exact.error().message;
  const ContractionBound bound = contraction_bound(matrix, lighting.albedo);
  const std::vector<Rgb> next = bounce(matrix, lighting, radiosity);
  Rgb weighted(0.0);
  for (std::size_t i = 0; i < next.size(); ++i)
    weighted = glm::max(weighted, glm::abs(next[i] - radiosity[i]) / bound.weights[i]);
  const double rounding = 1e-9 * largest(exact->radiosity);
  for (std::size_t i = 0; i < next.size(); ++i) {
    const Rgb most = bound.weights[i] * weighted / (Rgb(1.0) - bound.quotient);
    for (int c = 0; c < 3; ++c)
      ASSERT_LE(std::abs(radiosity[i][c] - exact->radiosity[i][c]), most[c] + rounding) << "cluster " << i;
  }
}

TEST_F(FlipsTest, LightNeverGrowsNorLeavesItsBound) {
  const Model model = half_a_roof_model(half_a_roof());
  auto session = FrameSession::create(device(), model, {.materials = {StatePer::cluster, kMostAlbedo}});
  ASSERT_TRUE(session) << session.error().message;
  const SenderMatrix matrix = reference_bounce_matrix(model);
  Lighting lighting = stored_lighting(model);
  lighting.sky_radiosity = sky_radiosity(turned_sky(0), model.sky_cells, model.sky_resolution);
  Shower shower(lighting.albedo.size());
  const int frames = (repeats("RELUME_FLIPS", 10000) + kFlipsPerFrame - 1) / kFlipsPerFrame;
  std::vector<Rgb> before;
  for (int frame = 0; frame < frames; ++frame) {
    SCOPED_TRACE(frame);
    for (int k = 0; k < kFlipsPerFrame; ++k) shower.flip();
    const auto times = session->frame({shower.lights(), shower.states(), lighting.sky_radiosity, 1});
    ASSERT_TRUE(times) << times.error().message;
    lighting.albedo = session->read_albedo().value();
    lighting.direct = session->read_direct().value();
    for (std::size_t i = 0; i < lighting.exitance.size(); ++i) {
      const kernels::vec4& exitance = shower.states()[i].exitance;
      lighting.exitance[i] = Rgb(exitance.x, exitance.y, exitance.z);
      for (int c = 0; c < 3; ++c) ASSERT_LE(lighting.albedo[i][c], kMostAlbedo + 1e-7);
    }
    const std::vector<Rgb> lit = bounce(matrix, lighting, std::vector<Rgb>(lighting.albedo.size(), Rgb(0.0)));
    if (before.empty()) {
      for (std::size_t i = 0; i < lit.size(); ++i)
        before.push_back(lighting.exitance[i] + lighting.albedo[i] * lighting.direct[i]);
    }
    const std::vector<Rgb> radiosity = session->read_radiosity().value();
    ASSERT_TRUE(is_bounce(radiosity, bounce(matrix, lighting, before)));
    ASSERT_LE(largest(radiosity), (largest(lit) + kMostAlbedo * largest(before)) * (1.0 + kRounding));
    expect_within_bound(matrix, lighting, radiosity);
    if (HasFatalFailure()) return;
    before = radiosity;
  }
  std::cout << frames * kFlipsPerFrame << " flips in " << frames << " frames of " << before.size()
            << " clusters\n";
}

}  // namespace
}  // namespace relume::test
