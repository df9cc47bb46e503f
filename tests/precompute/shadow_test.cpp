// SPDX-License-Identifier: MIT
#include "precompute/shadow.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

namespace relume::test {
namespace {

class Draw {
 public:
  float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine_); }
  glm::vec3 point(float reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }
  glm::vec3 within(const Ball& ball) {
    for (;;) {
      const glm::vec3 p = point(1.0f);
      if (glm::dot(p, p) <= 1.0f) return ball.middle + ball.radius * p;
    }
  }

 private:
  std::mt19937 engine_{7};
};

/// By slabs (T. Kay, J. Kajiya, Ray Tracing Complex Scenes, 1986).
bool segment_meets(const Box& box, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 to_lower = (box.lower - a) / (b - a), to_upper = (box.upper - a) / (b - a);
  const glm::vec3 enter = glm::min(to_lower, to_upper), leave = glm::max(to_lower, to_upper);
  return std::max({enter.x, enter.y, enter.z, 0.0f}) <= std::min({leave.x, leave.y, leave.z, 1.0f});
}

TEST(Shadow, NothingThatTheBoxHidesIsClear) {
  Draw draw;
  int clear = 0, hidden = 0;
  for (int i = 0; i < 10000; ++i) {
    const glm::vec3 corner = draw.point(2.0f);
    const Box box{corner, corner + 1.01f + draw.point(1.0f)};
    const Ball from{draw.point(4.0f), draw.in(0.0f, 0.3f)}, to{draw.point(4.0f), draw.in(0.0f, 0.5f)};
    const bool is_clear = Shadow(box, from.middle, std::max(from.radius, draw.in(0.0f, 0.5f))).clear_of(to);
    clear += is_clear ? 1 : 0;
    for (int ray = 0; ray < 16; ++ray) {
      const bool meets = segment_meets(box, draw.within(from), draw.within(to));
      hidden += meets ? 1 : 0;
      ASSERT_FALSE(is_clear && meets) << i;
    }
  }
  EXPECT_GT(clear, 2000);
  EXPECT_GT(hidden, 2000);
}

TEST(Shadow, WhatIsBesideBeforeOrTooLargeIsTold) {
  const Box box{{2, -1, -1}, {3, 1, 1}};
  const Shadow shadow(box, {0, 0, 0}, 0.25f);
  EXPECT_FALSE(shadow.clear_of({{6, 0, 0}, 0.1f})) << "behind";
  EXPECT_TRUE(shadow.clear_of({{1, 0, 0}, 0.1f})) << "before";
  EXPECT_TRUE(shadow.clear_of({{-5, 0, 0}, 0.1f})) << "on the other side";
  EXPECT_TRUE(shadow.clear_of({{3.5f, 5, 0}, 0.1f})) << "beside";
  EXPECT_FALSE(shadow.clear_of({{3.5f, 5, 0}, 0.3f})) << "too large to tell";
  EXPECT_FALSE(Shadow(box, {2.5f, 0, 0}, 0.25f).clear_of({{-5, 0, 0}, 0.1f})) << "from within the box";
  EXPECT_FALSE(Shadow().clear_of({{0, 0, 0}, 0.0f}));
}

TEST(Shadow, OfManyBallsTellsWhatItTellsOfEach) {
  Draw draw;
  Balls balls;
  for (int i = 0; i < 101; ++i) balls.push_back({draw.point(4.0f), draw.in(0.0f, 0.5f)});
  int clear_balls = 0;
  for (int i = 0; i < 100; ++i) {
    const glm::vec3 corner = draw.point(2.0f);
    const Shadow shadow({corner, corner + 1.01f + draw.point(1.0f)}, draw.point(4.0f), draw.in(0.0f, 0.5f));
    std::vector<std::uint8_t> clear(balls.size() + 1, 7);
    shadow.clear_of(balls, clear);
    for (std::size_t b = 0; b < balls.size(); ++b) {
      ASSERT_EQ(clear[b], shadow.clear_of(balls.at(b)) ? 1 : 0) << i << " " << b;
      clear_balls += clear[b];
    }
    ASSERT_EQ(clear.back(), 7) << "beyond the balls";
  }
  EXPECT_GT(clear_balls, 2000);
  EXPECT_LT(clear_balls, 9000);
}

}  // namespace
}  // namespace relume::test
