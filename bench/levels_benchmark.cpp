// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "benchmarks.h"
#include "compute/room_tables.h"
#include "compute/standalone/solve_on_device.h"
#include "core/methods/methods.h"
#include "core/methods/room_correction.h"

namespace relume::bench {
namespace {

constexpr double kLevelTolerance = 1e-3;
constexpr std::uint32_t kMaxProducts = 4000;

/// The stored lighting with every albedo nearer to 1, so that their mean by area is `mean` in green; lamps
/// where there are any, else direct light that changes from cluster to cluster.
Lighting raised(const Model& model, const std::vector<double>& areas, double mean) {
  Lighting lighting = stored_lighting(model);
  double absorbed = 0.0, area = 0.0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    absorbed += areas[i] * (1.0 - lighting.albedo[i].y);
    area += areas[i];
  }
  const double factor = (1.0 - mean) * area / absorbed;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      lighting.albedo[i][c] = std::clamp(1.0 - factor * (1.0 - lighting.albedo[i][c]), 0.0, 0.999);
    lighting.direct[i] = Rgb(i % 100 == 0 ? 1000.0 : 0.0);
  }
  return lighting;
}

/// The worst over rooms of |a - b| / |b|, by area; of rooms that have a hundredth of all area.
double worst_room(const Rooms& rooms, const std::vector<double>& areas, const std::vector<Rgb>& a,
                  const std::vector<Rgb>& b) {
  std::vector<double> difference(rooms.count, 0.0), size(rooms.count, 0.0), area(rooms.count, 0.0);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const std::uint32_t room = rooms.of_cluster[i];
    if (room == kNone) continue;
    difference[room] += areas[i] * glm::dot(a[i] - b[i], a[i] - b[i]);
    size[room] += areas[i] * glm::dot(b[i], b[i]);
    area[room] += areas[i];
  }
  const double least = 0.01 * std::accumulate(areas.begin(), areas.end(), 0.0);
  double worst = 0.0;
  for (std::uint32_t room = 0; room < rooms.count; ++room) {
    if (area[room] >= least && size[room] > 0.0)
      worst = std::max(worst, std::sqrt(difference[room] / size[room]));
  }
  return worst;
}

struct LevelsBench {
  StandaloneDevice device;
  Model model;
  std::vector<double> areas;
  SenderMatrix matrix;
  Rooms rooms;  ///< all
  NearAndFar levels;
  std::vector<DeviceMethod> methods;
};

/// Products until the worst room is within the tolerance of the answer; `most` where they do not do.
Result<std::uint32_t> products_to_answer(LevelsBench& bench, const DeviceMethod& method,
                                         const Lighting& lighting, const std::vector<Rgb>& answer,
                                         std::uint32_t most) {
  std::uint32_t least = 1;
  while (least < most) {
    const std::uint32_t middle = (least + most) / 2;
    DeviceSolveOptions options;
    options.choose_method = [&](double) { return method; };
    const auto found = solve_on_device(bench.device, bench.model, lighting, {middle, 0.0}, options);
    if (!found) return tl::unexpected(found.error());
    const bool enough =
        worst_room(bench.rooms, bench.areas, found->solution.radiosity, answer) <= kLevelTolerance;
    (enough ? most : least) = enough ? middle : middle + 1;
  }
  return most;
}

Result<void> measure(LevelsBench& bench, double albedo, std::vector<Measurement>& result) {
  const Lighting lighting = raised(bench.model, bench.areas, albedo);
  const auto problem = make_bounce_problem(bench.matrix, lighting, bench.areas);
  if (!problem) return tl::unexpected(problem.error());
  const auto answer = solve_by_gmres(*problem, bench.levels, {2000, 1e-8});
  if (!answer) return tl::unexpected(answer.error());
  for (const DeviceMethod& method : bench.methods) {
    DeviceSolveOptions options;
    options.choose_method = [&](double) { return method; };
    const auto found =
        solve_on_device(bench.device, bench.model, lighting, {kMaxProducts, kLevelTolerance}, options);
    if (!found) return tl::unexpected(found.error());
    const std::string name = fmt::format("albedo {}, {}", albedo, method_names()[std::size_t(method.method)]);
    const double error = worst_room(bench.rooms, bench.areas, found->solution.radiosity, answer->radiosity);
    result.push_back({name, "products", {double(found->solution.bounces)}});
    result.push_back({name + ", host clock", "ms", {1e3 * found->seconds.bounces}});
    result.push_back({name + ", worst room", "", {error}});
    const auto few = products_to_answer(bench, method, lighting, answer->radiosity, found->solution.bounces);
    if (!few) return tl::unexpected(few.error());
    result.push_back({name + ", to 0.1 % of each room", "products", {double(*few)}});
    if (!found->solution.fallback.empty()) result.push_back({name + " gave up", "", {1.0}});
  }
  return {};
}

}  // namespace

Measurements levels(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  auto model = model_with_error(options, *scene);
  if (!model) return tl::unexpected(model.error());
  auto device = StandaloneDevice::create({});
  if (!device) return tl::unexpected(device.error());
  SenderMatrix matrix = reference_bounce_matrix(*model);
  const std::vector<double> areas = cluster_areas(*model);
  const Rooms rooms = correction_rooms(*model, matrix);
  const NearAndFar levels = near_and_far(matrix, areas);
  const std::vector<DeviceMethod> methods{
      {},
      {Method::two_level, room_weights(matrix, areas, largest_rooms(rooms, areas, kMaxDeviceRooms))},
      {Method::bicgstab},
      {Method::two_level_gmres, {}, levels}};
  LevelsBench bench{std::move(*device), std::move(*model), areas, std::move(matrix), rooms, levels, methods};
  std::vector<Measurement> result{{"rooms", "", {double(rooms.count)}}};
  for (const double albedo : {0.5, 0.8, 0.95, 0.99}) {
    if (auto measured = measure(bench, albedo, result); !measured) return tl::unexpected(measured.error());
  }
  return result;
}

}  // namespace relume::bench
