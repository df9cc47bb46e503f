// SPDX-License-Identifier: MIT
#include "precompute/row_plan.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

constexpr std::uint32_t kQuality = 512;
constexpr std::uint32_t kMostRays = 1u << 12, kLeastRays = 64;
constexpr std::uint32_t kMostSensorRays = 1u << 16, kLeastSensorRays = 1024, kMinSensorQuality = 4096;
constexpr std::uint32_t kSensorQualities = 16;
/// What clusters begin with at a target of 100 %; errors are about of second order in the size.
constexpr double kClearanceShare = 1.15;
/// 8 bits with square-root coding cost less than a percent.
constexpr double kCoarseCodesFrom = 0.02;

RayLimits fixed(std::uint32_t rays) {
  return {rays, rays, 0.0, 0.0, nullptr};
}

}  // namespace

RowPlan plan_rows(const PrecomputeOptions& options, const Scene& scene) {
  RowPlan plan;
  const bool target = options.error > 0.0;
  plan.cut = target || options.budget > 0;
  plan.reciprocal = options.reciprocal;
  plan.bounds = options.bounds;
  if (target && options.cluster_size <= 0.0)
    plan.clearance_share = kClearanceShare * std::sqrt(options.error);
  plan.adaptive = target && options.quality == 0;
  const std::uint32_t quality = options.quality > 0 ? options.quality : kQuality;
  plan.lumels = plan.adaptive ? RayLimits{kMostRays, kLeastRays, 0.0, 0.0, nullptr} : fixed(quality);
  if (options.sensor_quality > 0) {
    plan.sensors = fixed(options.sensor_quality);
  } else if (plan.adaptive) {
    plan.sensors = {kMostSensorRays, kLeastSensorRays, 0.0, 0.0, nullptr};
  } else {
    plan.sensors = fixed(std::min(kMaxQuality, std::max(kMinSensorQuality, kSensorQualities * quality)));
  }
  plan.probe_rays = std::min(kMaxQuality, std::max(kMinSensorQuality, kSensorQualities * quality));
  plan.sensor_cut = {options.budget, 0.0};
  for (const SceneNode& node : scene.nodes) {
    plan.node_quality.push_back(node.extras.quality.value_or(0));
    plan.node_cuts.push_back({node.extras.budget.value_or(options.budget), 0.0});
    plan.cut = plan.cut || node.extras.budget.value_or(0) > 0;
  }
  if (target) plan.codec = options.error >= kCoarseCodesFrom ? ValueCodec::sqrt8 : ValueCodec::unorm16;
  if (options.codec) plan.codec = *options.codec;
  return plan;
}

}  // namespace relume
