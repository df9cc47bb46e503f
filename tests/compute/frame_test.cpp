// SPDX-License-Identifier: MIT
//
// What a renderer does with a GpuSolver frame after frame: lights that change, frames in flight, command
// buffers that are dropped, systems that come and go, limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "compute/device_fixture.h"
#include "compute/frame_ring.h"
#include "compute/guest_solver.h"
#include "compute/host_image.h"
#include "compute/material_pass.h"
#include "compute/near_reference.h"
#include "compute/test_models.h"
#include "compute/texel_formats.h"

namespace relume::test {
namespace {

constexpr std::uint32_t kInFlight = 3;
constexpr VkDeviceSize kFrameBytes = 1 << 16;

/// The reference of a lighting, converged.
struct Exact {
  std::vector<Rgb> radiosity;
  std::vector<Rgb> irradiance;
};

Exact exact_of(const Model& model, const Lighting& lighting) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solved = solve_reference(matrices.bounce, lighting, {10000, 1e-12});
  EXPECT_TRUE(solved) << solved.error().message;
  return {solved->radiosity, gather(matrices.gather, lighting, solved->radiosity)};
}

double largest_difference(const std::vector<Rgb>& values, const std::vector<Rgb>& expected) {
  EXPECT_EQ(values.size(), expected.size());
  double most = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(values[i][c] - expected[i][c]));
  }
  return most;
}

/// The parts of `lighting` that are of loaded systems of `model`, from arrays over all systems of `whole`.
Lighting part_of(const Lighting& lighting, const Model& whole, const Model& model) {
  Lighting part;
  part.sky_radiosity = lighting.sky_radiosity;
  const std::vector<std::uint32_t> offsets = cluster_offsets(whole);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    if (!model.systems[s].loaded) continue;
    const auto add = [&](const std::vector<Rgb>& from, std::vector<Rgb>& to) {
      to.insert(to.end(), from.begin() + offsets[s], from.begin() + offsets[s + 1]);
    };
    add(lighting.albedo, part.albedo);
    add(lighting.exitance, part.exitance);
    add(lighting.direct, part.direct);
  }
  return part;
}

class FrameTest : public DeviceTest {
 protected:
  /// Rounding of a solve, relative to the brightest value, generously: 1e-5 is the promise of near_reference.
  double rounding(const Exact& exact) const {
    double top = 0.0;
    for (const Rgb& value : exact.radiosity) top = std::max({top, value.x, value.y, value.z});
    return 1e-5 * top;
  }

  Model model_ = random_model({.nodes = 20, .spanning_nodes = 5, .probes = 6}, 1, {ValueCodec::f32, 2000});
  Lighting lighting_ = random_lighting(model_, 2);
  double largest_ = largest_radiosity(lighting_);
};

// A lamp that moves through the systems; every frame brings new direct light and a turning sky in memory of
// its own while the frames before it are still running, and every third command buffer is thrown away.
TEST_F(FrameTest, LightsMoveWhileFramesAreInFlight) {
  Guest guest(device(), device().host(), model_, lighting_);
  const std::vector<std::uint32_t> offsets = cluster_offsets(model_);
  Lighting now = lighting_;
  std::uint32_t most_in_flight = 0;
  {
    FrameRing ring(device(), kInFlight, kFrameBytes);
    Random random(5);
    for (int frame = 0; frame < 60; ++frame) {
      VkCommandBuffer commands = ring.begin();
      std::vector<InputCopy> copies;
      Schedule schedule = guest.schedule();
      Lighting next = now;
      if (frame < 24) {
        const std::uint32_t s = random.below(4);
        for (std::uint32_t i = offsets[s]; i < offsets[s + 1]; ++i)
          next.direct[i] = Rgb(300.0 * random.unit());
        const auto lit = std::span(next.direct).subspan(offsets[s], offsets[s + 1] - offsets[s]);
        copies.push_back({Quantity::direct, s, 0, ring.stage(lit)});
        note_change(guest.solver().traits(), schedule, s,
                    lighting_change(now, next, offsets[s], lit.size(), largest_));
        const std::uint32_t patch = random.below(8);
        for (std::uint32_t i = 0; i < 3; ++i) next.sky_radiosity[patch + i] = Rgb(3000.0 * random.unit());
        copies.push_back(
            {Quantity::sky, 4, patch, ring.stage(std::span(next.sky_radiosity).subspan(patch, 3))});
        note_change(guest.solver().traits(), schedule, 4, 3000.0);
      }
      const FramePlan plan = guest.solver().plan(schedule, FrameWishes{.bounces = 2});
      const auto recorded = guest.solver().record_frame(commands, {.plan = &plan, .copies = copies}, {});
      ASSERT_TRUE(recorded) << recorded.error().message;
      if (frame % 3 == 2) {
        ring.drop();
        continue;
      }
      ring.submit();
      most_in_flight = std::max(most_in_flight, ring.in_flight());
      guest.schedule() = plan.next;
      now = next;
    }
  }
  EXPECT_GE(most_in_flight, 2u);
  const Exact exact = exact_of(model_, now);
  const double bound = guest.frame({.bounces = 1}).radiosity_error;
  EXPECT_LT(bound, 1e-2 * largest_);
  EXPECT_LE(largest_difference(guest.radiosity(), exact.radiosity), bound + rounding(exact));
  for (int i = 0; i < 60; ++i) guest.frame({.bounces = 2});
  EXPECT_TRUE(near_reference("radiosity", guest.radiosity(), exact.radiosity));
  EXPECT_TRUE(near_reference("irradiance", guest.irradiance(), exact.irradiance));
  EXPECT_EQ(guest.memory().damaged_bytes(), 0u);
}

// The error that plans promise holds in every frame, however little fits into one.
TEST_F(FrameTest, TheBoundHoldsInEveryFrameOfALimit) {
  Guest guest(device(), device().host(), model_, lighting_, {.max_dispatch_form_factors = 700});
  const Exact exact = exact_of(model_, lighting_);
  const double allowed = rounding(exact);
  double bound = std::numeric_limits<double>::infinity();
  int frames = 0;
  for (; bound > 1e-3 * largest_; ++frames) {
    ASSERT_LT(frames, 3000);
    const FramePlan plan = guest.frame({.max_form_factors = 2500, .display_step = 1e-3 * largest_});
    if (frames > 0) {
      EXPECT_LE(plan.cost, 2500u);
    }
    bound = plan.output_error;
    if (frames % 16 != 0 && bound > 1e-3 * largest_) continue;
    EXPECT_LE(largest_difference(guest.radiosity(), exact.radiosity), plan.radiosity_error + allowed);
  }
  EXPECT_GT(frames, 30);
  EXPECT_LE(largest_difference(guest.irradiance(), exact.irradiance), bound + allowed);
  EXPECT_LE(bound, 1e-3 * largest_);
  // Sooner or later there is nothing left to do, and the promise still holds.
  FramePlan plan = guest.frame({.display_step = 1e-3 * largest_});
  for (int further = 0; !plan.steps.empty(); ++further) {
    ASSERT_LT(further, 50);
    plan = guest.frame({.display_step = 1e-3 * largest_});
  }
  EXPECT_LE(plan.output_error, 1e-3 * largest_);
}

TEST_F(FrameTest, SolvesToEpsilonAtOnce) {
  Guest guest(device(), device().host(), model_, lighting_);
  const Exact exact = exact_of(model_, lighting_);
  const double epsilon = 1e-4 * largest_;
  guest.together({.bounces = 1000, .tolerance = epsilon, .gather = true});
  for (const SystemProgress& system : guest.schedule().systems) EXPECT_LE(system.output_error, epsilon);
  EXPECT_LE(largest_difference(guest.irradiance(), exact.irradiance), epsilon + rounding(exact));
}

TEST_F(FrameTest, SystemsComeAndGoWhileOthersRun) {
  const Model without_2 = unloaded(model_, 2);
  const Lighting lit_without_2 = part_of(lighting_, model_, without_2);
  Guest guest(device(), device().host(), without_2, lit_without_2,
              {.sender_capacity = loaded_senders(model_) + 5});
  const auto settle = [&](const Model& model) {
    for (int i = 0; i < 60; ++i) guest.frame({.bounces = 2});
    const Exact exact = exact_of(model, part_of(lighting_, model_, model));
    EXPECT_TRUE(near_reference("radiosity", guest.radiosity(), exact.radiosity));
    EXPECT_TRUE(near_reference("irradiance", guest.irradiance(), exact.irradiance));
    EXPECT_EQ(guest.memory().damaged_bytes(), 0u);
  };
  settle(without_2);

  FrameRing ring(device(), kInFlight, kFrameBytes);
  const auto frame = [&] {
    VkCommandBuffer commands = ring.begin();
    const FramePlan plan = guest.solver().plan(guest.schedule(), FrameWishes{.bounces = 2});
    EXPECT_TRUE(guest.solver().record_frame(commands, {.plan = &plan}, {}));
    ring.submit();
    guest.schedule() = plan.next;
  };
  // System 2 is loaded with frames in flight; its upload waits, which a host would spread over frames.
  for (int i = 0; i < 4; ++i) frame();
  EXPECT_GT(ring.in_flight(), 0u);
  ASSERT_NO_FATAL_FAILURE(guest.load(model_, 2, lighting_));
  guest.light(model_, 2, lighting_);
  for (int i = 0; i < 4; ++i) frame();
  ring.wait_for_all();
  settle(model_);

  // System 0 leaves: black at once, its memory once the frames that knew it are done.
  for (int i = 0; i < 4; ++i) frame();
  const VkDeviceSize before = guest.memory().handed_out();
  deactivate(guest.solver().traits(), guest.schedule(), 0);
  frame();
  ring.wait_for_all();
  const VkDeviceSize freed = guest.system_bytes(0);
  guest.unload(0);
  EXPECT_EQ(guest.memory().handed_out(), before - freed);
  frame();
  ring.wait_for_all();
  settle(unloaded(model_, 0));

  // And comes back, where another was before or elsewhere.
  ASSERT_NO_FATAL_FAILURE(guest.load(model_, 0, lighting_));
  guest.light(model_, 0, lighting_);
  settle(model_);
}

TEST_F(FrameTest, OutputsChangeWhenTheyAreComplete) {
  Guest guest(device(), device().host(), model_, lighting_, {.max_dispatch_form_factors = 300});
  FrameRing ring(device(), 1, kFrameBytes);
  std::vector<std::uint32_t> published;
  int silent = 0;
  for (int frame = 0; frame < 400 && published.size() < 12; ++frame) {
    VkCommandBuffer commands = ring.begin();
    const FramePlan plan = guest.solver().plan(guest.schedule(), FrameWishes{.max_form_factors = 900});
    const VkDeviceSize bytes = guest.solver().irradiance(2).byte_size;
    const BufferRange target = ring.reserve(bytes);
    const BufferRange report = ring.reserve(guest.solver().residuals().byte_size);
    const IrradianceTarget targets[] = {{2, target}};
    std::vector<std::uint32_t> now;
    const auto publish = [&](VkCommandBuffer, std::uint32_t system) { now.push_back(system); };
    ASSERT_TRUE(guest.solver().record_frame(commands, {.plan = &plan},
                                            {.irradiance = targets, .publish = publish, .report = report}));
    std::vector<std::byte> before(ring.bytes(0, target).begin(), ring.bytes(0, target).end());
    ring.submit();
    ring.wait_for_all();
    guest.schedule() = plan.next;
    const auto after = ring.bytes(0, target);
    const auto source = guest.memory().bytes(guest.solver().irradiance(2));
    if (std::find(now.begin(), now.end(), 2u) != now.end()) {
      EXPECT_TRUE(std::equal(after.begin(), after.end(), source.begin()));
    } else {
      EXPECT_TRUE(std::equal(after.begin(), after.end(), before.begin()));
      ++silent;
    }
    published.insert(published.end(), now.begin(), now.end());
  }
  EXPECT_GE(published.size(), 12u);
  EXPECT_GT(silent, 3);
  // Systems took turns.
  for (std::uint32_t s = 0; s < 4; ++s) EXPECT_THAT(published, testing::Contains(s));
}

// The host's own pass for direct light runs for every active system, after the copies and before the bounces.
TEST_F(FrameTest, TheHostWritesDirectLightItself) {
  Guest guest(device(), device().host(), model_, lighting_);
  Lighting lit = lighting_;
  for (Rgb& direct : lit.direct) direct = Rgb(std::bit_cast<float>(0x42c80000u));  // 100
  const auto write_inputs = [&](VkCommandBuffer commands, std::uint32_t system) {
    const BufferRange direct = guest.solver().input(system, Quantity::direct);
    vkCmdFillBuffer(commands, direct.buffer, direct.offset, direct.byte_size, 0x42c80000u);
  };
  const FramePlan plan =
      guest.solver().plan(guest.schedule(), PassWishes{.restart = true, .bounces = 3, .gather = true});
  const auto submitted = device().submit([&](VkCommandBuffer commands) {
    EXPECT_TRUE(guest.solver().record_frame(commands, {.plan = &plan, .write_inputs = write_inputs}, {}));
  });
  ASSERT_TRUE(submitted);
  guest.schedule() = plan.next;
  DeviceSolution out = guest.results(3);
  EXPECT_TRUE(agrees_with_reference(out, model_, lit));
}

// Colours by material, and a lightmap that is written in the frame that completes its system.
TEST_F(FrameTest, MaterialsGoInAndLightmapsComeOut) {
  Model model = model_;
  model.materials = {{.name = "wall"}};
  System& system = model.systems[2];
  system.lightmap_width = 10;
  system.lightmap_height = 9;
  for (std::size_t i = 0; i < system.lumels.size(); ++i)
    system.lumels[i] = {std::uint16_t(i % 10), std::uint16_t(i / 10), 0, 0};
  Guest guest(device(), device().host(), model, lighting_);
  GuardedMemory memory(device(), VkDeviceSize{1} << 20, guest.solver().buffers()[0].usage);
  const auto allocate = [&](std::span<const BufferRequirement> needed) {
    std::vector<BufferRange> ranges;
    for (const BufferRequirement& buffer : needed) ranges.push_back(*memory.allocate(buffer));
    return ranges;
  };
  auto materials = MaterialPass::create(device().host(), model, 2, {});
  ASSERT_TRUE(materials) << materials.error().message;
  const std::vector<BufferRange> states = allocate(materials->buffers());
  ASSERT_TRUE(materials->bind(
      states, {guest.solver().input(2, Quantity::albedo), guest.solver().input(2, Quantity::exitance)}));
  guest.upload(states, material_data(model, 2, StatePer::material));
  const kernels::MaterialState red = replaced_material(Rgb(0.5, 0.25, 0.125), Rgb(0.0));
  UploadData state;
  const auto bytes = std::as_bytes(std::span(&red, 1));
  state.add_owned(1, 0, {bytes.begin(), bytes.end()});
  guest.upload(states, std::move(state));

  const LightmapTexels texels = lightmap_texels(system);
  auto lightmap = LightmapPass::create(device().host(), system, texels, LightmapFormat::rgba16f);
  ASSERT_TRUE(lightmap) << lightmap.error().message;
  HostImage image = make_lightmap_image(device(), lightmap->image());
  const std::vector<BufferRange> texel_ranges = allocate(lightmap->buffers());
  guest.upload(texel_ranges, lightmap_data(texels));
  ASSERT_TRUE(lightmap->bind(texel_ranges, {guest.solver().irradiance(2), {}},
                             image.view(lightmap->image().storage_view_format, VK_IMAGE_USAGE_STORAGE_BIT)));

  const FramePlan plan =
      guest.solver().plan(guest.schedule(), PassWishes{.restart = true, .bounces = 3, .gather = true});
  EXPECT_TRUE(publishes(plan, 2));
  const MaterialPass* const changed[] = {&*materials};
  const LightmapOutput lightmaps[] = {{2, &*lightmap}};
  const auto submitted = device().submit([&](VkCommandBuffer commands) {
    EXPECT_TRUE(guest.solver().record_frame(commands, {.plan = &plan, .materials = changed},
                                            {.lightmaps = lightmaps}));
  });
  ASSERT_TRUE(submitted);
  guest.schedule() = plan.next;
  Lighting lit = lighting_;
  const std::vector<std::uint32_t> offsets = cluster_offsets(model);
  for (std::uint32_t i = offsets[2]; i < offsets[3]; ++i) {
    lit.albedo[i] = Rgb(0.5, 0.25, 0.125);
    lit.exitance[i] = Rgb(0.0);
  }
  EXPECT_TRUE(agrees_with_reference(guest.results(3), model, lit));
  const std::vector<std::byte> shown = image.download(device(), kImageWritten, 8);
  const std::vector<Rgb> irradiance = guest.irradiance(2);
  for (std::size_t i = 0; i < irradiance.size(); ++i) {
    std::array<std::uint16_t, 4> halves{};
    std::memcpy(&halves, &shown[8 * i], 8);
    const Rgb texel = decode_rgba16f(halves);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(texel[c], irradiance[i][c], irradiance[i][c] * 0x1p-11);
  }
}

// A slow drift of a light below the display step, frame by frame, is not lost.
TEST_F(FrameTest, ASlowDriftIsNotLost) {
  Guest guest(device(), device().host(), model_, lighting_);
  FrameWishes wishes{.bounces = 4, .display_step = 0.002 * largest_};
  for (int i = 0; i < 60 && !guest.frame(wishes).steps.empty(); ++i) {
  }
  const std::vector<std::uint32_t> offsets = cluster_offsets(model_);
  Lighting now = lighting_;
  FrameRing ring(device(), kInFlight, kFrameBytes);
  int idle = 0;
  const int kFrames = 60;
  double error = 0.0;
  for (int frame = 0; frame < kFrames; ++frame) {
    VkCommandBuffer commands = ring.begin();
    Lighting next = now;
    for (std::uint32_t i = offsets[2]; i < offsets[3]; ++i) next.exitance[i] += Rgb(2e-5 * largest_);
    const auto lit = std::span(next.exitance).subspan(offsets[2], offsets[3] - offsets[2]);
    const InputCopy copies[] = {{Quantity::exitance, 2, 0, ring.stage(lit)}};
    note_change(guest.solver().traits(), guest.schedule(), 2,
                lighting_change(now, next, offsets[2], lit.size(), largest_));
    const FramePlan plan = guest.solver().plan(guest.schedule(), wishes);
    ASSERT_TRUE(guest.solver().record_frame(commands, {.plan = &plan, .copies = copies}, {}));
    ring.submit();
    idle += plan.steps.empty() ? 1 : 0;
    error = plan.output_error;
    guest.schedule() = plan.next;
    now = next;
  }
  ring.wait_for_all();
  EXPECT_GT(idle, kFrames / 4);
  EXPECT_LT(idle, kFrames);
  const Exact exact = exact_of(model_, now);
  EXPECT_LE(largest_difference(guest.irradiance(), exact.irradiance), error + rounding(exact));
}

}  // namespace
}  // namespace relume::test
