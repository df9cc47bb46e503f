// SPDX-License-Identifier: MIT
//
// The frames of compute/standalone, under validation, against the reference.
#include "compute/standalone/frame_session.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "compute/device_fixture.h"
#include "core/reference_solver.h"
#include "verification/changing_room.h"

namespace relume::test {
namespace {

using FrameSessionTest = DeviceTest;

std::vector<kernels::MaterialState> states_of(const Model& model, const Shown& shown) {
  std::vector<kernels::MaterialState> states(model.materials.size(), scaled_material(Rgb(1.0), Rgb(1.0)));
  states[kAccent] = replaced_material(shown.accent, std::nullopt);
  return states;
}

/// |a - b| / |b|.
double relative_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  EXPECT_EQ(a.size(), b.size());
  double off = 0.0, total = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    off += glm::dot(a[i] - b[i], a[i] - b[i]);
    total += glm::dot(b[i], b[i]);
  }
  return std::sqrt(off / total);
}

/// Rounded to half precision; invalid lumels show their neighbours.
void expect_in_lightmaps(FrameSession& session, const Model& model, const std::vector<Rgb>& irradiance) {
  const std::vector<std::uint32_t> first = gather_offsets(model);
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    const std::vector<std::byte> bytes = session.read_lightmap(s).value();
    for (std::size_t i = 0; i < system.lumels.size(); ++i) {
      const Lumel& lumel = system.lumels[i];
      if ((lumel.flags & kLumelInvalid) != 0) continue;
      ASSERT_LT(std::size_t{system.lightmap_width} * lumel.y + lumel.x, bytes.size() / 8);
      std::uint64_t texel = 0;
      std::memcpy(&texel, &bytes[8 * (std::size_t{system.lightmap_width} * lumel.y + lumel.x)], 8);
      const Rgb found(glm::unpackHalf4x16(texel)), expected = irradiance[first[s] + i];
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], expected[c] * 0x1p-11 + 1e-6);
    }
  }
}

// Two bounces a frame get there in the end, from whatever was shown before; the lightmap holds the sum
// rounded to half precision.
TEST_F(FrameSessionTest, FramesEndAtTheReference) {
  const Scene scene = half_a_roof();
  const Model model = half_a_roof_model(scene);
  auto session = FrameSession::create(device(), model, {});
  ASSERT_TRUE(session) << session.error().message;
  for (const std::uint32_t at : {0u, 13u}) {
    const Shown shown = shown_in(at);
    const std::vector<Rgb> sky = sky_radiosity(shown.sky, model.sky_cells, model.sky_resolution);
    const std::vector<kernels::MaterialState> states = states_of(model, shown);
    FrameTimes first;
    for (int frame = 0; frame < 24; ++frame) {
      const auto times =
          session->frame({.lights = shown.lights, .materials = states, .sky = sky, .bounces = 2});
      ASSERT_TRUE(times) << times.error().message;
      if (frame == 0) first = *times;
      EXPECT_GE(times->host, times->device());
      EXPECT_EQ(times->shadow_rays, frame == 0 ? first.shadow_rays : 0u);  // nothing moved
    }
    EXPECT_GT(first.shadow_rays, 0u);

    Scene edited = scene;
    edited.materials[kAccent].base_color = shown.accent;
    const RunTimeLighting lit = light(model, edited, {shown.lights, shown.sky});
    const GatheredIrradiance expected = solve_and_gather(model, lit);
    EXPECT_LE(relative_difference(session->read_irradiance().value(), expected.indirect), 1e-5);
    EXPECT_LE(relative_difference(session->read_gather_direct().value(), expected.direct), 1e-3);
    EXPECT_LE(relative_difference(session->read_direct().value(), lit.lighting.direct), 1e-3);
    EXPECT_LE(relative_difference(session->read_albedo().value(), lit.lighting.albedo), 1e-6);
    std::vector<Rgb> sum = session->read_gather_direct().value();
    const std::vector<Rgb> indirect = session->read_irradiance().value();
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += indirect[i];
    expect_in_lightmaps(*session, model, sum);
  }
}

TEST_F(FrameSessionTest, RefusesStatesOfOtherMaterials) {
  const Model model = half_a_roof_model(half_a_roof());
  auto session = FrameSession::create(device(), model, {});
  ASSERT_TRUE(session) << session.error().message;
  const std::vector<kernels::MaterialState> few(1);
  const auto refused = session->frame({.materials = few});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_EQ(refused.error().message, "a frame has states of 1 materials or clusters, expected 3");
}

}  // namespace
}  // namespace relume::test
