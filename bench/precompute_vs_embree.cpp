// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bare_embree.h"
#include "benchmarks.h"
#include "ray_list.h"

namespace relume::bench {
namespace {

constexpr const char* kName = "precompute_vs_embree";

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

struct Contenders {
  const Scene& scene;
  PrecomputeOptions options;
  RayList sequence, grouped;
  BareEmbree embree;

  HitCount trace(const BareWay& way) const {
    const bool alike = way.order == RayOrder::grouped;
    return embree.trace(alike ? grouped : sequence, way.width, alike);
  }
};

/// The precompute traces as many rays as are in the list, and all ways meet equally many surfaces.
Result<PrecomputeReport> check_answers(const Contenders& contenders) {
  PrecomputeReport report;
  const auto model = precompute(contenders.scene, contenders.options, report);
  if (!model) return tl::unexpected(model.error());
  if (report.rays != contenders.sequence.size()) {
    return fail(ErrorCode::check_failed, fmt::format("{}: the precompute traced {} rays, the list has {}",
                                                     kName, report.rays, contenders.sequence.size()));
  }
  const std::uint64_t hits = contenders.trace(kWays[0]).hits;
  for (const BareWay& way : kWays) {
    const std::uint64_t found = contenders.trace(way).hits;
    if (found == hits) continue;
    return fail(ErrorCode::check_failed,
                fmt::format("{}: {} rays met something one by one, {} in packets of {}", kName, hits, found,
                            way.width));
  }
  std::size_t lumels = 0;
  for (const System& system : model->systems) lumels += system.lumels.size();
  if (lumels < 10000) {
    return fail(ErrorCode::check_failed,
                fmt::format("{}: expected 10000 lumels or more, found {}", kName, lumels));
  }
  return report;
}

struct Times {
  std::vector<double> precompute, surfaces, rows;
  std::array<std::vector<double>, kWays.size()> embree;
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
    for (std::size_t w = 0; w < kWays.size(); ++w) {
      HitCount count;
      times.embree[w].push_back(seconds_of([&] { count = contenders.trace(kWays[w]); }));
      if (count.hits == 0)
        return fail(ErrorCode::check_failed, fmt::format("{}: no ray met anything", kName));
    }
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

std::vector<Measurement> report_times(const Contenders& contenders, const PrecomputeReport& first,
                                      const Times& times) {
  const Samples& best = quickest(std::span(times.embree).first(kSequenceWays));
  const Samples& grouped = quickest(std::span(times.embree).subspan(kSequenceWays));
  std::vector<Measurement> result;
  const auto add = [&](const std::string& name, const std::string& unit, std::vector<double> values) {
    result.push_back({kName, name, unit, std::move(values)});
  };
  add("triangles", "", {double(contenders.scene.triangles.size())});
  add("closest-hit rays", "", {double(contenders.sequence.size())});
  add("occlusion rays of the precompute alone", "", {double(first.occlusion_rays)});
  for (std::size_t w = 0; w < kWays.size(); ++w) {
    add(fmt::format("bare Embree, {} wide{}", kWays[w].width, w < kSequenceWays ? "" : ", grouped"), "s",
        times.embree[w]);
  }
  add("precompute", "s", times.precompute);
  add("  of it charts, lumels, clusters", "s", times.surfaces);
  add("  of it rays and rows", "s", times.rows);
  add("bare Embree, best width", "rays/s",
      divided(Samples(best.size(), double(contenders.sequence.size())), best));
  add("precompute / best bare Embree", "", divided(times.precompute, best));
  add("precompute / best bare Embree, grouped", "", divided(times.precompute, grouped));
  return result;
}

}  // namespace

Measurements precompute_vs_embree(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const Geometry geometry = make_geometry(*scene);
  const PrecomputeOptions chosen = precompute_options(options, *scene);
  auto sequence = rays_of_precompute(*scene, geometry, chosen, RayOrder::sequence);
  if (!sequence) return tl::unexpected(sequence.error());
  auto grouped = rays_of_precompute(*scene, geometry, chosen, RayOrder::grouped);
  if (!grouped) return tl::unexpected(grouped.error());
  auto embree = BareEmbree::create(geometry.positions, geometry.triangles, "");
  if (!embree) return tl::unexpected(embree.error());
  const Contenders contenders{*scene, chosen, std::move(*sequence), std::move(*grouped), std::move(*embree)};
  const auto checked = check_answers(contenders);
  if (!checked) return tl::unexpected(checked.error());
  const auto times = take_turns(contenders, options.repetitions);
  if (!times) return tl::unexpected(times.error());
  return report_times(contenders, *checked, *times);
}

}  // namespace relume::bench
