// SPDX-License-Identifier: MIT
//
// Charts as pictures: what is drawn, and where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "tool/chart/label_places.h"
#include "tool/chart/picture.h"

namespace relume {
namespace {

/// The first place where `xml` is not well-formed; empty: nowhere. Knows tags, attributes and entities.
std::string first_flaw(const std::string& xml) {
  static const std::regex tag(R"(<(/?)([A-Za-z][\w-]*)((?:\s+[\w:-]+="[^"<]*")*)\s*(/?)>)");
  static const std::regex bare(R"([<>]|&(?!(amp|lt|gt|quot);))");
  std::vector<std::string> open;
  std::smatch found;
  std::string rest = xml;
  for (; std::regex_search(rest, found, tag); rest = found.suffix()) {
    const std::string before = found.prefix();
    if (std::regex_search(before, bare)) return before;
    if (std::regex_search(found[3].str(), std::regex("&(?!(amp|lt|gt|quot);)"))) return found[0];
    if (found[1].length() == 0 && found[4].length() == 0) open.push_back(found[2]);
    if (found[1].length() == 0) continue;
    if (open.empty() || open.back() != found[2]) return found[0];
    open.pop_back();
  }
  return open.empty() ? (std::regex_search(rest, bare) ? rest : "") : open.back();
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t times = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++times;
  return times;
}

/// Where the marks of points stand, in pixels.
std::vector<std::pair<double, double>> places(const std::string& svg) {
  static const std::regex mark(
      R"re(class="point"><title>[^<]*</title><path transform="translate\(([\d.]+) ([\d.]+)\))re");
  std::vector<std::pair<double, double>> found;
  for (std::sregex_iterator it(svg.begin(), svg.end(), mark), end; it != end; ++it)
    found.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  return found;
}

/// Boxes of the labels beside points.
std::vector<PixelBox> label_boxes(const std::string& svg) {
  static const std::regex label(
      R"re(<text x="([\d.]+)" y="([\d.]+)" class="label"[^>]*font-size="([\d.]+)"[^>]*>([^<]*)<)re");
  std::vector<PixelBox> boxes;
  for (std::sregex_iterator it(svg.begin(), svg.end(), label), end; it != end; ++it) {
    const double x = std::stod((*it)[1]), y = std::stod((*it)[2]), size = std::stod((*it)[3]);
    const double half = 0.5 * (text_width((*it)[4], size) - 2.0);
    boxes.push_back({x - half, y - 0.8 * size, x + half, y + 0.2 * size});
  }
  return boxes;
}

ChartPicture two_series() {
  ChartPicture chart{"name", "A <title> & \"more\"", "", {"x, ms"}, {"y, %"}, {}};
  chart.series.push_back(
      {"first & last", {{1.0, 10.0, "a<b", "one"}, {10.0, 1.0, "", "two"}, {100.0, 0.1, "", "three"}}});
  chart.series.push_back(
      {"second", {{10.0, 10.0, "", "fails", true}, {100.0, 10.0, "chosen", "", false, true}}});
  return chart;
}

TEST(ChartPicture, IsWellFormed) {
  ChartPicture chart = two_series();
  chart.front = pareto_front(chart.series);
  chart.level = ChartLevel{0.5, "level <0.5>"};
  const std::string svg = to_svg(chart);
  EXPECT_EQ(first_flaw(svg), "");
  EXPECT_THAT(svg, testing::StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(count(svg, "http"), 1u) << "it refers to something outside";
  // The check itself can fail.
  EXPECT_NE(first_flaw("<a><b></a></b>"), "");
  EXPECT_NE(first_flaw("<a>1 < 2</a>"), "");
  EXPECT_NE(first_flaw("<a>you & me</a>"), "");
}

TEST(ChartPicture, DrawsEveryPointWhereItIs) {
  const std::string svg = to_svg(two_series());
  EXPECT_EQ(count(svg, "class=\"point\""), 5u);
  const auto at = places(svg);
  ASSERT_EQ(at.size(), 5u);
  // Equal factors are equal ways on logarithmic axes; y goes up.
  EXPECT_NEAR(at[1].first - at[0].first, at[2].first - at[1].first, 0.11);
  EXPECT_NEAR(at[1].second - at[0].second, at[2].second - at[1].second, 0.11);
  EXPECT_GT(at[1].first, at[0].first + 50.0);
  EXPECT_GT(at[1].second, at[0].second + 50.0);
  EXPECT_EQ(at[3], (std::pair(at[1].first, at[0].second)));
}

TEST(ChartPicture, LeavesOutWhatAnAxisCannotShow) {
  ChartPicture chart = two_series();
  chart.series[0].points.push_back({0.0, 1.0, "", ""});
  chart.series[0].points.push_back({1.0, std::numeric_limits<double>::quiet_NaN(), "", ""});
  const std::string svg = to_svg(chart);
  EXPECT_EQ(count(svg, "class=\"point\""), 5u);
  EXPECT_EQ(count(svg, "nan"), 0u);
  chart.series.clear();
  EXPECT_EQ(first_flaw(to_svg(chart)), "");
}

TEST(ChartPicture, LabelsKeepApart) {
  ChartPicture chart{"name", "crowd", "", {"x"}, {"y"}, {{"crowd", {}}}};
  for (int i = 0; i < 60; ++i) {
    chart.series[0].points.push_back(
        {1.0 + 0.3 * std::sin(1.7 * i), 2.0 + std::cos(2.3 * i), "label " + std::to_string(i), ""});
  }
  const std::vector<PixelBox> boxes = label_boxes(to_svg(chart));
  EXPECT_GT(boxes.size(), 15u);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_TRUE(boxes[i].inside({76.0, 52.0, 716.0, 536.0}));
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(boxes[i].overlaps(boxes[j])) << i << " and " << j;
  }
}

TEST(ParetoFront, KeepsWhatNothingBeats) {
  const std::vector<ChartSeries> series{{"a", {{3.0, 1.0}, {1.0, 5.0}, {2.0, 6.0}, {2.0, 4.0}}},
                                        {"b", {{2.5, 4.0}, {0.5, 0.5, "", "", true}, {4.0, 1.0}}}};
  const std::vector<std::pair<double, double>> expected{{1.0, 5.0}, {2.0, 4.0}, {3.0, 1.0}};
  EXPECT_EQ(pareto_front(series), expected);
}

}  // namespace
}  // namespace relume
