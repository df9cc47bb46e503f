// SPDX-License-Identifier: MIT
//
// Several lightings at once (SolverOptions::lightings): each as a solver of its own would have it, to the
// bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>

#include "compute/device_fixture.h"
#include "compute/frame_ring.h"
#include "compute/guest_solver.h"
#include "compute/near_reference.h"
#include "compute/row_kernels.h"
#include "compute/standalone/solver_session.h"
#include "compute/test_models.h"
#include "core/methods/bounce_problem.h"
#include "core/methods/room_correction.h"

namespace relume::test {
namespace {

/// What comes out of one lighting.
struct Answer {
  std::vector<Rgb> radiosity;
  std::vector<Rgb> irradiance;
  std::vector<IrradianceMoments> moments;
  std::vector<ProbeCoefficients> probes;
};

Answer answer_of(SolverSession& session, std::uint32_t lighting) {
  return {*session.read_radiosity(lighting), *session.read_irradiance(lighting),
          *session.read_directional_irradiance(lighting), *session.read_probes(lighting)};
}

/// Lightings with one albedo, and light of their own.
std::vector<Lighting> lightings_of(const Model& model) {
  std::vector<Lighting> all;
  for (std::uint32_t i = 0; i < kMaxLightings; ++i) {
    all.push_back(random_lighting(model, 40 + i));
    all.back().albedo = all.front().albedo;
  }
  return all;
}

using Prepare = std::function<void(SolverSession&)>;

std::vector<Answer> solve(StandaloneDevice& device, const Model& model, std::span<const Lighting> lightings,
                          SolverOptions options, const PassWishes& wishes, const Prepare& prepare = {}) {
  options.lightings = static_cast<std::uint32_t>(lightings.size());
  auto session = SolverSession::create(device, model, options, {});
  EXPECT_TRUE(session) << session.error().message;
  for (std::uint32_t i = 0; i < options.lightings; ++i) EXPECT_TRUE(session->light(lightings[i], {}, i));
  if (prepare) prepare(*session);
  EXPECT_TRUE(session->run(wishes));
  std::vector<Answer> answers;
  for (std::uint32_t i = 0; i < options.lightings; ++i) answers.push_back(answer_of(*session, i));
  return answers;
}

void expect_same_bits(const Answer& found, const Answer& alone, const std::string& where) {
  EXPECT_FALSE(alone.radiosity.empty());
  EXPECT_TRUE(found.radiosity == alone.radiosity) << "radiosity, " << where;
  EXPECT_TRUE(found.irradiance == alone.irradiance) << "irradiance, " << where;
  EXPECT_TRUE(found.moments == alone.moments) << "moments, " << where;
  EXPECT_TRUE(found.probes == alone.probes) << "probes, " << where;
}

/// Each of `lightings` alone, one after the other.
std::vector<Answer> solve_alone(StandaloneDevice& device, const Model& model,
                                std::span<const Lighting> lightings, const SolverOptions& options,
                                const PassWishes& wishes, const Prepare& prepare = {}) {
  auto session = SolverSession::create(device, model, options, {});
  EXPECT_TRUE(session) << session.error().message;
  if (prepare) prepare(*session);
  std::vector<Answer> alone;
  for (const Lighting& lighting : lightings) {
    EXPECT_TRUE(session->light(lighting, {}) && session->run(wishes));
    alone.push_back(answer_of(*session, 0));
  }
  return alone;
}

class Lightings : public DeviceTest {};

// Each pair of kernel and fetch does 2, 3 and 4 lightings, each with another codec.
TEST_F(Lightings, HaveTheBitsOfASolverOfTheirOwnInEveryRowKernel) {
  std::uint32_t turn = 0;
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    const Model model =
        random_model({.clusters_of_system = {70, 13}, .gather_rows = 45}, 3, {codec, kMaxBlockBytes, 8});
    const std::vector<Lighting> lit = lightings_of(model);
    const PassWishes wishes{.restart = true, .bounces = 3, .gather = true};
    const std::vector<Answer> alone = solve_alone(device(), model, lit, {}, wishes);
    for (const RowKernel kernel : kRowKernels) {
      for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
        const std::uint32_t count = 2 + turn++ % 3;
        if (!supports_row_kernel(device().host(), kernel)) continue;
        const std::vector<Answer> together =
            solve(device(), model, std::span(lit).first(count), {.kernel = kernel, .fetch = fetch}, wishes);
        for (std::uint32_t i = 0; i < count; ++i) {
          expect_same_bits(together[i], alone[i],
                           "lighting " + std::to_string(i) + " of " + std::to_string(count) + ", " +
                               std::string(row_kernel_name(kernel)) + ", fetch " +
                               std::to_string(int(fetch)) + ", codec " + std::to_string(int(codec)));
        }
      }
    }
  }
}

// Trees, nodes above the systems, skies, probes, directions, plain CSR in many blocks, small dispatches.
TEST_F(Lightings, HaveTheBitsOfASolverOfTheirOwnInAllThatAModelHas) {
  const Model model = random_model({.clusters_of_system = {37, 1, 50},
                                    .gather_rows = 30,
                                    .nodes = 12,
                                    .spanning_nodes = 4,
                                    .probes = 6,
                                    .directional = true},
                                   8, {ValueCodec::unorm16, 2000});
  const std::vector<Lighting> lit = lightings_of(model);
  const std::span<const Lighting> three = std::span(lit).first(3);
  const PassWishes wishes{.restart = true, .bounces = 3, .gather = true};
  const std::vector<Answer> alone = solve_alone(device(), model, three, {}, wishes);
  ASSERT_FALSE(alone[0].moments.empty());
  ASSERT_FALSE(alone[0].probes.empty());
  for (const RowKernel kernel : {RowKernel::row_per_thread, RowKernel::row_per_8_lanes}) {
    const SolverOptions options{.kernel = kernel, .max_dispatch_form_factors = 1500};
    const std::vector<Answer> together = solve(device(), model, three, options, wishes);
    for (std::uint32_t i = 0; i < three.size(); ++i)
      expect_same_bits(together[i], alone[i], std::string(row_kernel_name(kernel)));
  }
}

TEST_F(Lightings, HaveTheBitsOfASolverOfTheirOwnInHalfPrecision) {
  const Model model = random_model({.clusters_of_system = {40}, .gather_rows = 30}, 9,
                                   {ValueCodec::sqrt8, kMaxBlockBytes, 8});
  const std::vector<Lighting> lit = lightings_of(model);
  const std::span<const Lighting> two = std::span(lit).first(2);
  const PassWishes wishes{.restart = true, .bounces = 2, .gather = true};
  for (const MatrixFetch fetch : {MatrixFetch::storage, MatrixFetch::texels}) {
    const SolverOptions options{.fetch = fetch, .half_senders_up_to = 1e5};
    const std::vector<Answer> alone = solve_alone(device(), model, two, options, wishes);
    const std::vector<Answer> together = solve(device(), model, two, options, wishes);
    for (std::uint32_t i = 0; i < two.size(); ++i) expect_same_bits(together[i], alone[i], "half senders");
  }
}

// One room per system, of rows that see much of their own.
TEST_F(Lightings, AreCorrectedRoomByRoomEachByItself) {
  const Model model = random_model({.clusters_of_system = {24, 30}, .gather_rows = 8, .sky_patches = 0}, 10,
                                   {ValueCodec::f32, kMaxBlockBytes, 8});
  const std::vector<Lighting> lit = lightings_of(model);
  const std::span<const Lighting> three = std::span(lit).first(3);
  Rooms rooms{std::vector<std::uint32_t>(24, 0), 2};
  rooms.of_cluster.resize(24 + 30, 1);
  const RoomWeights weights = room_weights(reference_bounce_matrix(model), cluster_areas(model), rooms);
  const Prepare with_rooms = [&](SolverSession& session) { EXPECT_TRUE(session.correct_by(model, weights)); };
  const PassWishes wishes{.restart = true, .bounces = 3, .correct = true, .gather = true};
  const std::vector<Answer> alone = solve_alone(device(), model, three, {}, wishes, with_rooms);
  const std::vector<Answer> together = solve(device(), model, three, {}, wishes, with_rooms);
  const std::vector<Answer> plain =
      solve(device(), model, three, {}, {.restart = true, .bounces = 3, .gather = true});
  for (std::uint32_t i = 0; i < three.size(); ++i) {
    expect_same_bits(together[i], alone[i], "rooms");
    EXPECT_NE(together[i].radiosity, plain[i].radiosity);
  }
}

// In a closed room with albedo 1/2, B = M / (1 - 1/2) and I = B; 2^l M gives 2^l as much, and to the bit, as
// doubling is exact. What the last bounce changed, 2^-20 of B, is that of the brightest.
TEST_F(Lightings, OfAFurnaceAreMultiplesOfEachOther) {
  constexpr std::uint32_t kBounces = 20;
  const Model model = furnace_model(96, 32);
  std::vector<Lighting> lit;
  for (std::uint32_t i = 0; i < kMaxLightings; ++i)
    lit.push_back(uniform_lighting(96, Rgb(0.5), double(1u << i) * Rgb(3.0, 2.0, 1.0)));
  auto session = SolverSession::create(device(), model, {.lightings = kMaxLightings}, {});
  ASSERT_TRUE(session) << session.error().message;
  for (std::uint32_t i = 0; i < kMaxLightings; ++i) ASSERT_TRUE(session->light(lit[i], {}, i));
  ASSERT_TRUE(session->run({.restart = true, .bounces = kBounces, .residual = true, .gather = true}));
  const std::vector<Rgb> first = *session->read_radiosity();
  for (const Rgb& value : first) EXPECT_NEAR(value.x, 6.0, 1e-5);
  for (std::uint32_t i = 0; i < kMaxLightings; ++i) {
    const std::vector<Rgb> radiosity = *session->read_radiosity(i);
    ASSERT_EQ(radiosity.size(), first.size());
    for (std::size_t k = 0; k < first.size(); ++k) EXPECT_EQ(radiosity[k], double(1u << i) * first[k]);
  }
  EXPECT_NEAR(session->residual()->change.x, 8.0 * 6.0 * 0x1p-20 / 2.0, 8e-6);
  EXPECT_NEAR(session->residual()->radiosity.x, 48.0, 1e-4);
}

class LightingsInFrames : public Lightings {
 protected:
  /// Some frames that copy this first; all are known to have changed.
  void run(std::span<const InputCopy> copies, std::span<const IrradianceTarget> targets = {}) {
    for (std::uint32_t s = 0; s <= model_.systems.size(); ++s)
      note_change(guest_->solver().traits(), guest_->schedule(), s, 1e4);
    for (int i = 0; i < 40; ++i) {
      const FramePlan plan = guest_->solver().plan(guest_->schedule(), FrameWishes{.bounces = 2});
      EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) {
        const FrameInputs inputs{.plan = &plan, .copies = i == 0 ? copies : std::span<const InputCopy>()};
        const auto recorded = guest_->solver().record_frame(commands, inputs, {.irradiance = targets});
        EXPECT_TRUE(recorded) << recorded.error().message;
      }));
      guest_->schedule() = plan.next;
    }
  }

  void expect_solved(std::uint32_t number, const Lighting& lighting) {
    const auto solved = solve_reference(reference_matrices(model_).bounce, lighting, {10000, 1e-12});
    ASSERT_TRUE(solved) << solved.error().message;
    std::vector<Rgb> found;
    for (std::uint32_t s = 0; s < model_.systems.size(); ++s) {
      const std::uint32_t half = guest_->schedule().systems[s].half;
      const auto part = guest_->memory().read_rgb(guest_->solver().radiosity(s, half, number));
      found.insert(found.end(), part.begin(), part.end());
    }
    EXPECT_TRUE(near_reference("radiosity", found, solved->radiosity)) << "lighting " << number;
    EXPECT_EQ(guest_->memory().damaged_bytes(), 0u);
  }

  Model model_ = random_model({.clusters_of_system = {37, 20}, .gather_rows = 30, .nodes = 6}, 12,
                              {ValueCodec::f32, kMaxBlockBytes, 8});
  std::vector<Lighting> lit_ = lightings_of(model_);
  std::optional<Guest> guest_;
};

// Copies change one of two lightings and leave the other as it is; one may be copied from the other.
TEST_F(LightingsInFrames, ChangeOneByOne) {
  guest_.emplace(device(), device().host(), model_, lit_[0],
                 SolverOptions{.max_dispatch_form_factors = 3000, .lightings = 2});
  FrameRing memory(device(), 1, 1 << 16);
  memory.begin();
  const auto sky = static_cast<std::uint32_t>(model_.systems.size());
  const std::uint32_t first = cluster_offsets(model_)[1];
  const auto direct = std::span(lit_[1].direct).subspan(first);
  const BufferRange target = memory.reserve(guest_->solver().irradiance(1).byte_size);
  const InputCopy copies[] = {{Quantity::direct, 1, 0, memory.stage(direct), 1},
                              {Quantity::sky, sky, 0, memory.stage(lit_[1].sky_radiosity), 1}};
  run(copies, std::array{IrradianceTarget{1, target, 1}});
  Lighting second = lit_[0];
  second.exitance = stored_lighting(model_).exitance;
  second.direct.assign(second.direct.size(), Rgb(0.0));
  std::copy(direct.begin(), direct.end(), second.direct.begin() + first);
  second.sky_radiosity = lit_[1].sky_radiosity;
  expect_solved(0, lit_[0]);
  expect_solved(1, second);
  const auto copied = memory.bytes(0, target);
  const auto irradiance = guest_->memory().bytes(guest_->solver().irradiance(1, 1));
  EXPECT_TRUE(std::equal(copied.begin(), copied.end(), irradiance.begin(), irradiance.end()));

  std::vector<InputCopy> all;
  for (std::uint32_t s = 0; s < sky; ++s) {
    for (const Quantity quantity : {Quantity::exitance, Quantity::direct})
      all.push_back({quantity, s, 0, guest_->solver().input(s, quantity, 0), 1});
  }
  all.push_back({Quantity::sky, sky, 0, guest_->solver().input(sky, Quantity::sky, 0), 1});
  run(all);
  expect_solved(1, lit_[0]);
  memory.drop();
}

TEST_F(LightingsInFrames, ThatAreNotThereAreRefused) {
  for (const std::uint32_t count : {0u, kMaxLightings + 1}) {
    const auto refused = GpuSolver::create(device().host(), model_, {.lightings = count});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::usage);
    EXPECT_EQ(refused.error().message, "lightings: expected 1 to 4, found " + std::to_string(count));
  }
  guest_.emplace(device(), device().host(), model_, lit_[0], SolverOptions{.lightings = 2});
  GpuSolver& solver = guest_->solver();
  EXPECT_EQ(solver.input(0, Quantity::direct, 2).buffer, VkBuffer{});
  EXPECT_EQ(solver.radiosity(0, 0, 2).buffer, VkBuffer{});
  EXPECT_EQ(solver.irradiance(0, 2).buffer, VkBuffer{});
  const FramePlan plan = solver.plan(guest_->schedule(), FrameWishes{});
  const InputCopy copy{Quantity::direct, 0, 0, solver.input(0, Quantity::direct), 2};
  const IrradianceTarget target{0, solver.irradiance(0), 2};
  const auto expect_refused = [&](std::span<const InputCopy> copies,
                                  std::span<const IrradianceTarget> targets) {
    EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) {
      const auto refused =
          solver.record_frame(commands, {.plan = &plan, .copies = copies}, {.irradiance = targets});
      EXPECT_FALSE(refused);
      EXPECT_EQ(refused.error().message, "lighting 2: the solver was made for 2");
    }));
  };
  expect_refused(std::span(&copy, 1), {});
  expect_refused({}, std::span(&target, 1));
}

}  // namespace
}  // namespace relume::test
