// SPDX-License-Identifier: MIT
#include "tool/chart/study_tracking.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "precompute/direct_irradiance.h"

namespace relume {
namespace {

/// Enough to follow the own solution from frame to frame far better than any point does.
constexpr std::uint32_t kExactProducts = 40;

/// The frames of one pace.
struct Ride {
  std::vector<Lighting> lightings;
  std::vector<std::vector<Rgb>> exact;  ///< radiosity of the frame's own solution
};

Light placed(const TestLight& test, double turn) {
  Light light = test.lights.front();
  const double radius = 0.5 * test.clearance, angle = 2.0 * std::numbers::pi * turn;
  light.position += radius * glm::dvec3(std::cos(angle), 0.0, std::sin(angle));
  return light;
}

std::vector<Rgb> bounced(const SenderMatrix& matrix, const Lighting& lighting, std::vector<Rgb> radiosity,
                         std::uint32_t times) {
  for (std::uint32_t k = 0; k < times; ++k) radiosity = bounce(matrix, lighting, radiosity);
  return radiosity;
}

Result<Ride> make_ride(const Model& model, const Lighting& base, const TestLight& light,
                       const SensorMatrices& matrices, std::uint32_t frames, std::uint32_t frames_per_turn) {
  Ride ride;
  for (std::uint32_t f = 0; f < frames; ++f) {
    if (auto go_on = check_interrupted(); !go_on) return tl::unexpected(go_on.error());
    const Light moved = placed(light, double(f) / frames_per_turn);
    auto direct = direct_irradiance(model, {&moved, 1});
    if (!direct) return tl::unexpected(direct.error());
    Lighting lighting = base;
    lighting.direct = std::move(direct->clusters);
    const std::vector<Rgb> black(lighting.albedo.size(), Rgb(0.0));
    const std::vector<Rgb>& before = f == 0 ? black : ride.exact.back();
    ride.exact.push_back(bounced(matrices.bounce, lighting, before, (f == 0 ? 4 : 1) * kExactProducts));
    ride.lightings.push_back(std::move(lighting));
  }
  return ride;
}

/// Mean over the frames after the first, which is converged; `anew`: every frame starts from B = 0.
double tracking_error(const Ride& ride, const SensorMatrices& matrices,
                      const std::vector<std::uint32_t>& rooms, std::uint32_t products, bool anew) {
  double sum = 0.0;
  std::vector<Rgb> radiosity = ride.exact.front();
  for (std::size_t f = 1; f < ride.exact.size(); ++f) {
    const Lighting& lighting = ride.lightings[f];
    if (anew) radiosity.assign(radiosity.size(), Rgb(0.0));
    radiosity = bounced(matrices.bounce, lighting, std::move(radiosity), products);
    sum += sensor_error(rooms, gather(matrices.sensors, lighting, radiosity),
                        gather(matrices.sensors, lighting, ride.exact[f]));
  }
  return sum / double(ride.exact.size() - 1);
}

/// What moves and how fast makes no difference to a frame's time: one list of times per count of products.
Result<void> time_frames(std::uint32_t repetitions, SolverSession& session,
                         std::vector<TrackingPoint>& points) {
  std::map<std::uint32_t, std::vector<double>> milliseconds;
  for (const TrackingPoint& point : points) milliseconds[point.products].clear();
  for (std::uint32_t r = 0; r < repetitions; ++r) {
    for (auto& [products, list] : milliseconds) {
      const auto times = session.run({.bounces = products, .gather = true});
      if (!times) return tl::unexpected(times.error());
      list.push_back(1e3 * (times->gpu_seconds > 0.0 ? times->gpu_seconds : times->seconds));
    }
  }
  for (TrackingPoint& point : points) point.milliseconds = milliseconds[point.products];
  return {};
}

}  // namespace

Result<std::vector<TrackingPoint>> track_light(const ChartPlan& plan, const ChartTest& test,
                                               ModelStudy& study) {
  const auto light = std::find_if(test.scene.lights.begin(), test.scene.lights.end(),
                                  [](const TestLight& one) { return !one.lights.empty(); });
  const auto centre = std::find_if(study.candidates.begin(), study.candidates.end(),
                                   [](const Candidate& one) { return one.point.role == PointRole::centre; });
  const Lighting& base = study.centre_lightings[std::size_t(light - test.scene.lights.begin())];
  const SensorMatrices matrices = sensor_matrices(study.centre);
  std::vector<TrackingPoint> points;
  for (const std::uint32_t pace : plan.paces) {
    const auto ride = make_ride(study.centre, base, *light, matrices, plan.frames, pace);
    if (!ride) return tl::unexpected(ride.error());
    std::vector<TrackingPoint> made;
    for (const std::uint32_t products : plan.products_per_frame) made.push_back({pace, products, 0.0, {}});
    if (pace == plan.paces.back()) {
      for (const std::uint32_t products : plan.products_per_frame) made.push_back({0, products, 0.0, {}});
    }
    tbb::parallel_for(std::size_t{0}, made.size(), [&](std::size_t i) {
      TrackingPoint& point = made[i];
      point.error =
          tracking_error(*ride, matrices, test.answer.rooms, point.products, point.frames_per_turn == 0);
    });
    points.insert(points.end(), made.begin(), made.end());
  }
  if (auto timed = time_frames(plan.relight_repetitions, *centre->session, points); !timed)
    return tl::unexpected(timed.error());
  return points;
}

}  // namespace relume
