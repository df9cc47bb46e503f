// SPDX-License-Identifier: MIT
#include "core/lightmap_texels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

namespace relume::test {
namespace {

using testing::ElementsAre;

using Shown = std::map<std::pair<int, int>, std::vector<std::uint32_t>>;

Shown shown(const LightmapTexels& list) {
  Shown out;
  for (std::size_t i = 0; i < list.texels.size(); ++i) {
    out[{list.texels[i].x, list.texels[i].y}] = {list.lumels.begin() + list.first_lumel[i],
                                                 list.lumels.begin() + list.first_lumel[i + 1]};
  }
  return out;
}

/// Letters are lumels, numbered in their order; 'i' is an invalid one, '.' none.
System drawn(const std::vector<std::string>& rows) {
  System system;
  system.lightmap_width = static_cast<std::uint32_t>(rows[0].size());
  system.lightmap_height = static_cast<std::uint32_t>(rows.size());
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      if (rows[y][x] == '.') continue;
      system.lumels.push_back(
          {std::uint16_t(x), std::uint16_t(y), 0, rows[y][x] == 'i' ? std::uint32_t{kLumelInvalid} : 0u});
    }
  }
  return system;
}

TEST(LightmapTexels, ALumelShowsItself) {
  const Shown texels = shown(lightmap_texels(drawn({"A.B"}), 0));
  EXPECT_EQ(texels.size(), 2u);
  EXPECT_THAT(texels.at({0, 0}), ElementsAre(0u));
  EXPECT_THAT(texels.at({2, 0}), ElementsAre(1u));
}

TEST(LightmapTexels, BordersTakeTheNearestLumels) {
  const Shown texels = shown(lightmap_texels(drawn({".....",  //
                                                    ".AB..",  //
                                                    ".C...",  //
                                                    "....."}),
                                             2));
  EXPECT_THAT(texels.at({0, 0}), ElementsAre(0u));      // corner of A
  EXPECT_THAT(texels.at({2, 0}), ElementsAre(1u));      // above B, nearer than A
  EXPECT_THAT(texels.at({2, 2}), ElementsAre(1u, 2u));  // as far from B as from C
  EXPECT_THAT(texels.at({3, 3}), ElementsAre(1u, 2u));  // (1, 2) from B, (2, 1) from C
  EXPECT_THAT(texels.at({4, 0}), ElementsAre(1u));      // second ring
  EXPECT_THAT(texels.at({4, 1}), ElementsAre(1u));
  EXPECT_EQ(texels.size(), 20u);
}

TEST(LightmapTexels, StopsAtItsRings) {
  const Shown texels = shown(lightmap_texels(drawn({"A........."}), 4));
  EXPECT_EQ(texels.size(), 5u);
  EXPECT_THAT(texels.at({4, 0}), ElementsAre(0u));
}

TEST(LightmapTexels, InvalidLumelsAreFilledHoweverFar) {
  const Shown texels = shown(lightmap_texels(drawn({"Aiiiiiiii."}), 0));
  EXPECT_EQ(texels.size(), 9u);
  EXPECT_THAT(texels.at({8, 0}), ElementsAre(0u));
}

TEST(LightmapTexels, WhereNothingIsValidNothingIsShown) {
  EXPECT_TRUE(lightmap_texels(drawn({"ii", ".i"})).texels.empty());
  EXPECT_TRUE(lightmap_texels(System{}).texels.empty());
}

TEST(LightmapTexels, AreInTheOrderOfTheImage) {
  const LightmapTexels list = lightmap_texels(drawn({"...", ".A.", "..."}), 1);
  ASSERT_EQ(list.texels.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(list.texels[i].y * 3u + list.texels[i].x, i);
}

}  // namespace
}  // namespace relume::test
