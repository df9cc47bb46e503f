// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "core/model_file.h"
#include "support/scene_builder.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

/// A corner of a room with furniture and a lamp, open above: split lumels, emitters, sky.
Scene open_room_with_a_lamp() {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(0.6)), lamp = b.material("lamp", Rgb(0.3), Rgb(50.0));
  b.add_quad("floor", wall, {P(0, 0, 0), P(0, 0, 3), P(4, 0, 3), P(4, 0, 0)});
  b.add_quad("wall/a", wall, {P(0, 0, 0), P(4, 0, 0), P(4, 2, 0), P(0, 2, 0)});
  b.add_quad("wall/b", wall, {P(0, 0, 3), P(0, 0, 0), P(0, 2, 0), P(0, 2, 3)});
  b.add_standing_box("cabinet", wall, P(1.03, 0, 0.57), P(1.71, 0.8, 1.13));
  b.add_box("plate", wall, P(2.2, 0.5, 1.2), P(3.1, 0.54, 2.3), SceneBuilder::Facing::outward);
  b.add_quad("screen", b.material("screen", Rgb(0.5), Rgb(0.0), true),
             {P(0.83, 0, 1.61), P(2.11, 0, 2.77), P(2.11, 1.5, 2.77), P(0.83, 1.5, 1.61)});
  b.add_quad("lamp", lamp, {P(2, 1.8, 1), P(2.4, 1.8, 1), P(2.4, 1.8, 1.3), P(2, 1.8, 1.3)});
  return b.scene();
}

/// The same with faces that lie in each other: hits at equal distance go to the lowest triangle, never to the
/// order of a search tree.
Scene open_room_with_a_rug() {
  Scene scene = open_room_with_a_lamp();
  SceneBuilder b;
  b.scene() = std::move(scene);
  b.add_quad("floor again", 0, {P(0, 0, 0), P(0, 0, 3), P(4, 0, 3), P(4, 0, 0)});
  b.add_quad("rug", 1, {P(2.5, 0, 0.2), P(2.5, 0, 2.1), P(3.7, 0, 2.1), P(3.7, 0, 0.2)});
  return b.scene();
}

std::vector<std::byte> bytes_with(const Scene& scene, std::uint32_t threads, PrecomputeReport& report) {
  PrecomputeOptions options;
  options.cluster_size = 0.2;
  options.texel_size = 0.07;
  options.quality = 64;
  options.threads = threads;
  options.sensors = {{"a", {2.0, 0.0, 0.3}, {0, 1, 0}}, {"b", {2.1, 1.0, 2.0}, {0, -1, 0}}};
  return encode_model(precompute_or_throw(scene, options, &report));
}

TEST(SameBytes, ForAnyNumberOfThreadsAndAnyRun) {
  const Scene scene = open_room_with_a_lamp();
  PrecomputeReport report;
  const auto alone = bytes_with(scene, 1, report);
  EXPECT_GT(report.split_lumels, 20u);
  EXPECT_GT(report.occlusion_rays, 1000u);
  for (const std::uint32_t threads : {1u, 2u, 7u, 0u}) {
    EXPECT_TRUE(bytes_with(scene, threads, report) == alone) << threads << " threads";
  }
}

TEST(SameBytes, WhereFacesLieInEachOther) {
  const Scene scene = open_room_with_a_rug();
  PrecomputeReport report;
  const auto alone = bytes_with(scene, 1, report);
  EXPECT_TRUE(bytes_with(scene, 7, report) == alone);
}

/// Form factors of a row to each sender, by what names it: the same in another model of the same surfaces.
std::map<std::array<float, 3>, float> row_of(const System& system, const CsrMatrix& rows, std::uint32_t row) {
  std::map<std::array<float, 3>, float> named;
  for (auto e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e) {
    const SenderRef& sender = system.imports[rows.column_indices[e]];
    const glm::vec3 at = system.clusters.at(sender.index).centroid;
    named[{at.x, at.y, at.z}] += float(rows.values[e]);
  }
  return named;
}

/// Two closed rooms far enough from each other, with or without a crate in the second.
Scene two_closed_rooms(bool crate) {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(0.6));
  b.add_room("first", wall, P(0.0), P(2.0));
  b.add_room("second", wall, P(3, 0, 0), P(5, 2, 2));
  if (crate) b.add_box("crate", wall, P(3.7, 0.6, 0.7), P(4.2, 1.1, 1.3), SceneBuilder::Facing::outward);
  return b.scene();
}

// Rays are seeded by where they start, not by the number of a row.
TEST(SameBytes, RowsThatDoNotMeetAnAddedObjectStayAsTheyAre) {
  PrecomputeOptions options;
  options.cluster_size = 0.5, options.texel_size = 0.25, options.quality = 64;
  const Model before = precompute_or_throw(two_closed_rooms(false), options);
  const Model after = precompute_or_throw(two_closed_rooms(true), options);
  ASSERT_EQ(before.systems.size(), 1u);
  ASSERT_EQ(after.systems.size(), 1u);
  const System &a = before.systems[0], &b = after.systems[0];
  const CsrMatrix rows_a = decode(a.bounce), rows_b = decode(b.bounce);
  std::map<std::array<float, 3>, std::uint32_t> by_place;
  for (std::uint32_t i = 0; i < b.clusters.size(); ++i) {
    const glm::vec3& at = b.clusters[i].centroid;
    by_place[{at.x, at.y, at.z}] = i;
  }
  std::size_t same = 0;
  for (std::uint32_t i = 0; i < a.clusters.size(); ++i) {
    const glm::vec3& at = a.clusters[i].centroid;
    if (before.nodes[a.clusters[i].node].path.rfind("first/", 0) != 0) continue;
    const auto found = by_place.find({at.x, at.y, at.z});
    ASSERT_NE(found, by_place.end());
    EXPECT_EQ(row_of(a, rows_a, i), row_of(b, rows_b, found->second)) << i;
    ++same;
  }
  EXPECT_GE(same, 96u);
}

}  // namespace
}  // namespace relume::test
