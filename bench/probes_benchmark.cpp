// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "benchmarks.h"
#include "core/probe_coefficients.h"
#include "core/reference_solver.h"
#include "measure/converged_answer.h"
#include "measure/test_lights.h"
#include "precompute/probe_lattice.h"
#include "precompute/ray_caster.h"

namespace relume::bench {
namespace {

constexpr std::size_t kPoints = 1000;
constexpr double kClusters = 4000.0;
/// Points keep off surfaces by so much of the scene's shortest edge.
constexpr double kClearance = 0.01;
/// Where there is less light than this share of the root mean square, errors count relative to that.
constexpr double kDark = 0.1;
/// Grids grow by so much in number of probes, from fewer than were placed to so many times as many.
constexpr double kGrowth = 1.5, kMostOfPlaced = 8.0, kFewestOfPlaced = 0.3;

const std::array<glm::dvec3, 6> kNormals{glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0},
                                         {0, -1, 0},          {0, 0, 1},  {0, 0, -1}};

using Irradiance = std::array<Rgb, kNormals.size()>;

/// Per light, per point.
using PointValues = std::vector<std::vector<Irradiance>>;

Result<std::vector<glm::dvec3>> free_points(const Scene& scene) {
  const Geometry geometry = make_geometry(scene);
  const auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  const glm::vec3 size = geometry.upper - geometry.lower;
  const auto clearance = float(kClearance) * std::min({size.x, size.y, size.z});
  std::mt19937_64 engine(7);
  const auto unit = [&] { return float(double(engine() >> 11) * 0x1p-53); };
  std::vector<glm::dvec3> points;
  for (std::size_t tries = 0; points.size() < kPoints && tries < 100 * kPoints; ++tries) {
    const float x = unit(), y = unit(), z = unit();
    const glm::vec3 point = geometry.lower + size * glm::vec3(x, y, z);
    if (in_free_space(geometry, *caster, point, clearance))
      points.push_back(geometry.origin + glm::dvec3(point));
  }
  if (points.empty()) return fail(ErrorCode::check_failed, scene.file_name + ": found no free space");
  return points;
}

/// What is known of probes under all lights of the test scene.
struct Probes {
  Model model;
  std::vector<std::vector<ProbeCoefficients>> coefficients;  ///< per light
};

constexpr const char* kOwn = "own light";

/// Those of the test, and if the scene shines, its own light.
std::vector<std::string> light_names(const TestScene& test) {
  std::vector<std::string> names;
  for (const TestLight& light : test.lights) names.push_back(light.name);
  // The last material is that of the test lamp.
  const auto& materials = test.scene.materials;
  const bool emits = std::any_of(materials.begin(), materials.end() - 1,
                                 [](const SceneMaterial& m) { return m.emission != Rgb(0.0); });
  if (emits || !test.scene.lights.empty()) names.emplace_back(kOwn);
  return names;
}

Result<Lighting> lighting_by_name(const TestScene& test, const Model& model, const std::string& name) {
  for (const TestLight& light : test.lights) {
    if (light.name == name) return test_lighting(model, light);
  }
  // As if the test lamp were unlit: what it emits is taken from the stored lighting.
  const auto lamp = test_lighting(model, {"", {}, 0.0, true, false});
  auto own = test_lighting(model, {"", test.scene.lights, 0.0, false, false});
  if (!lamp || !own) return own;
  const Lighting stored = stored_lighting(model);
  for (std::size_t c = 0; c < own->exitance.size(); ++c)
    own->exitance[c] = stored.exitance[c] - lamp->exitance[c];
  return own;
}

Result<Probes> solve_probes(const TestScene& test, const PrecomputeOptions& options) {
  PrecomputeReport report;
  auto model = precompute(test.scene, options, report);
  if (!model) return tl::unexpected(model.error());
  Probes probes{std::move(*model), {}};
  const ReferenceMatrices matrices = reference_matrices(probes.model);
  for (const std::string& name : light_names(test)) {
    const auto lighting = lighting_by_name(test, probes.model, name);
    if (!lighting) return tl::unexpected(lighting.error());
    const auto solution = solve_reference(matrices.bounce, *lighting, {200, 1e-4});
    if (!solution) return tl::unexpected(solution.error());
    probes.coefficients.push_back(probe_coefficients(probes.model, *lighting, solution->radiosity));
  }
  return probes;
}

Irradiance irradiance_of(const std::vector<ProbeCoefficients>& coefficients, const WeightedProbes& at) {
  Irradiance values;
  for (std::size_t n = 0; n < kNormals.size(); ++n)
    values[n] = probe_irradiance(coefficients, at, kNormals[n]);
  return values;
}

/// Whether any surface does.
Result<bool> sees_sky(const Scene& scene, const PrecomputeOptions& options) {
  PrecomputeReport report;
  const auto model = precompute(scene, options, report);
  if (!model) return tl::unexpected(model.error());
  return !model->sky_cells.empty();
}

/// The probes of a model again, with all that each sees instead of a cut of it: that is another error.
Result<void> make_full(const TestScene& test, PrecomputeOptions options, Probes& probes) {
  options.auto_probes = false;
  options.probes.resize(probes.model.probe_names.size());
  for (const System& system : probes.model.systems) {
    for (const Probe& probe : system.probes) options.probes[probe.name] = {"", probe.position};
  }
  auto full = solve_probes(test, options);
  if (!full) return tl::unexpected(full.error());
  probes.coefficients = std::move(full->coefficients);
  return {};
}

/// A probe at each of the points.
Result<PointValues> exact_values(const TestScene& test, PrecomputeOptions options,
                                 const std::vector<glm::dvec3>& points) {
  for (const glm::dvec3& point : points) options.probes.push_back({"", point});
  const auto probes = solve_probes(test, options);
  if (!probes) return tl::unexpected(probes.error());
  PointValues values;
  for (const auto& coefficients : probes->coefficients) {
    values.emplace_back();
    WeightedProbes one;
    one.probes.fill(kNoProbe);
    one.weights[0] = 1.0f;
    for (one.probes[0] = 0; one.probes[0] < points.size(); ++one.probes[0])
      values.back().push_back(irradiance_of(coefficients, one));
  }
  return values;
}

struct Score {
  std::size_t probes = 0;
  double missed = 0.0;           ///< share of the points that no probe speaks for
  std::vector<double> of_light;  ///< root mean square over points
  double error = 0.0;            ///< and over lights
  double of_all = 0.0;           ///< the same, relative to the root mean square over the points
};

double square(const Irradiance& values) {
  double sum = 0.0;
  for (const Rgb& value : values) sum += glm::dot(value, value);
  return sum;
}

struct InterpolationError {
  double local = 0.0;   ///< relative to what there is at each point, root mean square over points
  double of_all = 0.0;  ///< root mean square, relative to that of all points
};

InterpolationError interpolation_error(const std::vector<Irradiance>& found,
                                       const std::vector<Irradiance>& exact) {
  double mean = 0.0;
  for (const Irradiance& values : exact) mean += square(values) / double(exact.size());
  double local = 0.0, all = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    Irradiance off;
    for (std::size_t n = 0; n < kNormals.size(); ++n) off[n] = found[i][n] - exact[i][n];
    const double whole = square(exact[i]) + kDark * kDark * mean;
    if (whole > 0.0) local += square(off) / whole / double(exact.size());
    if (mean > 0.0) all += square(off) / mean / double(exact.size());
  }
  return {std::sqrt(local), std::sqrt(all)};
}

Result<Score> score(const TestScene& test, const PrecomputeOptions& options,
                    const std::vector<glm::dvec3>& points, const PointValues& exact) {
  auto probes = solve_probes(test, options);
  if (!probes) return tl::unexpected(probes.error());
  if (options.auto_probes) {
    if (auto full = make_full(test, options, *probes); !full) return tl::unexpected(full.error());
  }
  const Model& model = probes->model;
  Score result;
  result.probes = model.probe_names.size();
  std::vector<WeightedProbes> at;
  for (const glm::dvec3& point : points) {
    at.push_back(probes_at(model.probe_volume, glm::vec3(point - model.origin)));
    const bool seen = std::any_of(at.back().weights.begin(), at.back().weights.end(),
                                  [](float weight) { return weight > 0.0f; });
    if (!seen) result.missed += 1.0 / double(points.size());
  }
  for (std::size_t l = 0; l < exact.size(); ++l) {
    std::vector<Irradiance> found;
    for (const WeightedProbes& where : at) found.push_back(irradiance_of(probes->coefficients[l], where));
    const InterpolationError error = interpolation_error(found, exact[l]);
    result.of_light.push_back(error.local);
    result.error += error.local * error.local / double(exact.size());
    result.of_all += error.of_all * error.of_all / double(exact.size());
  }
  result.error = std::sqrt(result.error), result.of_all = std::sqrt(result.of_all);
  return result;
}

/// How many probes a grid needs for the error under light `l`, between those that were tried; nothing if none
/// was so good. Errors of grids fall by steps, as they happen to meet lamps and walls: what counts is the
/// least of those with no more probes.
std::optional<double> probes_of_grid(std::vector<Score> grids, std::size_t l, double error) {
  std::sort(grids.begin(), grids.end(), [](const Score& a, const Score& b) { return a.probes < b.probes; });
  for (std::size_t i = 0; i < grids.size(); ++i) {
    if (grids[i].of_light[l] > error) continue;
    if (i == 0) return double(grids[0].probes);
    double before = grids[0].of_light[l];
    for (std::size_t k = 1; k < i; ++k) before = std::min(before, grids[k].of_light[l]);
    const double share = std::log(before / error) / std::log(before / grids[i].of_light[l]);
    const double first = double(grids[i - 1].probes), last = double(grids[i].probes);
    return first * std::pow(last / first, share);
  }
  return std::nullopt;
}

/// Placed probes for each of a grid that is as good, per light; where no grid was, those of the largest.
void report_shares(const std::vector<std::string>& lights, const Score& placed,
                   const std::vector<Score>& grids, std::vector<Measurement>& out) {
  const auto most = std::max_element(grids.begin(), grids.end(),
                                     [](const Score& a, const Score& b) { return a.probes < b.probes; });
  for (std::size_t l = 0; l < lights.size(); ++l) {
    if (!(placed.of_light[l] > 0.0)) continue;  // a light that nothing sees
    const auto needed = probes_of_grid(grids, l, placed.of_light[l]);
    const double share = double(placed.probes) / needed.value_or(double(most->probes));
    const std::string name =
        fmt::format("{}: share of the probes of a grid as good{}", lights[l], needed ? "" : ", at most");
    out.push_back({name, "", {share}});
    fmt::print(stderr, "{} {:.2f}\n", name, share);
  }
}

void report_score(const std::string& name, const Score& score, std::vector<Measurement>& out) {
  out.push_back({name + ": probes", "", {double(score.probes)}});
  out.push_back({name + ": error", "", {score.error}});
  out.push_back({name + ": error of each light", "", score.of_light});
  out.push_back({name + ": error, of all light", "", {score.of_all}});
  if (score.missed > 0.0) out.push_back({name + ": points without a probe", "", {score.missed}});
  fmt::print(stderr, "{}: {} probes, error {:.3f} ({:.3f}), of all light {:.3f}, {:.3f} missed\n", name,
             score.probes, score.error, fmt::join(score.of_light, " "), score.of_all, score.missed);
}

}  // namespace

Measurements probes(const BenchmarkOptions& options) {
  auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  auto test = test_scene(std::move(*scene), 0);
  if (!test) return tl::unexpected(test.error());
  const auto points = free_points(test->scene);
  if (!points) return tl::unexpected(points.error());
  PrecomputeOptions base;
  base.cluster_size = base.texel_size = std::sqrt(area_of(test->scene) / kClusters);
  base.quality = 64;
  if (auto has_sky = sees_sky(test->scene, base); !has_sky) {
    return tl::unexpected(has_sky.error());
  } else if (!*has_sky) {
    // Where all glows alike, any probe tells all.
    std::erase_if(test->lights, [](const TestLight& light) { return light.ambient; });
  }
  const auto exact = exact_values(*test, base, *points);
  if (!exact) return tl::unexpected(exact.error());

  std::vector<Measurement> out{{"free points", "", {double(points->size())}}};
  PrecomputeOptions chosen = base;
  chosen.auto_probes = true;
  const auto placed = score(*test, chosen, *points, *exact);
  if (!placed) return tl::unexpected(placed.error());
  report_score("placed", *placed, out);

  chosen.auto_probes = false;
  const Geometry geometry = make_geometry(test->scene);
  const glm::dvec3 size(geometry.upper - geometry.lower);
  double count = kFewestOfPlaced * double(placed->probes);
  std::vector<Score> grids;
  while (count < kMostOfPlaced * double(placed->probes)) {
    chosen.probe_spacing = std::cbrt(size.x * size.y * size.z / count);
    const auto grid = score(*test, chosen, *points, *exact);
    if (!grid) return tl::unexpected(grid.error());
    report_score(fmt::format("grid of {:.3g} m", chosen.probe_spacing), *grid, out);
    grids.push_back(*grid);
    count *= kGrowth;
    const auto better = [&](double of_grid, double of_placed) { return of_grid <= of_placed; };
    if (std::equal(grid->of_light.begin(), grid->of_light.end(), placed->of_light.begin(), better)) break;
  }
  report_shares(light_names(*test), *placed, grids, out);
  return out;
}

}  // namespace relume::bench
