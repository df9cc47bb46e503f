// SPDX-License-Identifier: MIT
//
// What is measured for the charts, on a scene and a plan that take a second or two.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scene/load_scene.h"
#include "tool/chart/charts.h"
#include "tool/chart/measure_charts.h"
#include "tool/program.h"

namespace relume {
namespace {

/// The centre, one other budget, other rays, and two albedos.
ChartPlan tiny_plan(double area) {
  ChartPlan plan = make_chart_plan({.quick = true, .texel_size = 0.25, .cluster_size = 0.5}, area);
  std::erase_if(plan.models,
                [](const ModelPlan& model) { return model.role == PointRole::other && model.value != "64"; });
  std::erase_if(plan.models.front().variants, [](const VariantPlan& variant) { return variant.own_kernel; });
  plan.answer = {1000.0, 256, 1u << 13};
  plan.sensors = 150;
  plan.relight_repetitions = 3;
  plan.albedos = {0.5, 0.95};
  plan.most_products = 200, plan.products_clusters = 100.0;
  plan.paces = {60}, plan.products_per_frame = {1, 3}, plan.frames = 4;
  return plan;
}

const RelightPoint& find_relight(const ChartData& data, const std::string& axis, const std::string& value) {
  const auto found = std::find_if(data.relights.begin(), data.relights.end(), [&](const RelightPoint& point) {
    return point.axis == axis && point.value == value;
  });
  EXPECT_NE(found, data.relights.end()) << axis << " " << value;
  return *found;
}

std::uint32_t products(const ChartData& data, const std::string& method, double albedo) {
  for (const ProductsPoint& point : data.products) {
    if (point.method == method && point.albedo == albedo) return point.products;
  }
  ADD_FAILURE() << method;
  return 0;
}

TEST(ChartPicture, MeasuresATinyScene) {
  const auto scene = load_scene(test::make_scene("two_rooms", test::fresh_folder()));
  ASSERT_TRUE(scene.has_value());
  double last = 0.0;
  const auto data = measure_charts(*scene, tiny_plan(area_of(*scene)), "", [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  ASSERT_TRUE(data.has_value()) << data.error().message;
  EXPECT_NEAR(last, 1.0, 1e-6);

  const RelightPoint& centre = find_relight(*data, "centre", "centre");
  EXPECT_GT(find_relight(*data, "rays", "64").error.all_lights, centre.error.all_lights);
  EXPECT_LT(centre.error.all_lights, 0.3);
  EXPECT_EQ(centre.milliseconds.size(), 3u);
  EXPECT_GT(find_relight(*data, "value format", "f32").bytes, centre.bytes);
  EXPECT_LT(find_relight(*data, "budget", "64").form_factors, centre.form_factors);
  // Precision moves the answer less than its step; its cause is measured along the front.
  EXPECT_TRUE(std::any_of(data->relights.begin(), data->relights.end(), [](const RelightPoint& point) {
    return point.causes && point.causes->precision < 1e-3 && point.causes->bounces <= kConverged;
  }));

  // ln(1e-3) / ln(0.95) bounces for all of the light that a closed scene keeps, fewer for what it loses.
  EXPECT_GT(products(*data, "bounces", 0.95), products(*data, "bounces", 0.5));
  EXPECT_LE(products(*data, "bounces", 0.95), 140u);
  EXPECT_LT(products(*data, "two-level-gmres", 0.95), products(*data, "bounces", 0.95));

  ASSERT_GE(data->tracking.size(), 2u);
  EXPECT_GT(data->tracking[0].error, data->tracking[1].error) << "more products a frame did not help";
  for (const ChartAndTable& one : make_charts(*data)) {
    EXPECT_THAT(to_svg(one.chart), testing::EndsWith("</svg>\n")) << one.chart.name;
    EXPECT_GT(std::count(one.csv.begin(), one.csv.end(), '\n'), 1) << one.chart.name;
  }
}

}  // namespace
}  // namespace relume
