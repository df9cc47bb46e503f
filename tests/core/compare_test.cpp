// SPDX-License-Identifier: MIT
#include "core/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace relume {
namespace {

TEST(Compare, FindsTheWorstEntry) {
  const std::vector<Rgb> reference{Rgb(100, 10, 1), Rgb(50, 0, 2)};
  const std::vector<Rgb> values{Rgb(100, 10.5, 1), Rgb(50, 0.0002, 2.2)};
  const Comparison result = compare("clusters", values, reference);
  EXPECT_EQ(result.name, "clusters");
  EXPECT_EQ(result.count, 2u);
  // Errors: 0, 0.05, 0 and 0, 0.0002 / (1e-4 * 100) = 0.02, 0.1.
  EXPECT_NEAR(result.max_relative_error, 0.1, 1e-12);
  EXPECT_NEAR(result.max_absolute_error, 0.5, 1e-12);
  EXPECT_EQ(result.worst_index, 1u);
  EXPECT_EQ(result.worst_channel, 2);
  EXPECT_EQ(result.worst_value, 2.2);
  EXPECT_EQ(result.worst_reference, 2.0);
  EXPECT_NEAR(result.rms_relative_error, std::sqrt((0.05 * 0.05 + 0.02 * 0.02 + 0.1 * 0.1) / 6.0), 1e-12);
}

TEST(Compare, TakesErrorsRelativeToMagnitudesThatAreGiven) {
  const std::vector<Rgb> reference{Rgb(0.0, -1.0, 2.0)}, values{Rgb(0.1, -1.2, 2.0)};
  const Comparison result = compare("sums", values, reference, std::vector<Rgb>{Rgb(10.0, 4.0, 1.0)});
  // Errors: 0.1 / 10, 0.2 / 4, 0.
  EXPECT_NEAR(result.max_relative_error, 0.05, 1e-12);
  EXPECT_EQ(result.worst_channel, 1);
}

TEST(Compare, HistogramHasADecadePerBin) {
  const std::vector<Rgb> reference(3, Rgb(1.0));
  const std::vector<Rgb> values{Rgb(3.0, 1.5, 1.05), Rgb(1.0 + 5e-4, 1.0 + 5e-11, 1.0 + 5e-13), Rgb(1.0)};
  const Comparison result = compare("x", values, reference);
  // 2 and 0.5; 0.05; 5e-4; 5e-11; 5e-13 and three zeros.
  const std::array<std::size_t, 12> expected{2, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 4};
  EXPECT_EQ(result.histogram, expected);
}

TEST(Compare, WhatIsNotFiniteIsInfinitelyWrong) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), infinity, -infinity}) {
    const Comparison result = compare("x", std::vector<Rgb>{Rgb(1, bad, 1)}, std::vector<Rgb>{Rgb(1)});
    EXPECT_EQ(result.max_relative_error, infinity);
    EXPECT_EQ(result.rms_relative_error, infinity);
    EXPECT_EQ(result.worst_channel, 1);
    EXPECT_EQ(result.histogram[0], 1u);
  }
}

TEST(Compare, DarknessEqualsDarkness) {
  const std::vector<Rgb> dark(4, Rgb(0.0));
  EXPECT_EQ(compare("x", dark, dark).max_relative_error, 0.0);
  EXPECT_EQ(compare("x", std::vector<Rgb>(4, Rgb(1e-9)), dark).max_relative_error,
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(compare("x", {}, {}).rms_relative_error, 0.0);
}

}  // namespace
}  // namespace relume
