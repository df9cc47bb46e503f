// SPDX-License-Identifier: MIT
//
// The level above the bounces on a device.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "compute/device_fixture.h"
#include "compute/room_tables.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/standalone/solver_session.h"
#include "compute/test_models.h"
#include "core/methods/bounce_problem.h"

namespace relume::test {
namespace {

constexpr std::uint32_t kClusters = 6;  // of a room
constexpr double kDoor = 0.01;          // of the view of each cluster is the other room

/// Two rooms, each a system, in which all clusters see the same: 1 - kDoor of their own room, evenly.
Model two_rooms() {
  std::vector<DrawnSystem> systems(2);
  for (std::uint32_t room = 0; room < 2; ++room) {
    DrawnSystem& drawn = systems[room];
    std::vector<double> row;
    for (std::uint32_t i = 0; i < 2 * kClusters; ++i) {
      drawn.imports.push_back({i / kClusters, i % kClusters});
      row.push_back((i / kClusters == room ? 1.0 - kDoor : kDoor) / kClusters);
    }
    drawn.bounce.assign(kClusters, row);
    drawn.gather.assign(1, row);
  }
  Model model = drawn_model(systems, 0, {ValueCodec::f32, kMaxBlockBytes, 8});
  for (System& system : model.systems) {
    for (Cluster& cluster : system.clusters) cluster.area = 1.0f;
  }
  return model;
}

/// Albedos of 0.97 to 0.995 in red; a lamp in the first room.
Lighting lit(double less) {
  Lighting lighting = uniform_lighting(2 * kClusters, Rgb(0.0), Rgb(0.0));
  for (std::uint32_t i = 0; i < 2 * kClusters; ++i)
    lighting.albedo[i] = Rgb(0.97 + 0.005 * (i % kClusters), 0.9, 0.2) - less;
  lighting.exitance[1] = Rgb(100.0, 50.0, 10.0);
  return lighting;
}

/// What is the same everywhere in a room: I_r = sum over rooms s of K_rs (m_s + a_s I_s), m and a the mean
/// exitance and albedo; two equations.
std::vector<Rgb> exact(const Lighting& lighting) {
  Rgb m[2] = {Rgb(0.0), Rgb(0.0)}, a[2] = {Rgb(0.0), Rgb(0.0)};
  for (std::uint32_t i = 0; i < 2 * kClusters; ++i) {
    m[i / kClusters] += lighting.exitance[i] / double(kClusters);
    a[i / kClusters] += lighting.albedo[i] / double(kClusters);
  }
  const double near = 1.0 - kDoor, far = kDoor;
  const Rgb d0 = near * m[0] + far * m[1], d1 = far * m[0] + near * m[1];
  const Rgb a00 = 1.0 - near * a[0], a01 = -far * a[1], a10 = -far * a[0], a11 = 1.0 - near * a[1];
  const Rgb determinant = a00 * a11 - a01 * a10;
  const Rgb irradiance[2] = {(d0 * a11 - a01 * d1) / determinant, (a00 * d1 - a10 * d0) / determinant};
  std::vector<Rgb> radiosity;
  for (std::uint32_t i = 0; i < 2 * kClusters; ++i)
    radiosity.push_back(lighting.exitance[i] + lighting.albedo[i] * irradiance[i / kClusters]);
  return radiosity;
}

RoomWeights weights_of(const Model& model, std::vector<std::uint32_t> room_of_cluster, std::uint32_t count) {
  return room_weights(reference_bounce_matrix(model), cluster_areas(model),
                      {std::move(room_of_cluster), count});
}

RoomWeights weights_of_two(const Model& model) {
  std::vector<std::uint32_t> rooms(2 * kClusters, 0);
  std::fill(rooms.begin() + kClusters, rooms.end(), 1u);
  return weights_of(model, rooms, 2);
}

double worst_error(const std::vector<Rgb>& found, const std::vector<Rgb>& expected) {
  double worst = found.size() == expected.size() ? 0.0 : 1.0;
  for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) {
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(found[i][c] - expected[i][c]) / expected[i][c]);
  }
  return worst;
}

class TwoLevel : public DeviceTest {};

// The error is one irradiance a room, so that one correction takes all of it: of a bounce, its correction,
// and the bounce that shows how good it is.
TEST_F(TwoLevel, RoomsThatSeeEvenlyAreSolvedByOneCorrection) {
  const Model model = two_rooms();
  const Lighting lighting = lit(0.0);
  DeviceSolveOptions options;
  double predicted = 0.0;
  options.choose_method = [&](double bounces) {
    predicted = bounces;
    return DeviceMethod{Method::two_level, weights_of_two(model)};
  };
  const auto out = solve_on_device(device(), model, lighting, {2000, 1e-3}, options);
  ASSERT_TRUE(out) << out.error().message;
  EXPECT_GT(predicted, 300.0);
  EXPECT_EQ(out->method, Method::two_level);
  EXPECT_TRUE(out->solution.fallback.empty()) << out->solution.fallback;
  EXPECT_LE(out->solution.bounces, 3u);
  EXPECT_LT(worst_error(out->solution.radiosity, exact(lighting)), 1e-3);
}

TEST_F(TwoLevel, AgreesWithPlainBouncesInScenesThatAreNotEven) {
  const Model model = random_model({.nodes = 9, .spanning_nodes = 20, .row_sum = 0.999}, 61);
  Lighting lighting = random_lighting(model, 62);
  for (Rgb& albedo : lighting.albedo) albedo = 0.9 + 0.09 * albedo;
  const StopRule rule{5000, 1e-5};
  const auto plain = solve_on_device(device(), model, lighting, rule);
  std::vector<std::uint32_t> rooms(cluster_offsets(model).back());
  for (std::size_t i = 0; i < rooms.size(); ++i) rooms[i] = i % 11 == 0 ? kNone : std::uint32_t(i % 3);
  DeviceSolveOptions options;
  options.choose_method = [&](double) {
    return DeviceMethod{Method::two_level, weights_of(model, rooms, 3)};
  };
  const auto corrected = solve_on_device(device(), model, lighting, rule, options);
  ASSERT_TRUE(plain && corrected);
  EXPECT_LT(worst_error(corrected->solution.radiosity, plain->solution.radiosity), 1e-4);
  EXPECT_LT(corrected->solution.bounces, plain->solution.bounces / 2);
  for (const Rgb& value : corrected->solution.radiosity)
    EXPECT_GE(std::min({value.x, value.y, value.z}), 0.0);
}

TEST_F(TwoLevel, KrylovMethodsHaveTheirProductsDoneByTheDevice) {
  const Model model = random_model({.nodes = 9, .spanning_nodes = 20, .row_sum = 0.999}, 64);
  Lighting lighting = random_lighting(model, 65);
  for (Rgb& albedo : lighting.albedo) albedo = 0.9 + 0.09 * albedo;
  const StopRule rule{5000, 1e-5};
  const auto plain = solve_on_device(device(), model, lighting, rule);
  ASSERT_TRUE(plain);
  const NearAndFar levels = near_and_far(reference_bounce_matrix(model), cluster_areas(model));
  for (const Method method : {Method::bicgstab, Method::two_level_gmres}) {
    DeviceSolveOptions options;
    options.choose_method = [&](double) { return DeviceMethod{method, {}, levels}; };
    const auto out = solve_on_device(device(), model, lighting, rule, options);
    ASSERT_TRUE(out) << out.error().message;
    EXPECT_EQ(out->method, method);
    EXPECT_TRUE(out->solution.fallback.empty()) << out->solution.fallback;
    EXPECT_LT(out->solution.bounces, plain->solution.bounces / 2);
    EXPECT_LE(out->solution.error_bound, rule.tolerance);
    EXPECT_LT(worst_error(out->solution.radiosity, plain->solution.radiosity), 1e-4);
    EXPECT_LT(worst_error(out->irradiance, plain->irradiance), 1e-4);
  }
}

// No bound of 1e-12 can be had from 32 bits.
TEST_F(TwoLevel, BicgstabEndsWhereProductsRound) {
  const Model model = two_rooms();
  DeviceSolveOptions options;
  options.choose_method = [&](double) { return DeviceMethod{Method::bicgstab}; };
  const auto out = solve_on_device(device(), model, lit(0.0), {5000, 1e-12}, options);
  ASSERT_TRUE(out) << out.error().message;
  EXPECT_TRUE(out->limited_by_rounding);
  EXPECT_LT(out->solution.bounces, 200u);
  EXPECT_GT(out->rounding_bound, 0.0);
  EXPECT_LT(worst_error(out->solution.radiosity, exact(lit(0.0))), 1e-3);
}

TEST_F(TwoLevel, RefusesMethodsThatNeedTheMatrix) {
  DeviceSolveOptions options;
  options.choose_method = [&](double) { return DeviceMethod{Method::gauss_seidel}; };
  EXPECT_FALSE(solve_on_device(device(), two_rooms(), lit(0.0), {10, 0.0}, options));
}

// Rooms that claim to keep more light than they do overshoot at every correction.
TEST_F(TwoLevel, CorrectionsThatDoNotHelpGiveWayToBounces) {
  const Model model = two_rooms();
  const Lighting lighting = lit(0.1);
  DeviceSolveOptions options;
  options.choose_method = [&](double) {
    RoomWeights weights = weights_of_two(model);
    for (double& weight : weights.weights) weight *= 1.11;
    return DeviceMethod{Method::two_level, weights};
  };
  const auto out = solve_on_device(device(), model, lighting, {2000, 1e-6}, options);
  ASSERT_TRUE(out) << out.error().message;
  EXPECT_FALSE(out->solution.fallback.empty());
  EXPECT_LT(worst_error(out->solution.radiosity, exact(lighting)), 1e-3);
}

// The equations of the rooms are made of the albedo that is there when they are solved.
TEST_F(TwoLevel, FollowsAlbedoThatChanges) {
  const Model model = two_rooms();
  auto session = SolverSession::create(device(), model, {}, {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->correct_by(model, weights_of_two(model)));
  for (const double less : {0.0, 0.15}) {
    const Lighting lighting = lit(less);
    ASSERT_TRUE(session->light(lighting, {}));
    ASSERT_TRUE(session->run({.restart = true, .bounces = 3, .correct = true}));
    const auto radiosity = session->read_radiosity();
    ASSERT_TRUE(radiosity);
    EXPECT_LT(worst_error(*radiosity, exact(lighting)), 1e-3);
  }
}

TEST_F(TwoLevel, RefusesRoomsOfOtherScenes) {
  const Model model = two_rooms();
  RoomWeights weights = weights_of_two(model);
  weights.rooms.count = kMaxDeviceRooms + 1;
  EXPECT_FALSE(room_tables(model, weights));
  const Model other = random_model({}, 63);
  EXPECT_FALSE(room_tables(other, weights_of_two(model)));
  const auto tables = room_tables(model, weights_of_two(model));
  ASSERT_TRUE(tables);
  auto solver = GpuSolver::create(device().host(), other, {});
  ASSERT_TRUE(solver);
  EXPECT_FALSE(solver->bind_rooms(*tables, {}));
}

}  // namespace
}  // namespace relume::test
