// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "core/model_file.h"
#include "precompute/precompute.h"
#include "precompute/rows_file.h"
#include "support/alpha_materials.h"
#include "support/scene_builder.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

/// What differs between the scenes of these tests.
struct Room {
  P box{1.03, 0.0, 0.57};     ///< lower corner of a cabinet
  bool stool = false;         ///< one more thing, before all others
  bool pane = true;           ///< a see-through pane and a grid
  std::optional<double> rug;  ///< x of one that lies in the plane of the floor
  bool post = false;          ///< one in the corner of the room, in its first lumel
  bool second_post = false;   ///< beside its diagonal neighbour's middle
  std::optional<double> lid;  ///< height of that of a double-sided chest
  P lamp{2.0, 1.8, 1.0};
  Rgb wall{0.6}, shine{50.0};
};

/// A room without its front wall: sky, walls that things run through, a lamp, a pane that stops half of the
/// light.
Scene scene_of(const Room& room) {
  SceneBuilder b;
  const auto wall = b.material("wall", room.wall), lamp = b.material("lamp", Rgb(0.3), room.shine);
  if (room.stool)
    b.add_box("stool", wall, P(0.4, 0.3, 2.2), P(0.71, 0.62, 2.5), SceneBuilder::Facing::outward);
  b.add_quad("floor", wall, {P(0, 0, 0), P(0, 0, 3), P(4, 0, 3), P(4, 0, 0)});
  b.add_quad("ceiling", wall, {P(0, 2, 0), P(4, 2, 0), P(4, 2, 3), P(0, 2, 3)});
  b.add_quad("wall/a", wall, {P(0, 0, 0), P(4, 0, 0), P(4, 2, 0), P(0, 2, 0)});
  b.add_quad("wall/b", wall, {P(0, 0, 3), P(0, 0, 0), P(0, 2, 0), P(0, 2, 3)});
  b.add_quad("wall/c", wall, {P(4, 0, 0), P(4, 0, 3), P(4, 2, 3), P(4, 2, 0)});
  b.add_standing_box("cabinet", wall, room.box, room.box + P(0.68, 0.8, 0.56));
  b.add_box("plate", wall, P(2.2, 0.5, 1.2), P(3.1, 0.54, 2.3), SceneBuilder::Facing::outward);
  b.add_quad("screen", b.material("screen", Rgb(0.5), Rgb(0.0), true),
             {P(0.83, 0, 1.61), P(2.11, 0, 2.77), P(2.11, 1.5, 2.77), P(0.83, 1.5, 1.61)});
  if (room.pane) {
    b.add_quad("pane", blend_material(b, Rgb(0.4), 0.5),
               {P(2.8, 0.2, 0.4), P(3.6, 0.2, 0.9), P(3.6, 1.7, 0.9), P(2.8, 1.7, 0.4)});
    b.add_quad("grid", checker_material(b, Rgb(0.4)),
               {P(3.0, 0.1, 2.4), P(3.9, 0.1, 2.6), P(3.9, 1.1, 2.6), P(3.0, 1.1, 2.4)});
    map_last_quad(b, 3, 3);
  }
  if (room.rug) {
    const P r(*room.rug, 0.0, 1.9);
    b.add_quad("rug", wall, {r, r + P(0, 0, 0.7), r + P(1.1, 0, 0.7), r + P(1.1, 0, 0)});
  }
  if (room.post) b.add_standing_box("post", wall, P(0.03, 0, 0.03), P(0.06, 1, 0.06));
  if (room.second_post) b.add_standing_box("post 2", wall, P(0.262, 0, 0.262), P(0.29, 1, 0.29));
  if (room.lid) {
    const auto sheet = b.material("chest", Rgb(0.5), Rgb(0.0), true);
    const P low(0.15, 0.1, 0.2), high(0.85, 0.4, 0.7), up(0, *room.lid - 0.4, 0);
    b.add_standing_box("lid", sheet, P(low.x, 0.4, low.z) + up, P(high.x, 0.45, high.z) + up);
    b.add_quads(
        "chest", sheet,
        {{P(low.x, low.y, low.z), P(high.x, low.y, low.z), P(high.x, low.y, high.z), P(low.x, low.y, high.z)},
         {P(low.x, low.y, low.z), P(low.x, low.y, high.z), P(low.x, high.y, high.z), P(low.x, high.y, low.z)},
         {P(high.x, low.y, high.z), P(high.x, low.y, low.z), P(high.x, high.y, low.z),
          P(high.x, high.y, high.z)},
         {P(high.x, low.y, low.z), P(low.x, low.y, low.z), P(low.x, high.y, low.z), P(high.x, high.y, low.z)},
         {P(low.x, low.y, high.z), P(high.x, low.y, high.z), P(high.x, high.y, high.z),
          P(low.x, high.y, high.z)}});
  }
  const P l = room.lamp;
  b.add_quad("lamp", lamp, {l, l + P(0.4, 0, 0), l + P(0.4, 0, 0.3), l + P(0, 0, 0.3)});
  return b.scene();
}

/// Lumels, sensors and a grid of probes, full rows.
PrecomputeOptions plain_options() {
  PrecomputeOptions options;
  options.cluster_size = 0.4;
  options.texel_size = 0.2;
  options.quality = 32;
  options.sensors = {{"a", {2.0, 0.0, 0.3}, {0, 1, 0}}, {"b", {2.1, 1.0, 2.0}, {0, -1, 0}}};
  options.sensor_quality = 256;
  options.probe_spacing = 1.0;
  return options;
}

PrecomputeOptions few_rays() {
  PrecomputeOptions options = plain_options();
  options.quality = 8, options.sensor_quality = 64, options.probe_spacing = 0.0;
  return options;
}

/// Rays and nodes as an error asks for, directions.
PrecomputeOptions target_options() {
  PrecomputeOptions options;
  options.texel_size = 0.4;
  options.error = 0.3;
  options.probe_spacing = 2.0;
  options.directional = true;
  options.sensors = plain_options().sensors;
  return options;
}

struct Built {
  std::vector<std::byte> model, rows;
  PrecomputeReport report;

  RowsFile file() const { return *decode_rows(rows, "old.rows"); }
  double traced_share() const {
    return double(report.traced_rays) / double(report.traced_rays + report.kept_rays);
  }
};

Built build(const Room& room, PrecomputeOptions options, std::uint32_t threads = 0,
            const RowsFile* old = nullptr, bool keep_rows = true) {
  Built built;
  options.threads = threads;
  options.keep_rows = keep_rows;
  options.old_rows = old, options.old_rows_name = "old.rows";
  const auto model = precompute(scene_of(room), options, built.report);
  EXPECT_TRUE(model) << model.error().message;
  if (!model) return built;
  built.model = encode_model(*model);
  built.rows = built.report.rows.joined();
  return built;
}

using Options = PrecomputeOptions (*)();

/// The update of `before` is what a clean build of `after` is: model and rows, for any number of threads.
Built expect_clean(const Room& before, const Room& after, Options options) {
  const RowsFile old = build(before, options()).file();
  const Built clean = build(after, options());
  Built updated;
  for (const std::uint32_t threads : {1u, 3u}) {
    updated = build(after, options(), threads, &old);
    EXPECT_TRUE(updated.model == clean.model) << threads << " threads";
    EXPECT_TRUE(updated.rows == clean.rows) << threads << " threads";
  }
  EXPECT_TRUE(build(after, options(), 0, &old, /*keep_rows=*/false).model == clean.model);
  return updated;
}

class Update : public testing::TestWithParam<Options> {};

TEST_P(Update, OfAMovedThingIsACleanBuild) {
  const Room before;
  Room after;
  after.box += P(0.31, 0.0, 0.17);
  const Built updated = expect_clean(before, after, GetParam());
  EXPECT_EQ(updated.report.changed_nodes, std::vector<std::string>{"cabinet"});
  EXPECT_LT(updated.traced_share(), 0.6);
}

TEST_P(Update, OfAnAddedThingAndOfOneTakenAwayIsACleanBuild) {
  Room without, with;
  with.stool = true;
  EXPECT_EQ(expect_clean(without, with, GetParam()).report.changed_nodes, std::vector<std::string>{"stool"});
  EXPECT_EQ(expect_clean(with, without, GetParam()).report.changed_nodes, std::vector<std::string>{"stool"});
}

INSTANTIATE_TEST_SUITE_P(Precompute, Update, testing::Values(plain_options, target_options),
                         [](const auto& of) { return of.param == plain_options ? "plain" : "target"; });

TEST(UpdateOf, PanesAndLampsThatMoveIsACleanBuild) {
  Room without_panes, moved_lamp;
  without_panes.pane = false;
  expect_clean(Room(), without_panes, plain_options);
  expect_clean(without_panes, Room(), plain_options);
  moved_lamp.lamp += P(0.5, -0.3, 0.4);
  expect_clean(Room(), moved_lamp, plain_options);
}

TEST(UpdateOf, WhatLiesInOnePlaneWithOthersIsACleanBuild) {
  Room without, here, there;
  here.rug = 0.31, there.rug = 1.93;
  expect_clean(here, there, few_rays);
  expect_clean(without, here, few_rays);
  expect_clean(here, without, few_rays);
}

// The first lumel of the floor is whole, though its middle does not see one of its corners, until a post
// comes between it and a neighbour.
TEST(UpdateOf, PostsInTheCornerOfAFloorIsACleanBuild) {
  Room one, two;
  one.post = two.post = true, two.second_post = true;
  expect_clean(one, two, few_rays);
  expect_clean(two, one, few_rays);
}

// What was inside of a solid is not any more, and the other way round, where nothing but the lid moved.
TEST(UpdateOf, AChestThatOpensOrClosesIsACleanBuild) {
  Room closed, open;
  closed.lid = 0.4, open.lid = 0.7;
  const Built opened = expect_clean(closed, open, few_rays);
  EXPECT_EQ(opened.report.changed_nodes, std::vector<std::string>{"lid"});
  EXPECT_EQ(opened.report.hollow_area, 0.0);
  closed.shine = open.shine = Rgb(0.0);  // lit by the rig
  const Built shut = expect_clean(open, closed, few_rays);
  EXPECT_NEAR(shut.report.hollow_area, 2 * 0.7 * 0.5 + 2 * 0.35 * (0.7 + 0.5), 1e-3);
}

TEST(UpdateOf, ASceneThatTheRigLightsIsACleanBuild) {
  Room before, after;
  before.shine = after.shine = Rgb(0.0);
  after.box += P(0.31, 0.0, 0.17);
  const Built updated = expect_clean(before, after, few_rays);
  const RowsFile rows = updated.file();
  EXPECT_GT(rows.look_grid.points(), 0u);
  EXPECT_EQ(rows.looks.size(), rows.look_grid.points());
  after.stool = true;  // the room stays as large
  expect_clean(after, before, few_rays);
}

TEST(UpdateOf, ColoursAndLightsTracesNothing) {
  Room painted;
  painted.wall = Rgb(0.2), painted.shine = Rgb(400.0);
  const Built updated = expect_clean(Room(), painted, plain_options);
  EXPECT_TRUE(updated.report.changed_nodes.empty());
  EXPECT_EQ(updated.report.traced_rays, 0u);
}

TEST(UpdateOf, OtherProbesTracesOnlyThem) {
  const RowsFile old = build(Room(), plain_options()).file();
  PrecomputeOptions denser = plain_options();
  denser.probe_spacing = 0.7;
  const Built clean = build(Room(), denser), updated = build(Room(), denser, 0, &old);
  EXPECT_TRUE(updated.model == clean.model);
  EXPECT_LT(updated.report.traced_rays, clean.report.traced_rays);
  PrecomputeOptions coarser = plain_options();
  coarser.budget = 64;
  EXPECT_TRUE(build(Room(), coarser, 0, &old).model == build(Room(), coarser).model) << "cut again";
}

TEST(UpdateOf, ProbesPlacedWhereLightChangesIsACleanBuild) {
  PrecomputeOptions options = target_options();
  options.probe_spacing = 0.0, options.auto_probes = true;
  options.error = 0.5;  // few probes
  options.directional = false;
  Room after;
  after.box += P(0.31, 0.0, 0.17);
  const RowsFile old = build(Room(), options).file();
  const Built clean = build(after, options), updated = build(after, options, 0, &old);
  EXPECT_TRUE(updated.model == clean.model);
  EXPECT_TRUE(updated.rows == clean.rows);
}

TEST(UpdateOf, RowsTakesTheirSizesUnlessOthersAreAskedFor) {
  PrecomputeOptions options = plain_options();
  options.texel_size = 0.21, options.cluster_size = 0.47;
  const RowsFile old = build(Room(), options).file();
  options.texel_size = options.cluster_size = 0.0;
  const Built updated = build(Room(), options, 0, &old);
  EXPECT_EQ(updated.report.texel_size, 0.21);
  EXPECT_EQ(updated.report.cluster_size, 0.47);
}

TEST(UpdateOf, KeepingRowsChangesNothingInTheModel) {
  PrecomputeReport report;
  const auto model = precompute(scene_of(Room()), plain_options(), report);
  ASSERT_TRUE(model);
  EXPECT_TRUE(report.rows.empty());
  EXPECT_TRUE(encode_model(*model) == build(Room(), plain_options()).model);
}

std::string refusal(const Scene& scene, const PrecomputeOptions& options) {
  PrecomputeReport report;
  const auto model = precompute(scene, options, report);
  if (model) return "none";
  EXPECT_EQ(model.error().code, ErrorCode::bad_input);
  return model.error().message;
}

TEST(UpdateOf, ForeignRowsAreRefused) {
  const RowsFile old = build(Room(), plain_options()).file();
  PrecomputeOptions options = plain_options();
  options.old_rows = &old, options.old_rows_name = "old.rows";
  options.seed = 1;
  EXPECT_EQ(refusal(scene_of(Room()), options),
            "old.rows: expected rows of --seed 1, found those of 0; precompute without --update");
  options.seed = 0, options.texel_size = 0.3;
  EXPECT_EQ(refusal(scene_of(Room()), options),
            "old.rows: expected rows of --texel-size 0.3, found those of 0.2; precompute without --update");
  options.texel_size = 0.2;
  SceneBuilder other;
  other.add_room("other", other.material("wall", Rgb(0.5)), P(0, 0, 0), P(3, 2, 2));
  EXPECT_NE(refusal(other.scene(), options).find("no triangle in common"), std::string::npos);
}

TEST(RowsFileOf, TornOrMutatedBytesIsRefused) {
  const std::vector<std::byte> good = build(Room(), plain_options()).rows;
  ASSERT_TRUE(decode_rows(good, "r"));
  const std::size_t step = good.size() / 300;
  for (std::size_t at = 0; at < good.size(); at += step) {
    std::vector<std::byte> bad = good;
    bad[at] ^= std::byte{1};
    EXPECT_FALSE(decode_rows(bad, "r")) << "byte " << at;
    bad.resize(at);
    EXPECT_FALSE(decode_rows(bad, "r")) << "cut at " << at;
  }
}

TEST(RowsFileOf, AFutureVersionOrAModelIsRefused) {
  const Built built = build(Room(), plain_options());
  RowsFile future = built.file();
  future.settings.version = 4;
  const auto refused = decode_rows(encode_rows(future), "r");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "r: section 'RINF': expected version 3 of the rows, found 4");
  EXPECT_EQ(refused.error().code, ErrorCode::bad_input);
  EXPECT_FALSE(decode_rows(built.model, "r"));
  RowsFile short_of_rays = built.file();
  short_of_rays.receivers.pop_back();
  EXPECT_FALSE(decode_rows(encode_rows(short_of_rays), "r"));
}

}  // namespace
}  // namespace relume::test
