// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bare_embree.h"
#include "benchmarks.h"
#include "ray_list.h"

namespace relume::bench {
namespace {

/// A way to trace the same rays with Embree alone.
struct BareWay {
  RayOrder order;
  int width;
};
/// Those in the order of the sequence come first: they are the bar.
constexpr std::array<BareWay, 5> kWays{{{RayOrder::sequence, 1},
                                        {RayOrder::sequence, 8},
                                        {RayOrder::sequence, 16},
                                        {RayOrder::grouped, 8},
                                        {RayOrder::grouped, 16}}};
constexpr std::size_t kSequenceWays = 3;

/// So many rays are in memory at a time.
constexpr std::size_t kSliceRays = std::size_t{1} << 24;

struct Contenders {
  const Scene& scene;
  PrecomputeOptions options;
  const RaysOfPrecompute& rays;
  const BareEmbree& embree;
};

/// What bare Embree met, and how long it took.
struct BareRun {
  std::uint64_t rays = 0;
  std::array<std::uint64_t, kWays.size()> hits{};
  std::array<double, kWays.size()> seconds{};
};

/// All rays in all ways, by turns. Making them does not count.
BareRun run_bare(const Contenders& contenders) {
  BareRun run;
  const RaysOfPrecompute& rays = contenders.rays;
  std::vector<RayList> lists(std::max<std::size_t>(1, kSliceRays / rays.quality()));
  for (std::size_t first = 0; first < rays.receivers(); first += lists.size()) {
    lists.resize(std::min(lists.size(), rays.receivers() - first));
    for (const RayOrder order : {RayOrder::sequence, RayOrder::grouped}) {
      rays.list(first, order, lists);
      for (std::size_t w = 0; w < kWays.size(); ++w) {
        if (kWays[w].order != order) continue;
        run.seconds[w] += seconds_of([&] {
          run.hits[w] += contenders.embree.trace(lists, kWays[w].width, order == RayOrder::grouped).hits;
        });
      }
    }
    for (const RayList& list : lists) run.rays += list.size();
  }
  return run;
}

constexpr double kMissedThroughEdges = 1e-6;

/// The precompute traced as many rays as bare Embree, or more where it looked around with few first, and all
/// ways met equally many surfaces; but for rays through edges, of which each width may miss a few.
Result<void> check_answers(const BareRun& bare, const PrecomputeReport& report, const Model& model,
                           bool surveyed) {
  if (surveyed ? report.rays <= bare.rays : report.rays != bare.rays) {
    return fail(ErrorCode::check_failed,
                fmt::format("the precompute traced {} rays, bare Embree {}", report.rays, bare.rays));
  }
  for (std::size_t w = 0; w < kWays.size(); ++w) {
    const double missed = std::abs(double(bare.hits[w]) - double(bare.hits[0]));
    if (bare.hits[w] > 0 && missed <= kMissedThroughEdges * double(bare.hits[0])) continue;
    return fail(ErrorCode::check_failed, fmt::format("{} rays met something one by one, {} in packets of {}",
                                                     bare.hits[0], bare.hits[w], kWays[w].width));
  }
  std::size_t lumels = 0;
  for (const System& system : model.systems) lumels += system.lumels.size();
  if (lumels >= 10000) return {};
  return fail(ErrorCode::check_failed, fmt::format("expected 10000 lumels or more, found {}", lumels));
}

struct Times {
  std::vector<double> precompute, surfaces, rows, matrices;
  std::array<std::vector<double>, kWays.size()> embree;
  std::uint64_t rays = 0, survey_rays = 0, occlusion_rays = 0;
};

/// Turn about, so that whatever else the machine does meets all of them alike.
Result<Times> take_turns(const Contenders& contenders, std::uint32_t repetitions) {
  Times times;
  for (std::uint32_t r = 0; r < repetitions; ++r) {
    PrecomputeReport report;
    Result<Model> model = Model{};
    times.precompute.push_back(
        seconds_of([&] { model = precompute(contenders.scene, contenders.options, report); }));
    if (!model) return tl::unexpected(model.error());
    times.surfaces.push_back(report.seconds_surfaces);
    times.rows.push_back(report.seconds_rays);
    times.matrices.push_back(report.seconds_rows);
    const BareRun bare = run_bare(contenders);
    for (std::size_t w = 0; w < kWays.size(); ++w) times.embree[w].push_back(bare.seconds[w]);
    times.rays = bare.rays, times.survey_rays = report.rays - bare.rays;
    times.occlusion_rays = report.occlusion_rays;
    if (auto right = check_answers(bare, report, *model, contenders.options.budget > 0); !right)
      return tl::unexpected(right.error());
  }
  return times;
}

std::vector<double> divided(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result;
  for (std::size_t i = 0; i < a.size(); ++i) result.push_back(a[i] / b[i]);
  return result;
}

using Samples = std::vector<double>;

const Samples& quickest(std::span<const Samples> times) {
  return *std::min_element(times.begin(), times.end(),
                           [](const Samples& a, const Samples& b) { return median(a) < median(b); });
}

std::vector<Measurement> report_times(const Scene& scene, const Times& times) {
  const Samples& best = quickest(std::span(times.embree).first(kSequenceWays));
  const Samples& grouped = quickest(std::span(times.embree).subspan(kSequenceWays));
  std::vector<Measurement> result;
  const auto add = [&](const std::string& name, const std::string& unit, std::vector<double> values) {
    result.push_back({name, unit, std::move(values)});
  };
  add("triangles", "", {double(scene.triangles.size())});
  add("closest-hit rays", "", {double(times.rays)});
  add("survey rays of the precompute alone", "", {double(times.survey_rays)});
  add("occlusion rays of the precompute alone", "", {double(times.occlusion_rays)});
  for (std::size_t w = 0; w < kWays.size(); ++w) {
    add(fmt::format("bare Embree, {} wide{}", kWays[w].width, w < kSequenceWays ? "" : ", grouped"), "s",
        times.embree[w]);
  }
  add("precompute", "s", times.precompute);
  add("  of it charts, lumels, clusters, survey", "s", times.surfaces);
  add("  of it rays and rows, cut", "s", times.rows);
  add("  of it matrices", "s", times.matrices);
  add("bare Embree, best width", "rays/s", divided(Samples(best.size(), double(times.rays)), best));
  add("precompute / best bare Embree", "", divided(times.precompute, best));
  add("precompute / best bare Embree, grouped", "", divided(times.precompute, grouped));
  return result;
}

}  // namespace

Measurements precompute_vs_embree(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const Geometry geometry = make_geometry(*scene);
  PrecomputeOptions chosen = precompute_options(options, *scene);
  chosen.budget = options.budget;
  const auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  const auto rays = RaysOfPrecompute::create(*scene, geometry, *caster, chosen);
  if (!rays) return tl::unexpected(rays.error());
  const auto embree = BareEmbree::create(geometry.positions, geometry.triangles, "");
  if (!embree) return tl::unexpected(embree.error());
  const auto times = take_turns({*scene, chosen, *rays, *embree}, options.repetitions);
  if (!times) return tl::unexpected(times.error());
  return report_times(*scene, *times);
}

}  // namespace relume::bench
