// SPDX-License-Identifier: MIT
//
// Everything of a frame on the device: direct light with shadows, colours, a film on a screen and the sky,
// frame after frame while those before are in flight, each against the reference of the same frame
// (processor, double precision).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "compute/device_fixture.h"
#include "compute/direct_light.h"
#include "compute/frame_ring.h"
#include "compute/guest_solver.h"
#include "compute/host_image.h"
#include "compute/material_pass.h"
#include "compute/screen_pass.h"
#include "core/reference_solver.h"
#include "verification/changing_room.h"

namespace relume::test {
namespace {

constexpr VkDeviceSize kLightBytes = VkDeviceSize{96} << 20;
constexpr VkDeviceSize kLightStaging = VkDeviceSize{64} << 10;  ///< for all that a system may have to trace

Lighting reference_lighting(const Model& model, const Scene& scene, const Shown& shown) {
  Scene edited = scene;
  edited.materials[kAccent].base_color = shown.accent;
  edited.images = {{kFilmSize.width, kFilmSize.height, film_image(shown.image)}};
  edited.materials[kScreen].emission_texture = TextureUse{0, 0};
  return light(model, edited, {shown.lights, shown.sky}).lighting;
}

std::vector<Rgb> reference_irradiance(const Model& model, const Lighting& lighting) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solved = solve_reference(matrices.bounce, lighting, {10000, 1e-9});
  if (!solved) throw std::runtime_error(solved.error().message);
  return gather(matrices.gather, lighting, solved->radiosity);
}

/// What is not a number counts as infinite.
double largest_value(const std::vector<Rgb>& values) {
  double most = 0.0;
  for (const Rgb& value : values) {
    for (int c = 0; c < 3; ++c)
      most = std::isnan(value[c]) ? std::numeric_limits<double>::infinity() : std::max(most, value[c]);
  }
  return most;
}

std::vector<Rgb> rgb_of(std::span<const std::byte> bytes) {
  std::vector<Rgb> values;
  for (std::size_t at = 0; at < bytes.size(); at += 16) {
    std::array<float, 4> texel{};
    std::memcpy(texel.data(), &bytes[at], sizeof texel);
    values.emplace_back(texel[0], texel[1], texel[2]);
  }
  return values;
}

/// The part of the screen that is in one system.
struct ScreenPart {
  std::uint32_t system;
  ScreenPass pass;
  std::vector<std::uint32_t> images;  ///< numbers of the film's
};

/// The renderer of this test: a solver, and direct light, materials and the film for each of its systems.
class Renderer {
 public:
  Renderer(StandaloneDevice& device, const Model& model, const Lighting& brightest)
      : guest_(device, device.host(), model, brightest),
        memory_(device, kLightBytes, guest_.solver().buffers()[0].usage),
        sampler_(nearest_sampler(device)) {
    add_film(device);
    for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
      add_light(device, model, s);
      add_materials(device, model, s);
      add_screen(device, model, s);
    }
    EXPECT_FALSE(screens_.empty());
  }

  /// Before the plan: the schedule gets to know what is different from `before`.
  void note(const Shown& before, const Shown& now, std::span<const Rgb> sky_before,
            std::span<const Rgb> sky_now) {
    Schedule& schedule = guest_.schedule();
    const auto traits = guest_.solver().traits();
    double sky = 0.0;
    for (std::size_t i = 0; i < sky_now.size(); ++i)
      sky = std::max(sky, largest_value({glm::abs(sky_now[i] - sky_before[i])}));
    note_change(traits, schedule, static_cast<std::uint32_t>(lights_.size()), sky);
    const double most = schedule.largest_radiosity;
    for (std::uint32_t s = 0; s < lights_.size(); ++s) {
      ASSERT_TRUE(light_schedules_[s].set_lights(now.lights));
      note_change(traits, schedule, s, light_schedules_[s].pending_change(most));
      note_change(traits, schedule, s, most * largest_value({glm::abs(now.accent - before.accent)}));
    }
    for (const ScreenPart& screen : screens_) {
      if (now.image != before.image)
        note_change(traits, schedule, screen.system, kPi * largest_value({kScreenWhite}));
    }
  }

  /// Records a frame whose irradiance goes to `targets`; traces about so many shadow rays for each system.
  FramePlan record(FrameRing& ring, VkCommandBuffer commands, const Shown& now, std::span<const Rgb> sky,
                   std::span<const IrradianceTarget> targets, std::uint64_t max_rays = ~std::uint64_t{0}) {
    FramePlan plan = guest_.solver().plan(guest_.schedule(), FrameWishes{.bounces = 16});
    const kernels::MaterialState state = replaced_material(now.accent, std::nullopt);
    std::vector<const MaterialPass*> passes;
    for (std::uint32_t s = 0; s < lights_.size(); ++s) {
      vkCmdUpdateBuffer(commands, states_[s].buffer, states_[s].offset + kAccent * sizeof state, sizeof state,
                        &state);
      passes.push_back(&*materials_[s]);
    }
    std::vector<ScreenFrame> screens;
    for (const ScreenPart& screen : screens_)
      screens.push_back({&screen.pass, screen.images[now.image], kScreenWhite});
    const auto write_inputs = [&](VkCommandBuffer into, std::uint32_t s) {
      const Staging staging = ring.staging(kLightStaging);
      const LightPart part = lights_[s]->record(into, light_schedules_[s], staging, max_rays);
      EXPECT_TRUE(part.complete || max_rays != ~std::uint64_t{0});
    };
    const InputCopy copies[] = {
        {Quantity::sky, static_cast<std::uint32_t>(lights_.size()), 0, ring.stage(sky)}};
    const auto recorded = guest_.solver().record_frame(commands,
                                                       {.plan = &plan,
                                                        .copies = copies,
                                                        .materials = passes,
                                                        .screens = screens,
                                                        .write_inputs = write_inputs},
                                                       {.irradiance = targets});
    EXPECT_TRUE(recorded) << recorded.error().message;
    return plan;
  }

  Guest& guest() { return guest_; }
  std::vector<LightSchedule>& light_schedules() { return light_schedules_; }
  std::size_t damaged_bytes() const { return guest_.memory().damaged_bytes() + memory_.damaged_bytes(); }

 private:
  std::vector<BufferRange> allocate(std::span<const BufferRequirement> needed) {
    std::vector<BufferRange> ranges;
    for (const BufferRequirement& buffer : needed) ranges.push_back(memory_.allocate(buffer).value());
    return ranges;
  }

  void add_light(StandaloneDevice& device, const Model& model, std::uint32_t system) {
    DirectLightOptions options;
    options.systems = {system};
    options.max_pairs = 10000;
    lights_.emplace_back(DirectLight::create(device.host(), model, options).value());
    const DirectLight& light = *lights_.back();
    std::vector<BufferRange> ranges = allocate(light.buffers());
    if (system == 0) occluders_.assign(ranges.begin(), ranges.begin() + kLightPieces);
    std::copy(occluders_.begin(), occluders_.end(), ranges.begin());
    ranges[kClusterLight] = guest_.solver().input(system, Quantity::direct);
    ASSERT_TRUE(lights_.back()->bind(ranges));
    guest_.upload(ranges, light.model_data(model, system == 0));
    light_schedules_.push_back(light.make_schedule());
  }

  void add_materials(StandaloneDevice& device, const Model& model, std::uint32_t system) {
    materials_.emplace_back(MaterialPass::create(device.host(), model, system, {}).value());
    const std::vector<BufferRange> ranges = allocate(materials_.back()->buffers());
    ASSERT_TRUE(materials_.back()->bind(ranges, {guest_.solver().input(system, Quantity::albedo),
                                                 guest_.solver().input(system, Quantity::exitance)}));
    guest_.upload(ranges, material_data(model, system, StatePer::material));
    states_.push_back(ranges[1]);
  }

  void add_film(StandaloneDevice& device) {
    constexpr VkImageUsageFlags kUsage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    for (std::uint32_t i = 0; i < kFilmImages; ++i) {
      film_.emplace_back(device, ImageShape{kFilmFormat, kFilmSize, kUsage});
      const std::vector<float> texels = linear(film_image(i));
      film_.back().upload(device, std::as_bytes(std::span(texels)), kImageSampled);
    }
  }

  void add_screen(StandaloneDevice& device, const Model& model, std::uint32_t system) {
    const TextureFootprint footprint =
        texture_footprint(model, system, kScreen, kFilmSize.width, kFilmSize.height);
    if (footprint.clusters.empty()) return;
    auto pass = ScreenPass::create(device.host(), model.systems[system], footprint, {}).value();
    const std::vector<BufferRange> ranges = allocate(pass.buffers());
    ASSERT_TRUE(pass.bind(ranges, {guest_.solver().input(system, Quantity::albedo),
                                   guest_.solver().input(system, Quantity::exitance)}));
    guest_.upload(ranges, screen_data(footprint));
    screens_.push_back({system, std::move(pass), {}});
    for (HostImage& image : film_) {
      const VkImageView view = image.view(kFilmFormat, VK_IMAGE_USAGE_SAMPLED_BIT);
      screens_.back().images.push_back(screens_.back().pass.add_image({view, sampler_.get()}).value());
    }
  }

  static constexpr VkFormat kFilmFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

  Guest guest_;
  GuardedMemory memory_;
  VulkanHandle<VkSampler> sampler_;
  std::vector<HostImage> film_;
  std::vector<ScreenPart> screens_;
  std::vector<BufferRange> occluders_;
  std::vector<std::optional<DirectLight>> lights_;
  std::vector<LightSchedule> light_schedules_;
  std::vector<std::optional<MaterialPass>> materials_;
  std::vector<BufferRange> states_;
};

class DeviceFrames : public DeviceTest {};

// The memory of the host is full of NaN, and a frame traces little: what has not been traced is dark.
TEST_F(DeviceFrames, LightInPartsIsFiniteFromTheFirst) {
  const Model model = half_a_roof_model(half_a_roof());
  const Lighting brightest = brightest_lighting(model);
  Renderer renderer(device(), model, brightest);
  FrameRing ring(device(), 1, VkDeviceSize{1} << 20);
  const Shown now = shown_in(0);
  renderer.note(now, now, brightest.sky_radiosity, brightest.sky_radiosity);
  int frames = 0;
  for (bool complete = false; !complete; ++frames) {
    ASSERT_LT(frames, 1000);
    VkCommandBuffer commands = ring.begin();
    const FramePlan plan = renderer.record(ring, commands, now, brightest.sky_radiosity, {}, 200);
    ring.submit();
    ring.wait_for_all();
    renderer.guest().schedule() = plan.next;
    complete = true;
    for (const LightSchedule& schedule : renderer.light_schedules()) complete &= schedule.complete();
    EXPECT_TRUE(std::isfinite(largest_value(renderer.guest().irradiance()))) << "frame " << frames;
  }
  EXPECT_GT(frames, 3);
}

// Every fifth command buffer is dropped: the frame after it starts from the values before it.
TEST_F(DeviceFrames, LampWallFilmAndSkyAgreeWithTheReferenceOfTheFrame) {
  const Scene scene = half_a_roof();
  const Model model = half_a_roof_model(scene);
  ASSERT_GE(model.systems.size(), 2u);
  ASSERT_GT(model.sky_cells.size(), 0u);
  const Lighting brightest = brightest_lighting(model);
  Renderer renderer(device(), model, brightest);
  FrameRing ring(device(), kFrames, VkDeviceSize{1} << 20);

  struct Submitted {
    std::uint32_t frame, slot;
    std::vector<IrradianceTarget> targets;
    double bound;
  };
  std::vector<Submitted> submitted;
  Shown before = shown_in(0);
  std::vector<Rgb> sky_before = brightest.sky_radiosity;
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    const Shown now = shown_in(frame);
    const std::vector<Rgb> sky = sky_radiosity(now.sky, model.sky_cells, model.sky_resolution);
    VkCommandBuffer commands = ring.begin();
    std::vector<IrradianceTarget> targets;
    for (std::uint32_t s = 0; s < model.systems.size(); ++s)
      targets.push_back({s, ring.reserve(renderer.guest().solver().irradiance(s).byte_size)});
    const Schedule schedule = renderer.guest().schedule();
    const std::vector<LightSchedule> light_schedules = renderer.light_schedules();
    renderer.note(before, now, sky_before, sky);
    const FramePlan plan = renderer.record(ring, commands, now, sky, targets);
    EXPECT_TRUE(plan.pass_complete);
    if (frame % 5 == 4) {
      ring.drop();
      renderer.guest().schedule() = schedule;
      renderer.light_schedules() = light_schedules;
      continue;
    }
    ring.submit();
    renderer.guest().schedule() = plan.next;
    submitted.push_back({frame, ring.slot(), targets, plan.output_error});
    before = now;
    sky_before = sky;
  }
  EXPECT_GT(ring.in_flight(), 10u);
  ring.wait_for_all();

  double change = 0.0;
  std::vector<Rgb> last;
  for (const Submitted& frame : submitted) {
    const Lighting lighting = reference_lighting(model, scene, shown_in(frame.frame));
    const std::vector<Rgb> expected = reference_irradiance(model, lighting);
    std::vector<Rgb> found;
    for (const IrradianceTarget& target : frame.targets) {
      const std::vector<Rgb> part = rgb_of(ring.bytes(frame.slot, target.target));
      found.insert(found.end(), part.begin(), part.end());
    }
    ASSERT_EQ(found.size(), expected.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i)
      worst = std::max(worst, largest_value({glm::abs(found[i] - expected[i])}));
    // Within what the plan promised, and near: 16 bounces a frame leave little.
    const double top = largest_value(expected);
    EXPECT_LE(worst, frame.bound + 1e-5 * top) << "frame " << frame.frame;
    EXPECT_LE(worst, 1e-4 * top) << "frame " << frame.frame << ", bound " << frame.bound;
    if (!last.empty()) {
      for (std::size_t i = 0; i < found.size(); ++i)
        change = std::max(change, largest_value({glm::abs(expected[i] - last[i])}) / top);
    }
    last = expected;
  }
  EXPECT_GT(change, 0.1);  // what is compared does change
  EXPECT_EQ(renderer.damaged_bytes(), 0u);
}

}  // namespace
}  // namespace relume::test
