// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "benchmarks.h"
#include "core/reference_solver.h"
#include "frames.h"
#include "measure/converged_answer.h"
#include "measure/statistics.h"
#include "measure/test_lights.h"

namespace relume::bench {
namespace {

constexpr std::uint32_t kFrames = 240;  ///< once around
/// Systems this much dimmer than the brightest count as dark.
constexpr double kDarkSystem = 1e-3;

/// Of the way to the nearest surface, so that shadows move and near walls brighten and fade.
constexpr double kCircle = 0.8;

Light lamp_in(const LampPlace& place, std::uint32_t frame) {
  const double angle = 2.0 * kPi * frame / kFrames;
  Light lamp;
  lamp.intensity = Rgb(1000.0 * place.radius * place.radius);
  lamp.position = place.position + kCircle * place.radius * glm::dvec3(std::cos(angle), 0.0, std::sin(angle));
  return lamp;
}

/// The converged answer of a frame: bounces of the reference, from the answer of the frame before.
class Truth {
 public:
  explicit Truth(const Model& model)
      : matrices_(reference_matrices(model)),
        lighting_(stored_lighting(model)),
        radiosity_(lighting_.albedo.size(), Rgb(0.0)) {
    std::fill(lighting_.exitance.begin(), lighting_.exitance.end(), Rgb(0.0));
  }

  const Lighting& lighting() const { return lighting_; }

  /// Irradiance of gather rows, off by about 1e-6 of the largest radiosity.
  std::vector<Rgb> irradiance(std::vector<Rgb> direct) {
    lighting_.direct = std::move(direct);
    double change = 1.0, largest = 0.0;
    for (int i = 0; i < 1000 && change > 1e-7 * largest; ++i) {
      const std::vector<Rgb> next = bounce(matrices_.bounce, lighting_, radiosity_);
      change = largest = 0.0;
      for (std::size_t c = 0; c < next.size(); ++c) {
        change = std::max(change, glm::length(next[c] - radiosity_[c]));
        largest = std::max(largest, glm::length(next[c]));
      }
      radiosity_ = next;
    }
    return gather(matrices_.gather, lighting_, radiosity_);
  }

 private:
  ReferenceMatrices matrices_;
  Lighting lighting_;
  std::vector<Rgb> radiosity_;
};

/// |I - I*| / |I*| of each system that is not dark, and of those the mean.
double mean_over_systems(const Model& model, std::span<const Rgb> found, std::span<const Rgb> expected) {
  const std::vector<std::uint32_t> first = gather_offsets(model);
  std::vector<double> mean_squares;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    double sum = 0.0;
    for (std::uint32_t i = first[s]; i < first[s + 1]; ++i) sum += glm::dot(expected[i], expected[i]);
    mean_squares.push_back(sum / std::max(1u, first[s + 1] - first[s]));
  }
  const double brightest = *std::max_element(mean_squares.begin(), mean_squares.end());
  double errors = 0.0, counted = 0.0;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    if (!(mean_squares[s] > kDarkSystem * kDarkSystem * brightest)) continue;
    const std::size_t count = first[s + 1] - first[s];
    errors += relative_difference(found.subspan(first[s], count), expected.subspan(first[s], count));
    counted += 1.0;
  }
  return counted > 0.0 ? errors / counted : 0.0;
}

/// Frames of so many bounces each.
struct Runner {
  FrameSession session;
  std::uint32_t bounces;
  std::vector<double> errors{}, solve_times{}, light_times{}, host_times{};
};

Result<void> show(Runner& runner, const Light& lamp) {
  const auto shown = runner.session.frame({.lights = {&lamp, 1}, .bounces = runner.bounces});
  if (!shown) return tl::unexpected(shown.error());
  runner.solve_times.push_back(kMilli * (shown->bounces + shown->gather));
  runner.light_times.push_back(kMilli * shown->direct_light);
  runner.host_times.push_back(kMilli * shown->host);
  return {};
}

/// All of them show the lamp, and are compared with the converged answer for the direct light that they have.
Result<void> show_frame(std::vector<Runner>& runners, const Model& model, const Light& lamp, Truth& truth) {
  for (Runner& runner : runners) {
    if (auto shown = show(runner, lamp); !shown) return shown;
  }
  auto direct = runners.front().session.read_direct();
  if (!direct) return tl::unexpected(direct.error());
  const std::vector<Rgb> expected = truth.irradiance(std::move(*direct));
  for (Runner& runner : runners) {
    const auto found = runner.session.read_irradiance();
    if (!found) return tl::unexpected(found.error());
    runner.errors.push_back(mean_over_systems(model, *found, expected));
  }
  return {};
}

/// Dark but for the lamp, and converged for where it is first; the answer is right.
Result<Runner> start(StandaloneDevice& device, const Model& model, const LampPlace& place,
                     const Lighting& unlit, std::uint32_t bounces) {
  auto session = FrameSession::create(device, model, frame_options(device, model));
  if (!session) return tl::unexpected(session.error());
  const std::vector<kernels::MaterialState> dark(model.materials.size(),
                                                 replaced_material(std::nullopt, Rgb(0.0)));
  const Light lamp = lamp_in(place, 0);
  const std::vector<Rgb> no_sky(model.sky_cells.size(), Rgb(0.0));
  const auto shown =
      session->frame({.lights = {&lamp, 1}, .materials = dark, .sky = no_sky, .bounces = kBouncesToTheEnd});
  if (!shown) return tl::unexpected(shown.error());
  if (auto right = check_frame(*session, model, {&lamp, 1}, unlit); !right)
    return tl::unexpected(right.error());
  return Runner{std::move(*session), bounces};
}

std::vector<Measurement> report(const LampPlace& place, const std::vector<Runner>& runners) {
  std::vector<Measurement> out{{"radius of the circle", "m", {kCircle * place.radius}}};
  out.push_back({"entries of a bounce and a gather", "", {double(runners.front().session.entries())}});
  for (const Runner& runner : runners) {
    double sum = 0.0;
    for (const double error : runner.errors) sum += error;
    const std::string name = fmt::format("k = {}", runner.bounces);
    out.push_back({name + ", error of each frame", "", runner.errors});
    out.push_back({name + ", mean error", "", {sum / double(runner.errors.size())}});
    out.push_back({name + ", bounces and gather", "ms", runner.solve_times});
    out.push_back({name + ", direct light", "ms", runner.light_times});
    out.push_back({name + ", host clock of the frame", "ms", runner.host_times});
  }
  return out;
}

}  // namespace

Measurements tracking(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const auto place = lamp_place(*scene);
  if (!place) return tl::unexpected(place.error());
  const auto model = model_with_error(options, *scene);
  if (!model) return tl::unexpected(model.error());
  auto device = StandaloneDevice::create({});
  if (!device) return tl::unexpected(device.error());
  Truth truth(*model);
  std::vector<Runner> runners;
  for (std::uint32_t k = 1; k <= kMostBounces; ++k) {
    auto runner = start(*device, *model, *place, truth.lighting(), k);
    if (!runner) return tl::unexpected(runner.error());
    runners.push_back(std::move(*runner));
  }
  for (std::uint32_t frame = 1; frame <= kFrames; ++frame) {
    if (auto shown = show_frame(runners, *model, lamp_in(*place, frame), truth); !shown)
      return tl::unexpected(shown.error());
  }
  return report(*place, runners);
}

}  // namespace relume::bench
