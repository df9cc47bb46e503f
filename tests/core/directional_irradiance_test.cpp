// SPDX-License-Identifier: MIT
#include "core/directional_irradiance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "core/model_file.h"
#include "core/packed_direction.h"
#include "core/section_table.h"
#include "support/tiny_model.h"

namespace relume {
namespace {

const glm::dvec3 kUp(0.0, 1.0, 0.0);

/// The tiny model with directions: what the lumel of the floor sees of the lid straight up, the sky aslant
/// and half spread; what its sensor and the lumel of the lid see along +-y.
Model tiny_directional_model() {
  Model model = test::tiny_model();
  for (System& system : model.systems) {
    const glm::dvec3 along = system.name == "floor" ? kUp : -kUp;
    for (MatrixBlock& block : system.gather.blocks) {
      block.directions.assign(block.columns.size() * block.tile_rows, 0);
      for (std::size_t entry = 0; entry < block.columns.size(); ++entry) {
        for (std::uint32_t lane = 0; lane < block.row_count && lane < block.tile_rows; ++lane)
          block.directions[entry * block.tile_rows + lane] =
              pack_direction(block.columns[entry] == 1 ? glm::dvec3(0.3, 0.4, 0.0) : along);
      }
    }
  }
  return model;
}

TEST(PackedDirection, IsNearAndNeverLongerThan1) {
  std::mt19937 random(1);
  const auto unit = [&random] { return double(random()) * 0x1p-31 - 1.0; };
  for (int i = 0; i < 20000; ++i) {
    glm::dvec3 direction(unit(), unit(), unit());
    if (i % 2 == 0 || glm::length(direction) > 1.0) direction = glm::normalize(direction);
    const std::uint32_t code = pack_direction(direction);
    EXPECT_TRUE(is_packed_direction(code));
    const glm::dvec3 found = unpack_direction(code);
    EXPECT_LE(glm::length(found), 1.0 + 1e-12);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], direction[axis], 1.0 / 511.0);
  }
  EXPECT_EQ(unpack_direction(pack_direction(-kUp)), -kUp);
  EXPECT_EQ(unpack_direction(pack_direction(7.0 * kUp)), kUp);
  EXPECT_EQ(pack_direction(glm::dvec3(0.0)), 0u);
}

TEST(PackedDirection, KnowsWhatIsNone) {
  EXPECT_FALSE(is_packed_direction(1u << 30));
  EXPECT_FALSE(is_packed_direction(511u | 1u << 10));  // a little longer than 1
  EXPECT_FALSE(is_packed_direction(512u));             // -512 / 511
}

// A tile of two rows and three columns; the middle column is 0 for both and goes, with its directions. Of the
// others the first row has (1, 0, 0) and (0, 0, -1), the second nothing and (0, 0, 1).
TEST(BlockMatrixBuilder, KeepsDirectionsBesideTheirValues) {
  const std::uint32_t x = pack_direction({1, 0, 0}), z = pack_direction({0, 0, 1}),
                      back = pack_direction({0, 0, -1});
  const std::array<std::uint16_t, 3> columns{2, 5, 9};
  const std::array<double, 6> values{0.25, 0.0, 0.5, 0.0, 0.0, 0.125};
  const std::array<std::uint32_t, 6> directions{x, x, back, x, x, z};
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    BlockMatrixBuilder builder(10, codec);
    builder.append_tile(columns, values, 2, directions);
    const BlockMatrix matrix = std::move(builder).finish();
    EXPECT_TRUE(check_block_matrix(matrix, "test"));
    ASSERT_EQ(matrix.blocks.size(), 1u);
    const MatrixBlock& block = matrix.blocks[0];
    ASSERT_EQ(block.columns, (std::vector<std::uint16_t>{2, 9}));
    std::vector<std::uint32_t> expected(16, 0);
    expected[0] = x, expected[8] = back, expected[9] = z;
    EXPECT_EQ(block.directions, expected);
    EXPECT_EQ(block_bytes(block), 2 * 4 + 2 * 2 + 16 * value_bytes(codec) + 2 * 4 + 16 * 4);
  }
}

TEST(BlockMatrixBuilder, CountsDirectionsWhenItCutsBlocks) {
  const std::array<std::uint16_t, 1> columns{0};
  const std::array<double, 1> values{0.5};
  const std::array<std::uint32_t, 1> directions{pack_direction(kUp)};
  BlockMatrixBuilder builder(1, ValueCodec::f32, 40);
  for (int row = 0; row < 4; ++row) builder.append_row(columns, values, directions);
  for (const MatrixBlock& block : std::move(builder).finish().blocks) EXPECT_LE(block_bytes(block), 40u);
}

// Radiosity 10 of the lid and 20 of the sky: the lumel of the floor receives 0.2 x 10 from above and 0.5 x 20
// from (0.3, 0.4, 0), its sensor 0.25 x 10 from above.
TEST(DirectionalIrradiance, SumsWhatArrivesByHand) {
  const Model model = tiny_directional_model();
  ASSERT_TRUE(is_directional(model));
  EXPECT_FALSE(is_directional(test::tiny_model()));
  Lighting lighting = stored_lighting(model);
  lighting.sky_radiosity = {Rgb(20.0)};
  const auto moments = directional_irradiance(model, lighting, {Rgb(4.0), Rgb(10.0)});
  ASSERT_EQ(moments.size(), 3u);
  EXPECT_NEAR(moments[0][0].g, 3.0, 0.02);
  EXPECT_NEAR(moments[0][1].g, 2.0 + 4.0, 0.02);
  EXPECT_NEAR(moments[0][2].g, 0.0, 1e-9);
  EXPECT_NEAR(moments[1][1].g, 2.5, 1e-6);
  EXPECT_NEAR(moments[2][1].g, -0.8, 1e-6);
  const glm::dvec3 d = dominant_direction(moments[0], Rgb(12.0));
  EXPECT_NEAR(d.x, 0.25, 2e-3);
  EXPECT_NEAR(d.y, 0.5, 2e-3);
  EXPECT_TRUE(directional_irradiance(test::tiny_model(), lighting, {Rgb(4.0), Rgb(10.0)}).empty());
}

TEST(DirectionalIrradiance, ADominantDirectionIsNoLongerThan1AndDarknessHasNone) {
  EXPECT_EQ(dominant_direction({Rgb(0.0), Rgb(0.0), Rgb(0.0)}, Rgb(0.0)), glm::dvec3(0.0));
  EXPECT_NEAR(glm::length(dominant_direction({Rgb(3.0), Rgb(4.0), Rgb(0.0)}, Rgb(4.9))), 1.0, 1e-12);
}

/// A unit vector in the plane of x and y, `angle` from y.
glm::dvec3 tilted(double angle) {
  return {std::sin(angle), std::cos(angle), 0.0};
}

TEST(BentIrradiance, IsRightForAHemisphereAndForOneDirection) {
  for (double angle = 0.0; angle < 1.5; angle += 0.1) {
    const glm::dvec3 bent = tilted(angle);
    EXPECT_NEAR(bent_irradiance_factor(2.0 / 3.0 * kUp, kUp, bent), 0.5 * (1.0 + std::cos(angle)), 1e-9);
    EXPECT_NEAR(bent_irradiance_factor(tilted(-0.5), kUp, bent),
                std::max(0.0, std::cos(angle + 0.5)) / std::cos(0.5), 1e-9);
    EXPECT_NEAR(bent_irradiance_factor(0.8 * tilted(-0.5), bent, bent), 1.0, 1e-12);
  }
}

TEST(BentIrradiance, IsNeverNegativeNorMoreThan4) {
  for (double length = 0.0; length <= 1.0; length += 0.05) {
    for (double from = 0.0; from < 1.57; from += 0.1) {
      for (double to = -3.1; to < 3.1; to += 0.1) {
        const double factor = bent_irradiance_factor(length * tilted(from), kUp, tilted(to));
        EXPECT_GE(factor, 0.0);
        EXPECT_LE(factor, 4.0);
      }
    }
  }
}

std::vector<std::uint32_t> gather_directions(const Model& model) {
  std::vector<std::uint32_t> all;
  for (const System& system : model.systems) {
    for (const MatrixBlock& block : system.gather.blocks)
      all.insert(all.end(), block.directions.begin(), block.directions.end());
  }
  return all;
}

TEST(DirectionsInFiles, ComeBackAsTheyWereAndCanBeSkipped) {
  const Model model = tiny_directional_model();
  const auto bytes = encode_model(model);
  const auto read = decode_model(bytes, "tiny");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(gather_directions(*read), gather_directions(model));
  EXPECT_EQ(encode_model(*read), bytes);
  // Who leaves out the sections has the file without directions.
  SectionWriter file;
  const auto sections = read_sections(bytes, "tiny");
  for (const Section& section : sections.value()) {
    const std::string id(section.record.id.begin(), section.record.id.end());
    if (id != "GDIR") {
      file.add(id, section.record.owner, section.bytes, section.record.flags);
    } else {
      EXPECT_EQ(section.record.flags, kSectionOptional);
    }
  }
  EXPECT_EQ(std::move(file).finish(), encode_model(test::tiny_model()));
}

TEST(DirectionsInFiles, ThatAreWrongAreRefused) {
  const auto refused = [](auto&& edit) {
    Model model = tiny_directional_model();
    edit(model);
    const auto read = decode_model(encode_model(model), "tiny");
    return read ? std::string() : read.error().message;
  };
  EXPECT_NE(refused([](Model& m) {
              m.systems[1].gather.blocks[0].directions[0] = 511u | 511u << 10;
            }).find("no longer than 1, found 0x7fdff"),
            std::string::npos);
  EXPECT_NE(refused([](Model& m) {
              m.systems[0].gather.blocks[0].directions.push_back(0);
            }).find("a direction for each"),
            std::string::npos);
  Model model = tiny_directional_model();
  model.systems[0].bounce.blocks[0].directions = {0};
  EXPECT_FALSE(check_model(model));
}

TEST(DirectionsInFiles, WithoutABlockAreMalformed) {
  SectionWriter file;
  const std::vector<std::byte> bytes = encode_model(test::tiny_model());
  const auto sections = read_sections(bytes, "tiny");
  for (const Section& section : sections.value()) {
    const std::string id(section.record.id.begin(), section.record.id.end());
    const std::array<std::byte, 4> direction{};
    if (id == "GBLK") file.add("GDIR", section.record.owner, direction, kSectionOptional);
    file.add(id, section.record.owner, section.bytes, section.record.flags);
  }
  const auto read = decode_model(std::move(file).finish(), "tiny");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace relume
