// SPDX-License-Identifier: MIT
#include "tool/chart/study_methods.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "core/methods/room_correction.h"
#include "measure/recoded.h"
#include "measure/statistics.h"

namespace relume {
namespace {

constexpr int kTimes = 3;
constexpr std::uint32_t kMostOnCentre = 500;
/// The light of the chart of products.
constexpr std::size_t kProductsLight = 2;

/// A method on the centre, for all lights.
class MethodRun {
 public:
  MethodRun(Method method, const SensorMatrices& matrices, const std::vector<Lighting>& lightings,
            const std::vector<BounceProblem>& problems, const SceneLevels& levels)
      : method_(method), matrices_(matrices), lightings_(lightings), problems_(problems), levels_(levels) {}

  Result<SensorValues> values(std::uint32_t products) {
    std::vector<Result<Solution>> solutions(problems_.size());
    tbb::parallel_for(std::size_t{0}, problems_.size(), [&](std::size_t l) {
      solutions[l] = solve_by(method_, problems_[l], levels_, {products, 0.0});
    });
    SensorValues all;
    for (std::size_t l = 0; l < solutions.size(); ++l) {
      if (!solutions[l]) return tl::unexpected(solutions[l].error());
      if (!solutions[l]->fallback.empty()) fallback_ = solutions[l]->fallback;
      all.push_back(gather(matrices_.sensors, lightings_[l], solutions[l]->radiosity));
    }
    return all;
  }
  Result<double> seconds(std::uint32_t products) const {
    std::vector<double> times;
    Result<Solution> solution;
    for (int i = 0; i < kTimes; ++i)
      times.push_back(seconds_of([&] {
        solution = solve_by(method_, problems_[kProductsLight], levels_, {products, 0.0});
      }));
    if (!solution) return tl::unexpected(solution.error());
    return median(times);
  }
  const std::string& fallback() const { return fallback_; }

 private:
  Method method_;
  const SensorMatrices& matrices_;
  const std::vector<Lighting>& lightings_;
  const std::vector<BounceProblem>& problems_;
  const SceneLevels& levels_;
  std::string fallback_;
};

/// What all methods on the centre share.
struct CentreProblems {
  SensorMatrices matrices;
  std::vector<BounceProblem> problems;
  SceneLevels levels;
  SensorValues converged;
  double gather_seconds = 0.0;
};

SceneLevels all_levels(const Model& model, const SenderMatrix& bounce_matrix) {
  return {correction_rooms(model, bounce_matrix), near_and_far(bounce_matrix, cluster_areas(model))};
}

Result<void> fill(const ModelStudy& study, const std::vector<std::uint32_t>& rooms, CentreProblems& out) {
  out.matrices = sensor_matrices(study.centre);
  const auto relight = relight_sensors(out.matrices, study.centre_lightings, rooms);
  if (!relight) return tl::unexpected(relight.error());
  out.converged = relight->converged;
  for (const Lighting& lighting : study.centre_lightings) {
    auto problem = make_bounce_problem(out.matrices.bounce, lighting, cluster_areas(study.centre));
    if (!problem) return tl::unexpected(problem.error());
    out.problems.push_back(std::move(*problem));
  }
  out.levels = all_levels(study.centre, out.matrices.bounce);
  const ReferenceMatrices lumels = reference_matrices(without_sensors(study.centre));
  const Lighting& lighting = study.centre_lightings[kProductsLight];
  out.gather_seconds = seconds_of([&] { gather(lumels.gather, lighting, lighting.exitance); });
  return {};
}

/// Nothing, and a note, where the method does not do it by itself.
Result<std::optional<RelightPoint>> time_method(Method method, const ChartTest& test, const ModelStudy& study,
                                                const CentreProblems& centre, ChartData& data) {
  MethodRun run(method, centre.matrices, study.centre_lightings, centre.problems, centre.levels);
  RelightPoint point;
  point.axis = "method", point.value = method_names()[std::size_t(method)], point.method = method;
  const auto enough = [&](std::uint32_t products) -> Result<bool> {
    const auto values = run.values(products);
    if (!values) return tl::unexpected(values.error());
    point.error = measure_error(test.answer.rooms, *values, test.answer.values);
    return measure_error(test.answer.rooms, *values, centre.converged).worst_light <= kConverged;
  };
  Result<void> failure;
  const auto count = least_count(kMostOnCentre, enough, failure);
  if (!count) {
    data.notes.push_back(fmt::format(
        "{} on the centre: {}", point.value,
        failure ? fmt::format("not within {} products", kMostOnCentre) : failure.error().message));
    return std::nullopt;
  }
  point.products = *count;
  if (auto again = enough(*count); !again) return tl::unexpected(again.error());
  const auto seconds = run.seconds(*count);
  if (!seconds) return tl::unexpected(seconds.error());
  point.milliseconds = {1e3 * (*seconds + centre.gather_seconds)};
  point.form_factors = form_factors(without_sensors(study.centre));
  point.bytes = matrix_bytes(without_sensors(study.centre));
  return point;
}

/// The matrix of the chart of products, and a light.
struct ProductsTest {
  SenderMatrix matrix;
  Lighting lighting;
  std::vector<double> areas;
  SceneLevels levels;
};

Result<ProductsTest> make_products_test(const ChartPlan& plan, const ChartTest& test) {
  TestScene bare = test.scene;
  for (SceneNode& node : bare.scene.nodes) {
    if (!node.extras.receiver) node.extras.receiver = "clusters";
  }
  PrecomputeOptions options = plan.models.front().options;
  options.budget = 0;
  options.cluster_size = std::sqrt(area_of(bare.scene) / plan.products_clusters);
  options.texel_size = 0.5 * options.cluster_size;
  PrecomputeReport report;
  const auto model =
      precompute(bare.scene, options, report, [](std::string_view, double) { return !interrupted(); });
  if (!model) return tl::unexpected(model.error());
  auto lighting = test_lighting(*model, bare.lights[kProductsLight]);
  if (!lighting) return tl::unexpected(lighting.error());
  ProductsTest result{reference_bounce_matrix(*model), std::move(*lighting), cluster_areas(*model), {}};
  result.levels = all_levels(*model, result.matrix);
  return result;
}

/// What is reflected of light that came from other surfaces: |x - y| / |y| by area.
double reflected_difference(const BounceProblem& problem, const std::vector<Rgb>& x,
                            const std::vector<Rgb>& y) {
  double difference = 0.0, total = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Rgb off = x[i] - y[i], reflected = y[i] - problem.source[i];
    difference += problem.areas[i] * glm::dot(off, off),
        total += problem.areas[i] * glm::dot(reflected, reflected);
  }
  return total > 0.0 ? std::sqrt(difference / total) : 0.0;
}

using NamedSolve =
    std::pair<std::string, std::function<Result<Solution>(const BounceProblem&, const StopRule&)>>;

/// All methods, and conjugate gradients with their check for symmetry off.
std::vector<NamedSolve> named_solves(const SceneLevels& levels) {
  std::vector<NamedSolve> all;
  for (std::size_t m = 0; m < method_names().size(); ++m) {
    all.emplace_back(method_names()[m], [m, &levels](const BounceProblem& problem, const StopRule& rule) {
      return solve_by(Method(m), problem, levels, rule);
    });
  }
  all.emplace_back("cg unchecked", [](const BounceProblem& problem, const StopRule& rule) {
    return solve_by_conjugate_gradients(problem, rule, {}, 2.0);
  });
  return all;
}

ProductsPoint count_products(const NamedSolve& solve, const BounceProblem& problem,
                             const std::vector<Rgb>& exact, double albedo, std::uint32_t most) {
  ProductsPoint point{solve.first, albedo, most, MethodEnd::converged, {}};
  std::string fallback;
  const auto enough = [&](std::uint32_t products) -> Result<bool> {
    if (auto go_on = check_interrupted(); !go_on) return tl::unexpected(go_on.error());
    const auto solution = solve.second(problem, {products, 0.0});
    if (!solution) return tl::unexpected(solution.error());
    fallback = solution->fallback;
    return reflected_difference(problem, solution->radiosity, exact) <= kConverged;
  };
  Result<void> failure;
  const auto count = least_count(most, enough, failure);
  if (!failure) return {solve.first, albedo, 1, MethodEnd::refused, failure.error().message};
  if (!count)
    return {solve.first, albedo, most, MethodEnd::too_many, fmt::format("not within {} products", most)};
  point.products = *count;
  if (enough(*count) && !fallback.empty()) point.end = MethodEnd::gave_way, point.reason = fallback;
  return point;
}

}  // namespace

Result<std::vector<RelightPoint>> time_methods(const ChartTest& test, const ModelStudy& study,
                                               ChartData& data) {
  CentreProblems centre;
  if (auto filled = fill(study, test.answer.rooms, centre); !filled) return tl::unexpected(filled.error());
  std::vector<RelightPoint> points;
  for (std::size_t m = 0; m < method_names().size(); ++m) {
    auto point = time_method(Method(m), test, study, centre, data);
    if (!point) return tl::unexpected(point.error());
    if (*point) points.push_back(std::move(**point));
    if (auto go_on = check_interrupted(); !go_on) return tl::unexpected(go_on.error());
  }
  return points;
}

double guessed_seconds_of_products(const ChartPlan& plan) {
  return 3e-6 * double(plan.albedos.size()) * plan.most_products * plan.products_clusters;
}

Result<void> count_products(const ChartPlan& plan, const ChartTest& test, ChartProgress& progress,
                            ChartData& data) {
  auto products = make_products_test(plan, test);
  if (!products) return tl::unexpected(products.error());
  data.products_clusters = std::uint32_t(products->areas.size());
  for (const double albedo : plan.albedos) {
    products->lighting.albedo.assign(products->areas.size(), Rgb(albedo));
    const auto problem = make_bounce_problem(products->matrix, products->lighting, products->areas);
    if (!problem) return tl::unexpected(problem.error());
    const auto exact = solve_by_gmres(*problem, products->levels.near_and_far, {100000, 1e-6});
    if (!exact) return tl::unexpected(exact.error());
    const std::vector<NamedSolve> solves = named_solves(products->levels);
    std::vector<ProductsPoint> points(solves.size());
    tbb::parallel_for(std::size_t{0}, solves.size(), [&](std::size_t s) {
      points[s] = count_products(solves[s], *problem, exact->radiosity, albedo, plan.most_products);
    });
    data.products.insert(data.products.end(), points.begin(), points.end());
    const double seconds = guessed_seconds_of_products(plan) / double(plan.albedos.size());
    if (auto go_on = progress.did(seconds); !go_on) return go_on;
  }
  return {};
}

}  // namespace relume
