// SPDX-License-Identifier: MIT
//
// Nodes above the systems, and models of which only some systems are loaded.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "core/missing_share.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "core/section_table.h"
#include "support/matrices.h"
#include "support/tiny_model.h"

namespace relume {
namespace {

/// A matrix of one column.
BlockMatrix column(const std::vector<double>& values) {
  BlockMatrixBuilder builder(1, ValueCodec::f32);
  for (const double value : values)
    builder.append_row(std::vector<std::uint16_t>{0}, std::vector<double>{value});
  return std::move(builder).finish();
}

/// The tiny model; the floor sees the sky, and lid and itself as one node, in which the lid counts three
/// times as much.
Model spanning_model() {
  Model model = test::tiny_model();
  model.top_tree = {{0, 2}};
  model.top_parts = {{{0, 0}, 0.25f}, {{1, 0}, 0.75f}};
  model.systems[0].imports[0] = {kSpanningNodes, 0};
  return model;
}

/// The same file without the lid.
Model without_lid() {
  Model model = spanning_model();
  model.systems[1] = {};
  model.systems[1].name = "lid";
  model.systems[1].loaded = false;
  return model;
}

TEST(SpanningNodes, AreMeansOverTheirSystems) {
  const Model model = spanning_model();
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  const ReferenceMatrices matrices = reference_matrices(model);
  // Leaves: floor, lid, sky; then the node.
  EXPECT_EQ(test::to_dense(matrices.bounce.nodes), (test::DenseMatrix{{0.25, 0.75, 0.0}}));
  Lighting lighting = test::uniform_lighting(2, Rgb(0.5), Rgb(0.0));
  lighting.sky_radiosity = {Rgb(0.0)};
  // (1 x 8 + 3 x 4) / 4 = 5, of which 0.2 reach the floor, which reflects half.
  EXPECT_NEAR(bounce(matrices.bounce, lighting, {Rgb(8.0), Rgb(4.0)})[0].x, 0.5, 1e-7);
}

TEST(SpanningNodes, ComeBackFromAFile) {
  const Model model = spanning_model();
  const auto read = decode_model(encode_model(model), "spanning");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->top_tree, model.top_tree);
  EXPECT_EQ(read->top_parts, model.top_parts);
}

TEST(SpanningNodes, BrokenPromisesAreRefused) {
  struct Breakage {
    std::function<void(Model&)> breaker;
    const char* part;
  };
  const std::vector<Breakage> breakages{
      {[](Model& m) { m.top_tree[0].part_count = 1; }, "expected at least 2 parts from 0 on, found 1 from 0"},
      {[](Model& m) { m.top_tree[0].part_count = 3; }, "found 3 from 0 on of 2"},
      {[](Model& m) { m.top_tree[0].first_part = 1; }, "found 2 from 1 on of 2"},
      {[](Model& m) {
         m.top_tree.clear(), m.systems[0].imports[0] = {1, 0};
       },
       "expected 0 parts, as they have, found 2"},
      {[](Model& m) { m.top_parts[1] = m.top_parts[0]; }, "parts in systems that ascend, found 0 after 0"},
      {[](Model& m) { std::swap(m.top_parts[0], m.top_parts[1]); }, "that ascend, found 0 after 1"},
      {[](Model& m) { m.top_parts[1].share = 0.5f; },
       "expected shares from 0 to 1 that add up to 1, found 0.75"},
      {[](Model& m) { m.top_parts[1].share = std::nanf(""); }, "add up to 1, found nan"},
      {[](Model& m) { m.top_parts[1].sender.system = 2; }, "part 1: expected a system below 2, found 2"},
      {[](Model& m) { m.top_parts[1].sender.system = kSkySystem; }, "part 1: expected a system below 2"},
      {[](Model& m) {
         m.top_parts[1].sender = {kSpanningNodes, 0};
       },
       "part 1: expected a system below 2"},
      {[](Model& m) { m.top_parts[1].sender.index = 1; },
       "part 1: expected a cluster or node below 1, found 1"},
      {[](Model& m) { m.systems[0].imports[0].index = 1; },
       "import 0: expected a node above the systems below 1, found 1"},
  };
  for (const Breakage& breakage : breakages) {
    Model model = spanning_model();
    breakage.breaker(model);
    const auto checked = check_model(model);
    ASSERT_FALSE(checked) << breakage.part;
    EXPECT_NE(checked.error().message.find(breakage.part), std::string::npos) << checked.error().message;
  }
}

TEST(SpanningNodes, WhateverPassesTheChecksIsSafeToUse) {
  const std::vector<std::byte> bytes = encode_model(spanning_model());
  const std::vector<Section> sections = read_sections(bytes, "spanning").value();
  int accepted = 0, refused = 0;
  for (const std::string changed : {"TOPN", "TOPP", "IMPT"}) {
    for (std::size_t word = 0; word < 6; ++word) {
      for (const std::uint32_t value :
           {0u, 1u, 2u, 0x7fffffffu, 0xfffffffeu, 0xffffffffu, 0x3f800000u, 0x7f800000u}) {
        SectionWriter file;
        for (const Section& section : sections) {
          const std::string id(section.record.id.begin(), section.record.id.end());
          std::vector<std::byte> content(section.bytes.begin(), section.bytes.end());
          if (id == changed && 4 * word < content.size()) std::memcpy(&content[4 * word], &value, 4);
          file.add(id, section.record.owner, content);
        }
        const auto read = decode_model(std::move(file).finish(), "changed");
        ++(read ? accepted : refused);
        if (!read) continue;
        for (const double b : missing_share(*read).clusters) EXPECT_EQ(b, 0.0);
        EXPECT_TRUE(solve_reference(reference_bounce_matrix(*read), stored_lighting(*read), {3, 0.0}));
      }
    }
  }
  EXPECT_GT(accepted, 10) << "some words stay as they are";
  EXPECT_GT(refused, 60);
}

TEST(SystemsNotLoaded, AreBlackAndTheirShareStillCounts) {
  const Model model = without_lid();
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  const ReferenceMatrices matrices = reference_matrices(model);
  EXPECT_EQ(test::to_dense(matrices.bounce.nodes), (test::DenseMatrix{{0.25, 0.0}}));
  EXPECT_EQ(matrices.bounce.rows.rows, 1u);
  // Of the 0.2 and 0.25 that see the node, three quarters see the lid.
  const MissingShare share = missing_share(model);
  ASSERT_EQ(share.clusters.size(), 1u);
  EXPECT_NEAR(share.clusters[0], 0.15, 1e-7);
  ASSERT_EQ(share.gather.size(), 2u);
  EXPECT_NEAR(share.gather[0], 0.15, 1e-5) << "16 bits";
  EXPECT_NEAR(share.gather[1], 0.1875, 1e-5);
}

TEST(SystemsNotLoaded, ASenderOfTheirsIsAllMissing) {
  Model model = without_lid();
  model.systems[0].imports[0] = {1, 7};  // whether the lid has it is not known
  model.top_tree.clear();
  model.top_parts.clear();
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  EXPECT_NEAR(missing_share(model).clusters[0], 0.2, 1e-7);
  EXPECT_EQ(reference_bounce_matrix(model).rows.values.size(), 1u) << "the sky is left";
}

TEST(SystemsNotLoaded, ThatHoldSomethingAreRefused) {
  Model model = without_lid();
  model.systems[1].lumels.resize(1);
  ASSERT_FALSE(check_model(model));
  EXPECT_NE(
      check_model(model).error().message.find("system 1: expected nothing in a system that is not loaded"),
      std::string::npos);
}

TEST(MissingLight, IsZeroWhenAllIsLoaded) {
  const MissingShare share = missing_share(spanning_model());
  EXPECT_EQ(share.clusters, (std::vector<double>{0.0, 0.0}));
  EXPECT_EQ(share.gather, (std::vector<double>{0.0, 0.0, 0.0}));
}

// Two surfaces that see half of each other: B0 = 100 + 0.5 x 0.5 B1, B1 = 0.8 x 0.5 B0. So B0 = 100 / 0.9, B1
// = 40 / 0.9. Alone, surface 0 has 100: it lacks 100 / 9, all of it through its hole of 0.5.
TEST(MissingLight, IsExactWhenTheAssumptionIs) {
  Model model = spanning_model();
  model.systems[0].imports = {{1, 0}};
  model.systems[0].bounce = model.systems[1].bounce = column({0.5});
  model.systems[0].gather = column({0.5, 0.25});
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  Lighting both = test::uniform_lighting(2, Rgb(0.5), Rgb(0.0));
  both.exitance[0] = Rgb(100.0);
  both.albedo[1] = Rgb(0.8);
  both.sky_radiosity = {Rgb(0.0)};
  const auto full = solve_reference(reference_bounce_matrix(model), both, {10000, 1e-12});
  ASSERT_TRUE(full);
  EXPECT_NEAR(full->radiosity[0].x, 100.0 / 0.9, 1e-6);

  Model part = model;
  part.systems[1] = without_lid().systems[1];
  Lighting alone = test::uniform_lighting(1, Rgb(0.5), Rgb(100.0));
  alone.sky_radiosity = {Rgb(0.0)};
  const SenderMatrix matrix = reference_bounce_matrix(part);
  const auto left = solve_reference(matrix, alone, {10000, 1e-12});
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->radiosity[0].x, 100.0, 1e-9);
  for (const double factor : {1.0, 3.0}) {
    const Lighting missing = missing_light(alone, missing_share(part), factor * full->radiosity[1]);
    const auto lacking = solve_reference(matrix, missing, {10000, 1e-12});
    ASSERT_TRUE(lacking);
    EXPECT_NEAR(lacking->radiosity[0].x, factor * 100.0 / 9.0, 1e-6);
  }
}

/// A model in a file of its own, for as long as the test runs.
class SystemsOfAFile : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_model(spanning_model(), file_)); }
  void TearDown() override { std::filesystem::remove(file_); }

  std::vector<std::byte> bytes() const { return encode_model(spanning_model()); }
  void write(std::span<const std::byte> content) const {
    std::ofstream stream(file_, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(content.data()), std::streamsize(content.size()));
  }

  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("relume_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".relume");
  const std::vector<std::string> floor_{"floor"}, lid_{"lid"};
};

TEST_F(SystemsOfAFile, AreListed) {
  const auto names = read_system_names(file_);
  ASSERT_TRUE(names) << names.error().message;
  EXPECT_EQ(*names, (std::vector<std::string>{"floor", "lid"}));
}

TEST_F(SystemsOfAFile, AllOfThemAreTheModel) {
  const auto all = read_systems(file_, std::vector<std::string>{"lid", "floor", "lid"});
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(encode_model(*all), bytes());
}

TEST_F(SystemsOfAFile, OneAloneKeepsItsNumber) {
  const auto model = read_systems(file_, lid_);
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->systems.size(), 2u);
  EXPECT_FALSE(model->systems[0].loaded);
  EXPECT_EQ(model->systems[0].name, "floor");
  EXPECT_TRUE(model->systems[0].clusters.empty());
  EXPECT_TRUE(model->systems[1].loaded);
  EXPECT_EQ(model->systems[1].imports, (std::vector<SenderRef>{{0, 0}}));
  EXPECT_NEAR(missing_share(*model).clusters[0], 0.2, 1e-5) << "8 bits";
}

TEST_F(SystemsOfAFile, OthersAreNotReadAndTheirErrorsNotSeen) {
  std::vector<std::byte> damaged = bytes();
  damaged.back() ^= std::byte{1};  // gather matrix of the lid
  write(damaged);
  EXPECT_FALSE(read_model(file_));
  EXPECT_TRUE(read_systems(file_, floor_));
  const auto lid = read_systems(file_, lid_);
  ASSERT_FALSE(lid);
  EXPECT_EQ(lid.error().code, ErrorCode::bad_input);
  EXPECT_NE(lid.error().message.find("section 'GBLK' of system 1"), std::string::npos) << lid.error().message;
}

TEST_F(SystemsOfAFile, TruncatedFilesAreRefused) {
  const std::vector<std::byte> whole = bytes();
  for (std::size_t length = 0; length < whole.size(); length += 61) {
    write(std::span(whole).first(length));
    const auto read = read_systems(file_, floor_);
    ASSERT_FALSE(read) << length << " bytes";
    EXPECT_EQ(read.error().code, ErrorCode::bad_input);
    EXPECT_FALSE(read_system_names(file_));
  }
}

TEST_F(SystemsOfAFile, FlippedBitsOfWhatIsReadAreRefused) {
  std::vector<std::byte> flipped = bytes();
  const std::vector<Section> sections = read_sections(flipped, "whole").value();
  for (const Section& section : sections) {
    const bool read = section.record.owner != 1;
    const std::uint64_t middle = section.record.offset + section.record.length / 2;
    flipped[middle] ^= std::byte{4};
    write(flipped);
    const std::string id(section.record.id.begin(), section.record.id.end());
    EXPECT_EQ(bool(read_systems(file_, floor_)), !read && id != "SYST") << describe(section.record);
    flipped[middle] ^= std::byte{4};
  }
}

TEST_F(SystemsOfAFile, NamesThatAreNotThereAreRefused) {
  const auto read = read_systems(file_, std::vector<std::string>{"floor", "roof"});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::usage);
  EXPECT_NE(read.error().message.find("expected one of the systems floor, lid, found 'roof'"),
            std::string::npos);
  EXPECT_FALSE(read_systems(file_, {}));
  EXPECT_FALSE(read_systems(testing::TempDir(), floor_)) << "a folder is not a file";
}

TEST_F(SystemsOfAFile, APartIsNotWrittenAsAModel) {
  const auto model = read_systems(file_, floor_);
  ASSERT_TRUE(model);
  const auto written = write_model(*model, file_);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("found system lid not loaded"), std::string::npos);
}

}  // namespace
}  // namespace relume
