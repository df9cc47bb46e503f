// SPDX-License-Identifier: MIT
//
// Scenes in several systems: the same light as in one, few senders of what is far, bounds for what is not
// loaded.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "core/missing_share.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "support/rooms_in_a_row.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

PrecomputeOptions options(std::uint32_t system_lumels, std::uint32_t budget = 0) {
  PrecomputeOptions result;
  result.cluster_size = 0.5;
  result.texel_size = 0.25;
  result.quality = 64;
  result.budget = budget;
  result.system_lumels = system_lumels;
  return result;
}

constexpr std::uint32_t kOneSystem = 1u << 20;

LightSources bulb() {
  Light light;
  light.intensity = {100.0, 80.0, 60.0};
  light.position = {1.5, 2.2, 1.7};
  return {{light}, {}};
}

GatheredIrradiance lit(const Model& model, const Scene& scene) {
  return solve_and_gather(model, light(model, scene, bulb()));
}

/// Irradiance by the place of the lumel: the same rays give the same lumels, whichever system they are in.
using Places = std::map<std::array<float, 6>, Rgb>;

Places by_place(const Model& model, const std::vector<Rgb>& gather_rows) {
  Places places;
  const auto rows = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t l = 0; l < system.lumels.size(); ++l) {
      const SurfaceElement& e = system.elements[system.lumels[l].element];
      places[{e.position.x, e.position.y, e.position.z, e.normal.x, e.normal.y, e.normal.z}] =
          gather_rows[rows[s] + l];
    }
  }
  return places;
}

TEST(Systems, TheSameLightAsInOne) {
  const Scene scene = rooms_in_a_row({4.0, 3.0});
  const Model one = precompute_or_throw(scene, options(kOneSystem)),
              many = precompute_or_throw(scene, options(600));
  ASSERT_EQ(one.systems.size(), 1u);
  ASSERT_GE(many.systems.size(), 3u);
  const Places expected = by_place(one, lit(one, scene).indirect),
               found = by_place(many, lit(many, scene).indirect);
  ASSERT_EQ(found.size(), expected.size());
  // Form factors are the same 32-bit numbers; the sums over some hundred of them run in another order, and
  // row scales are rounded.
  for (const auto& [place, value] : found) {
    ASSERT_TRUE(expected.contains(place));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected.at(place)[c], 3e-6 * expected.at(place)[c]);
  }
}

TEST(Systems, ACutAcrossThemIsAsGoodAsInOne) {
  const Scene scene = rooms_in_a_row({4.0, 3.0, 4.0});
  const Model full = precompute_or_throw(scene, options(kOneSystem));
  const Places truth = by_place(full, lit(full, scene).indirect);
  std::vector<double> errors;
  for (const std::uint32_t lumels : {kOneSystem, 500u}) {
    const Model cut = precompute_or_throw(scene, options(lumels, 96));
    std::vector<Rgb> values, expected;
    for (const auto& [place, value] : by_place(cut, lit(cut, scene).indirect)) {
      values.push_back(value);
      expected.push_back(truth.at(place));
    }
    const Agreement a = agreement(values, expected);
    // As the cut in one system: rooms of different brightness share nodes.
    EXPECT_LT(std::abs(a.bias), 0.02) << cut.systems.size() << " systems";
    RecordProperty("nrmse_" + std::to_string(cut.systems.size()), std::to_string(a.nrmse));
    errors.push_back(a.nrmse);
  }
  EXPECT_LT(errors[0], 0.05);
  EXPECT_LT(errors[1], 1.2 * errors[0]) << "nodes that must end at systems may cost a little";
}

/// Rooms in systems of their own.
Scene named_rooms(std::size_t count) {
  Scene scene = rooms_in_a_row(std::vector<double>(count, 4.0));
  for (SceneNode& node : scene.nodes) node.extras.system = "room" + std::string(1, node.path[4]);
  return scene;
}

TEST(Systems, SendersFarAwayAreFewAndCoarse) {
  const Scene scene = named_rooms(4);
  const Model model = precompute_or_throw(scene, options(kOneSystem, 48));
  ASSERT_EQ(model.systems.size(), 4u);
  std::array<std::size_t, 4> imports{};
  std::size_t spanning = 0;
  for (const SenderRef& sender : model.systems[0].imports) {
    if (sender.system < 4) ++imports[sender.system];
    if (sender.system == kSpanningNodes) ++spanning;
  }
  EXPECT_GT(spanning, 0u);
  EXPECT_FALSE(model.top_tree.empty());
  // Of its own clusters the room needs nodes on all levels; of the last room, seen through three doors, a
  // few.
  EXPECT_GT(imports[0], model.systems[0].clusters.size() / 2);
  EXPECT_LT(imports[3], model.systems[3].clusters.size() / 6);
  EXPECT_LT(imports[3], imports[1]);
}

TEST(Systems, MissingLightIsBoundedWhateverIsNotLoaded) {
  const Scene scene = named_rooms(3);
  const Model model = precompute_or_throw(scene, options(kOneSystem, 48));
  const auto file = std::filesystem::path(testing::TempDir()) / "relume_missing_light_test.relume";
  ASSERT_TRUE(write_model(model, file));
  const RunTimeLighting all = light(model, scene, bulb());
  const auto exact = solve_reference(reference_bounce_matrix(model), all.lighting, {10000, 1e-9});
  ASSERT_TRUE(exact);
  const std::vector<Rgb> irradiance =
      gather(reference_matrices(model).gather, all.lighting, exact->radiosity);
  const auto clusters = cluster_offsets(model), rows = gather_offsets(model);
  for (std::size_t kept = 0; kept < model.systems.size(); ++kept) {
    const Model part = read_systems(file, std::vector{model.systems[kept].name}).value();
    Rgb brightest(0.0);
    for (std::size_t c = 0; c < exact->radiosity.size(); ++c) {
      if (c < clusters[kept] || c >= clusters[kept + 1]) brightest = glm::max(brightest, exact->radiosity[c]);
    }
    const Lighting own = light(part, scene, bulb()).lighting;
    const MissingShare share = missing_share(part);
    const Lighting missing = missing_light(own, share, brightest);
    const ReferenceMatrices matrices = reference_matrices(part);
    const auto found = solve_reference(matrices.bounce, own, {10000, 1e-9});
    const auto lacking = solve_reference(matrices.bounce, missing, {10000, 1e-9});
    ASSERT_TRUE(found && lacking);
    const auto i = gather(matrices.gather, own, found->radiosity);
    const auto d = gather(matrices.gather, missing, lacking->radiosity);
    double largest = 0.0;
    for (std::size_t r = 0; r < i.size(); ++r) {
      const double truth = irradiance[rows[kept] + r].r, bound = d[r].r + share.gather[r] * brightest.r;
      EXPECT_LE(i[r].r, truth * (1.0 + 1e-6));
      EXPECT_LE(truth, (i[r].r + bound) * (1.0 + 1e-6));
      largest = std::max(largest, share.gather[r]);
    }
    EXPECT_GT(largest, 0.1) << "the door";
    EXPECT_LE(largest, 1.0 + 1e-6);
  }
  std::filesystem::remove(file);
}

TEST(Systems, TheSameBytesForAnyNumberOfThreads) {
  std::vector<std::byte> alone;
  for (const std::uint32_t threads : {1u, 2u, 7u}) {
    PrecomputeOptions chosen = options(400, 32);
    chosen.threads = threads;
    const auto bytes = encode_model(precompute_or_throw(rooms_in_a_row({4.0, 3.0, 2.0}), chosen));
    if (alone.empty()) alone = bytes;
    EXPECT_TRUE(bytes == alone) << threads << " threads";
  }
}

TEST(Systems, SillySizesAreRefused) {
  for (const std::uint32_t lumels : {0u, 63u, (1u << 24) + 1u}) {
    PrecomputeReport report;
    const auto model = precompute(rooms_in_a_row({4.0}), options(lumels), report);
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, ErrorCode::usage);
    EXPECT_NE(model.error().message.find("expected 64 to 16777216 lumels in a system"), std::string::npos);
  }
}

}  // namespace
}  // namespace relume::test
