// SPDX-License-Identifier: MIT
#include "compute/light_cache.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "compute/device_fixture.h"
#include "compute/standalone/solver_session.h"
#include "compute/standalone/standalone_memory.h"
#include "compute/test_models.h"
#include "core/light_responses.h"

namespace relume::test {
namespace {

constexpr std::uint32_t kLights = 3;
constexpr PassWishes kSolve{.restart = true, .bounces = 60, .gather = true};

/// Each lights clusters of its own: lamps, surfaces under a spot light, and, in white, the sky.
Lighting light_alone(const Model& model, std::uint32_t light, const Rgb& color) {
  Lighting lighting = random_lighting(model, 71);
  for (std::size_t i = 0; i < lighting.exitance.size(); ++i) {
    lighting.exitance[i] = light == 0 && i % 3 == 0 ? double(1 + i % 5) * color : Rgb(0.0);
    lighting.direct[i] = light == 1 && i % 4 == 1 ? double(1 + i % 7) * color : Rgb(0.0);
  }
  for (Rgb& sky : lighting.sky_radiosity) sky = light == 2 ? 3.0 * color : Rgb(0.0);
  return lighting;
}

Lighting sum_of(const Model& model, std::span<const Rgb> colors) {
  Lighting sum = light_alone(model, 0, colors[0]);
  const Lighting second = light_alone(model, 1, colors[1]), third = light_alone(model, 2, colors[2]);
  sum.direct = second.direct;
  sum.sky_radiosity = third.sky_radiosity;
  return sum;
}

double worst_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double worst = a.size() == b.size() ? 0.0 : 1.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(a[i][c] - b[i][c]) / (1e-6 + std::abs(b[i][c])));
  }
  return worst;
}

class LightCacheTest : public DeviceTest {
 protected:
  /// Of all lights, each in a lighting of its own; the cache is bound to the first.
  void keep(const LightCache& cache, const GpuSolver& solver) {
    EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) {
      cache.record_keep(commands, 0);
      for (std::uint32_t light = 1; light < kLights; ++light)
        cache.record_keep(commands, light, solver.irradiance(0, light));
    }));
  }
  void combine(const LightCache& cache, std::span<const Rgb> colors) {
    EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) { cache.record(commands, colors); }));
  }
};

TEST_F(LightCacheTest, CombinedResponsesAreTheWholeSolve) {
  const Model model = random_model({.clusters_of_system = {70}, .gather_rows = 90}, 70);
  auto session = SolverSession::create(device(), model, {.lightings = kLights}, {});
  ASSERT_TRUE(session) << session.error().message;
  auto cache = LightCache::create(device().host(), model.systems[0].gather.rows, kLights);
  ASSERT_TRUE(cache) << cache.error().message;
  DeviceArena arena(device());
  std::vector<BufferRange> ranges;
  for (const BufferRequirement& buffer : cache->buffers()) ranges.push_back(*arena.allocate(buffer));
  ASSERT_TRUE(cache->bind(ranges, session->solver().irradiance(0)));

  std::vector<std::vector<Rgb>> responses;
  for (std::uint32_t light = 0; light < kLights; ++light)
    ASSERT_TRUE(session->light(light_alone(model, light, Rgb(1.0)), {}, light));
  ASSERT_TRUE(session->run(kSolve));
  keep(*cache, session->solver());
  for (std::uint32_t light = 0; light < kLights; ++light)
    responses.push_back(*session->read_irradiance(light));
  const std::array<Rgb, kLights> colors{Rgb(100.0, 40.0, 3.0), Rgb(0.0, 7.0, 20.0), Rgb(0.5, 0.6, 0.9)};
  combine(*cache, colors);
  const auto combined = session->read_irradiance();
  ASSERT_TRUE(combined);
  EXPECT_LT(worst_difference(*combined, combine_responses(responses, colors)), 1e-6);

  ASSERT_TRUE(session->light(sum_of(model, colors), {}));
  ASSERT_TRUE(session->run(kSolve));
  EXPECT_LT(worst_difference(*combined, *session->read_irradiance()), 1e-5);
}

// 2 (1, 2, 3) + 0.5 (8, 0, 4) = (6, 4, 8), channel by channel.
TEST(LightResponses, AddUpChannelByChannel) {
  const std::array<std::vector<Rgb>, 2> responses{{{Rgb(1.0, 2.0, 3.0)}, {Rgb(8.0, 0.0, 4.0)}}};
  const std::array<Rgb, 2> colors{Rgb(2.0), Rgb(0.5)};
  EXPECT_EQ(combine_responses(responses, colors), std::vector<Rgb>{Rgb(6.0, 4.0, 8.0)});
  EXPECT_TRUE(combine_responses({}, {}).empty());
}

TEST_F(LightCacheTest, RefusesWhatNoDeviceHolds) {
  EXPECT_FALSE(LightCache::create(device().host(), 0, 1));
  EXPECT_FALSE(LightCache::create(device().host(), 1, 0));
  EXPECT_FALSE(LightCache::create(device().host(), 1, kMaxCachedLights + 1));
  EXPECT_FALSE(LightCache::create(device().host(), 1'000'000, 9));
  auto cache = LightCache::create(device().host(), 10, 2);
  ASSERT_TRUE(cache);
  EXPECT_FALSE(cache->bind({}, {}));
}

}  // namespace
}  // namespace relume::test
