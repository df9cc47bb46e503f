// SPDX-License-Identifier: MIT
//
// Everything of a frame on the device: direct light with shadows, colours and the sky, frame after frame
// while those before are in flight, each against the reference of the same frame (processor, double
// precision).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <optional>

#include "compute/device_fixture.h"
#include "compute/direct_light.h"
#include "compute/frame_ring.h"
#include "compute/guest_solver.h"
#include "compute/material_pass.h"
#include "core/reference_solver.h"
#include "support/scene_builder.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

constexpr std::uint32_t kFrames = 18;
constexpr std::uint32_t kAccent = 1;  ///< material of one wall
constexpr VkDeviceSize kLightBytes = VkDeviceSize{96} << 20;

/// 6 x 3 x 4 m, of which half is under a ceiling; a wall with a way past it stands between the halves.
Scene half_a_roof() {
  SceneBuilder b;
  const std::uint32_t white = b.material("white", Rgb(0.6)), accent = b.material("accent", Rgb(0.6));
  b.add_quad("floor/in", white, {P(0, 0, 0), P(0, 0, 4), P(3, 0, 4), P(3, 0, 0)});
  b.add_quad("floor/out", white, {P(3, 0, 0), P(3, 0, 4), P(6, 0, 4), P(6, 0, 0)});
  b.add_quad("ceiling", white, {P(0, 3, 0), P(3, 3, 0), P(3, 3, 4), P(0, 3, 4)});
  b.add_quad("near", white, {P(0, 0, 0), P(6, 0, 0), P(6, 3, 0), P(0, 3, 0)});
  b.add_quad("far", white, {P(6, 0, 4), P(0, 0, 4), P(0, 3, 4), P(6, 3, 4)});
  b.add_quad("left", accent, {P(0, 0, 4), P(0, 0, 0), P(0, 3, 0), P(0, 3, 4)});
  b.add_quad("right", white, {P(6, 0, 0), P(6, 0, 4), P(6, 3, 4), P(6, 3, 0)});
  b.add_standing_box("between", white, P(2.9, 0, 0), P(3.1, 2.6, 2.6));
  return b.scene();
}

/// A bright side that goes once around in kFrames frames.
Sky turned_sky(std::uint32_t frame) {
  EquirectangularSky sky{16, 8, std::vector<glm::vec3>(16 * 8, glm::vec3(60.0f, 80.0f, 120.0f))};
  for (std::uint32_t row = 0; row < 4; ++row) {
    for (std::uint32_t i = 0; i < 4; ++i)
      sky.radiance[16 * row + (16 * frame / kFrames + i) % 16] = glm::vec3(900.0f, 700.0f, 400.0f);
  }
  return sky;
}

/// What the host shows in a frame: one thing after the other begins to change.
struct Shown {
  std::vector<Light> lights;
  Rgb accent{0.6};
  Sky sky = turned_sky(0);
};

Shown shown_in(std::uint32_t frame) {
  Shown out;
  Light lamp;
  lamp.intensity = Rgb(300.0, 240.0, 150.0);
  lamp.position = P(0.73 + 0.29 * std::min(frame, 12u), 1.9, 1.37);
  Light sun;
  sun.type = LightType::directional;
  sun.intensity = Rgb(800.0, 780.0, 700.0);
  sun.direction = glm::normalize(P(-0.53, -1.0, 0.21));
  out.lights = {lamp, sun};
  if (frame >= 6) out.accent = Rgb(0.6, 0.05, 0.1 + 0.02 * frame);
  if (frame >= 10) out.sky = turned_sky(frame);
  return out;
}

Lighting reference_lighting(const Model& model, const Scene& scene, const Shown& shown) {
  Scene edited = scene;
  edited.materials[kAccent].base_color = shown.accent;
  return light(model, edited, {shown.lights, shown.sky}).lighting;
}

std::vector<Rgb> reference_irradiance(const Model& model, const Lighting& lighting) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solved = solve_reference(matrices.bounce, lighting, {10000, 1e-9});
  if (!solved) throw std::runtime_error(solved.error().message);
  return gather(matrices.gather, lighting, solved->radiosity);
}

double largest_value(const std::vector<Rgb>& values) {
  double most = 0.0;
  for (const Rgb& value : values) most = std::max({most, value.x, value.y, value.z});
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

/// The renderer of this test: a solver, and direct light and materials for each of its systems.
class Renderer {
 public:
  Renderer(StandaloneDevice& device, const Model& model, const Lighting& brightest)
      : guest_(device, device.host(), model, brightest),
        memory_(device, kLightBytes, guest_.solver().buffers()[0].usage) {
    for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
      add_light(device, model, s);
      add_materials(device, model, s);
    }
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
  }

  /// Records a frame whose irradiance goes to `targets`.
  FramePlan record(FrameRing& ring, VkCommandBuffer commands, const Shown& now, std::span<const Rgb> sky,
                   std::span<const IrradianceTarget> targets) {
    FramePlan plan = guest_.solver().plan(guest_.schedule(), FrameWishes{.bounces = 12});
    const kernels::MaterialState state = replaced_material(now.accent, std::nullopt);
    std::vector<const MaterialPass*> passes;
    for (std::uint32_t s = 0; s < lights_.size(); ++s) {
      vkCmdUpdateBuffer(commands, states_[s].buffer, states_[s].offset + kAccent * sizeof state, sizeof state,
                        &state);
      passes.push_back(&*materials_[s]);
    }
    const auto write_inputs = [&](VkCommandBuffer into, std::uint32_t s) {
      const Staging staging = ring.staging(lights_[s]->staging_bytes(now.lights.size()));
      lights_[s]->record(into, light_schedules_[s], staging, ~std::uint64_t{0});
    };
    const InputCopy copies[] = {
        {Quantity::sky, static_cast<std::uint32_t>(lights_.size()), 0, ring.stage(sky)}};
    const auto recorded = guest_.solver().record_frame(
        commands, {.plan = &plan, .copies = copies, .materials = passes, .write_inputs = write_inputs},
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

  Guest guest_;
  GuardedMemory memory_;
  std::vector<BufferRange> occluders_;
  std::vector<std::optional<DirectLight>> lights_;
  std::vector<LightSchedule> light_schedules_;
  std::vector<std::optional<MaterialPass>> materials_;
  std::vector<BufferRange> states_;
};

class DeviceFrames : public DeviceTest {};

// Every fifth command buffer is dropped: the frame after it starts from the values before it.
TEST_F(DeviceFrames, LampWallAndSkyAgreeWithTheReferenceOfTheFrame) {
  const Scene scene = half_a_roof();
  PrecomputeOptions options;
  options.texel_size = 0.4;
  options.cluster_size = 0.8;
  options.quality = 32;
  options.system_lumels = 300;
  const Model model = precompute_or_throw(scene, options);
  ASSERT_GE(model.systems.size(), 2u);
  ASSERT_GT(model.sky_cells.size(), 0u);
  Lighting brightest = stored_lighting(model);
  for (Rgb& direct : brightest.direct) direct = Rgb(3000.0);
  for (Rgb& sky : brightest.sky_radiosity) sky = Rgb(kPi * 900.0);
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
    // Within what the plan promised, and near: 12 bounces a frame leave little.
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
