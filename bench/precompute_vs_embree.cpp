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
constexpr std::array<int, 3> kWidths{1, 8, 16};

struct Contenders {
  const Scene& scene;
  PrecomputeOptions options;
  RayList rays;
  BareEmbree embree;
};

/// The precompute traces as many rays as are in the list, and all widths meet equally many surfaces.
Result<PrecomputeReport> check_answers(const Contenders& contenders) {
  PrecomputeReport report;
  const auto model = precompute(contenders.scene, contenders.options, report);
  if (!model) return tl::unexpected(model.error());
  if (report.rays != contenders.rays.size()) {
    return fail(ErrorCode::check_failed, fmt::format("{}: the precompute traced {} rays, the list has {}",
                                                     kName, report.rays, contenders.rays.size()));
  }
  const std::uint64_t hits = contenders.embree.trace(contenders.rays, kWidths[0]).hits;
  for (const int width : kWidths) {
    const std::uint64_t found = contenders.embree.trace(contenders.rays, width).hits;
    if (found == hits) continue;
    return fail(
        ErrorCode::check_failed,
        fmt::format("{}: {} rays met something one by one, {} in packets of {}", kName, hits, found, width));
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
  std::array<std::vector<double>, kWidths.size()> embree;
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
    for (std::size_t w = 0; w < kWidths.size(); ++w) {
      HitCount count;
      times.embree[w].push_back(
          seconds_of([&] { count = contenders.embree.trace(contenders.rays, kWidths[w]); }));
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

std::vector<Measurement> report_times(const Contenders& contenders, const PrecomputeReport& first,
                                      const Times& times) {
  const auto best = std::min_element(times.embree.begin(), times.embree.end(),
                                     [](const auto& a, const auto& b) { return median(a) < median(b); });
  std::vector<Measurement> result;
  const auto add = [&](const std::string& name, const std::string& unit, std::vector<double> values) {
    result.push_back({kName, name, unit, std::move(values)});
  };
  add("triangles", "", {double(contenders.scene.triangles.size())});
  add("closest-hit rays", "", {double(contenders.rays.size())});
  add("occlusion rays of the precompute alone", "", {double(first.occlusion_rays)});
  for (std::size_t w = 0; w < kWidths.size(); ++w)
    add(fmt::format("bare Embree, {} wide", kWidths[w]), "s", times.embree[w]);
  add("precompute", "s", times.precompute);
  add("  of it charts, lumels, clusters", "s", times.surfaces);
  add("  of it rays and rows", "s", times.rows);
  add("bare Embree, best width", "rays/s",
      divided(std::vector<double>(best->size(), double(contenders.rays.size())), *best));
  add("precompute / best bare Embree", "", divided(times.precompute, *best));
  return result;
}

}  // namespace

Measurements precompute_vs_embree(const BenchmarkOptions& options) {
  const auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  const Geometry geometry = make_geometry(*scene);
  const PrecomputeOptions chosen = precompute_options(options, *scene);
  auto rays = rays_of_precompute(*scene, geometry, chosen);
  if (!rays) return tl::unexpected(rays.error());
  auto embree = BareEmbree::create(geometry.positions, geometry.triangles, "");
  if (!embree) return tl::unexpected(embree.error());
  const Contenders contenders{*scene, chosen, std::move(*rays), std::move(*embree)};
  const auto checked = check_answers(contenders);
  if (!checked) return tl::unexpected(checked.error());
  const auto times = take_turns(contenders, options.repetitions);
  if (!times) return tl::unexpected(times.error());
  return report_times(contenders, *checked, *times);
}

}  // namespace relume::bench
