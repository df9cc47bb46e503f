// SPDX-License-Identifier: MIT
#include "tool/chart/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "measure/statistics.h"
#include "tool/chart/axis_scale.h"

namespace relume {
namespace {

constexpr const char* kErrorLabel = "error of indirect irradiance (relative L2 over area), %";
/// Axes whose points are one curve through the centre.
constexpr const char* kTargets = "--error";
const std::vector<std::string> kCurves{"budget", "rays", "cluster size", "value format", kTargets};
const std::vector<std::string> kClouds{"kernel (tiles)", "kernel (plain CSR)", "method"};

double percent(double share) {
  return 100.0 * share;
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}
double most(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

/// "1.5 (1.4 to 2 in 15 runs)".
std::string spread(const std::vector<double>& values) {
  if (values.size() < 2) return short_number(median(values));
  return fmt::format("{} ({} to {} in {} runs)", short_number(median(values)), short_number(least(values)),
                     short_number(most(values)), values.size());
}

std::string error_text(const MeasuredError& error) {
  return fmt::format("error {} % (worst light {} %)", short_number(percent(error.all_lights)),
                     short_number(percent(error.worst_light)));
}

const char* role_name(PointRole role) {
  if (role == PointRole::centre) return "centre";
  return role == PointRole::program_default ? "default" : "";
}

std::string method_text(const RelightPoint& point) {
  return point.kernel ? name_of(*point.kernel) : "reference in double precision, one core";
}

std::string hover(const RelightPoint& point) {
  return fmt::format("{}\n{} ms\n{}\n{} products, {}\n{} form factors, {} MB", name_of(point),
                     spread(point.milliseconds), error_text(point.error), point.products, method_text(point),
                     point.form_factors, short_number(1e-6 * double(point.bytes)));
}

std::string hover(const PrecomputePoint& point) {
  return fmt::format("{}\n{} s\n{}\n{} million rays, {} form factors, {} MB",
                     point.role == PointRole::centre ? "centre" : point.axis + " " + point.value,
                     spread(point.seconds), error_text(point.error), short_number(1e-6 * double(point.rays)),
                     point.form_factors, short_number(1e-6 * double(point.bytes)));
}

double time_of(const RelightPoint& point) {
  return median(point.milliseconds);
}
double megabytes(const RelightPoint& point) {
  return 1e-6 * double(point.bytes);
}
double seconds(const PrecomputePoint& point) {
  return median(point.seconds);
}

/// A point of a chart whose y is the error.
template <class Point>
ChartPoint against_error(const Point& point, double x) {
  ChartPoint drawn{x, percent(point.error.all_lights), point.value, hover(point)};
  drawn.chosen = point.role != PointRole::other;
  return drawn;
}

/// The curve of one axis from its worst to its best point, with the centre among them.
template <class Point>
ChartSeries curve(const std::vector<Point>& points, const std::string& axis, double (*x)(const Point&)) {
  ChartSeries series{axis, {}};
  for (const Point& point : points) {
    const bool joins = point.role == PointRole::centre && axis != kTargets;
    if (point.axis != axis && !joins) continue;
    series.points.push_back(against_error(point, x(point)));
  }
  std::sort(series.points.begin(), series.points.end(),
            [](const ChartPoint& a, const ChartPoint& b) { return a.y > b.y; });
  return series;
}

/// Curves, without those that have no point of their own; the centre is ringed and named once.
template <class Point>
std::vector<ChartSeries> curves(const std::vector<Point>& points, double (*x)(const Point&)) {
  std::vector<ChartSeries> all;
  for (const std::string& axis : kCurves) {
    ChartSeries series = curve(points, axis, x);
    if (series.points.size() < (axis == kTargets ? 1 : 2)) continue;
    for (ChartPoint& point : series.points) {
      point.chosen = point.label == "centre" && all.empty();
      if (point.label == "centre" && !all.empty()) point.label.clear();
    }
    all.push_back(std::move(series));
  }
  return all;
}

template <class Point>
void add_default(const std::vector<Point>& points, double (*x)(const Point&), std::vector<ChartSeries>& all) {
  for (const Point& point : points) {
    if (point.role != PointRole::program_default) continue;
    ChartPoint drawn = against_error(point, x(point));
    drawn.label = "default";
    all.push_back({"default of the program: full rows, 16 bits", {drawn}, false});
  }
}

ChartLevel doubt(const ChartData& data) {
  return {percent(data.densest_alone),
          fmt::format("the densest model alone, {} clusters", data.densest_clusters)};
}

std::string relight_csv(const std::vector<RelightPoint>& points) {
  std::string csv =
      "axis,value,role,kernel,fetch,format,tile_rows,method,products,error,worst_light,ms_median,ms_min,ms_"
      "max,runs,"
      "form_factors,bytes\n";
  for (const RelightPoint& p : points) {
    const KernelVariant kernel = p.kernel.value_or(KernelVariant{});
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{}\n", p.axis,
                       p.value, role_name(p.role), p.kernel ? row_kernel_name(kernel.kernel) : "reference",
                       !p.kernel                             ? ""
                       : kernel.fetch == MatrixFetch::texels ? "texels"
                                                             : "storage",
                       codec_name(kernel.codec), kernel.tile_rows, method_names()[std::size_t(p.method)],
                       p.products, p.error.all_lights, p.error.worst_light, time_of(p), least(p.milliseconds),
                       most(p.milliseconds), p.milliseconds.size(), p.form_factors, p.bytes);
  }
  return csv;
}

ChartAndTable relight_chart(const ChartData& data) {
  ChartPicture chart{
      "relight",
      "Relighting: milliseconds against error",
      "A whole relighting: from B = M + rho H by plain bounces until, under every test light, the iteration "
      "is "
      "within 0.1 % of its own solution, then all lumels. Times are the device's own timestamps, medians of "
      "runs that take turns; direct light is not in them. The methods are the reference's, on one core in "
      "double "
      "precision: they show what a method costs, not what a device could do. The centre is 512 rays, budget "
      "128, "
      "16-bit values; each curve varies one thing from there; the front is that of the device.",
      {"milliseconds per converged relight"},
      {kErrorLabel},
      curves(data.relights, time_of)};
  for (const std::string& axis : kClouds) {
    ChartSeries series{axis == "method" ? "method (reference, one core)" : axis, {}, false};
    for (const RelightPoint& point : data.relights) {
      if (point.axis == axis) series.points.push_back(against_error(point, time_of(point)));
      if (point.axis == axis && axis != "method") series.points.back().label.clear();
    }
    if (!series.points.empty()) chart.series.push_back(std::move(series));
  }
  add_default(data.relights, time_of, chart.series);
  for (const RelightPoint& point : front_of(data))
    chart.front.emplace_back(time_of(point), percent(point.error.all_lights));
  chart.level = doubt(data);
  return {std::move(chart), relight_csv(data.relights)};
}

ChartAndTable tracking_chart(const ChartData& data) {
  ChartPicture chart{
      "tracking",
      "A light that moves every frame: milliseconds against tracking error",
      "A point light on a circle. Each frame does k products (the number beside each point) from the "
      "radiosity of "
      "the frame before, then all lumels; its error is against the same model's own solution for "
      "that frame, mean "
      "over the frames. Frames from nothing start at B = 0 instead.",
      {"milliseconds per frame, bounces and gather"},
      {"tracking error (relative L2 over area), %"},
      {}};
  std::string csv = "frames_per_turn,products,error,ms_median,ms_min,ms_max,runs\n";
  for (const TrackingPoint& point : data.tracking) {
    const std::string name = point.frames_per_turn == 0
                                 ? "every frame from nothing"
                                 : fmt::format("{} frames a turn", point.frames_per_turn);
    if (chart.series.empty() || chart.series.back().name != name) chart.series.push_back({name, {}});
    const double time = median(point.milliseconds);
    chart.series.back().points.push_back(
        {time, percent(point.error), std::to_string(point.products),
         fmt::format("{}, {} products\n{} ms\nerror {} %", name, point.products, spread(point.milliseconds),
                     short_number(percent(point.error)))});
    csv += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", point.frames_per_turn, point.products,
                       point.error, time, least(point.milliseconds), most(point.milliseconds),
                       point.milliseconds.size());
  }
  return {std::move(chart), std::move(csv)};
}

ChartAndTable precompute_chart(const ChartData& data) {
  ChartPicture chart{
      "precompute",
      "Precompute: seconds against error",
      "Rays per lumel, cluster size and budget, one varied at a time, and what --error makes of them "
      "together. "
      "Wall-clock time of the whole precompute on all cores, sensors included; the error is that of "
      "the converged "
      "solution.",
      {"seconds of precompute"},
      {kErrorLabel},
      curves(data.precomputes, seconds)};
  add_default(data.precomputes, seconds, chart.series);
  chart.front = pareto_front(chart.series);
  chart.level = doubt(data);
  std::string csv = "axis,value,role,error,worst_light,s_median,s_min,s_max,runs,rays,form_factors,bytes\n";
  for (const PrecomputePoint& p : data.precomputes) {
    csv += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{},{}\n", p.axis, p.value,
                       role_name(p.role), p.error.all_lights, p.error.worst_light, seconds(p),
                       least(p.seconds), most(p.seconds), p.seconds.size(), p.rays, p.form_factors, p.bytes);
  }
  return {std::move(chart), std::move(csv)};
}

std::string without_commas(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  return text;
}

const char* end_name(MethodEnd end) {
  constexpr const char* kNames[] = {"converged", "gave way", "refused", "too many"};
  return kNames[std::size_t(end)];
}

ChartPoint drawn(const ProductsPoint& point) {
  ChartPoint drawn{1.0 / (1.0 - point.albedo), double(point.products), {}, {}};
  drawn.failed = point.end != MethodEnd::converged;
  drawn.hover = fmt::format("{}, albedo {}: {}", point.method, point.albedo,
                            drawn.failed ? point.reason : fmt::format("{} products", point.products));
  return drawn;
}

ChartAndTable products_chart(const ChartData& data) {
  ChartPicture chart{
      "products",
      "Products to 0.1 % against albedo",
      fmt::format(
          "Products with the matrix until reflected light is within 0.1 % of the solution (relative L2 over "
          "area). Full rows of {} clusters, as rays measured them, every surface of one albedo, one point "
          "light. A cross is where a method fails: at the bottom it refuses, at the top it needs more than "
          "were allowed, between it gave way to plain bounces.",
          data.products_clusters),
      {"albedo of all surfaces"},
      {"products (applications of K)"},
      {}};
  std::string csv = "method,albedo,products,end,reason\n";
  for (const ProductsPoint& point : data.products) {
    auto series = std::find_if(chart.series.begin(), chart.series.end(),
                               [&](const ChartSeries& one) { return one.name == point.method; });
    if (series == chart.series.end()) series = chart.series.insert(series, {point.method, {}});
    series->points.push_back(drawn(point));
    const std::pair<double, std::string> tick{series->points.back().x, fmt::format("{:g}", point.albedo)};
    if (std::find(chart.x.ticks.begin(), chart.x.ticks.end(), tick) == chart.x.ticks.end())
      chart.x.ticks.push_back(tick);
    csv += fmt::format("{},{},{},{},{}\n", point.method, point.albedo, point.products, end_name(point.end),
                       without_commas(point.reason));
  }
  return {std::move(chart), std::move(csv)};
}

struct Cause {
  const char* name;
  double ErrorCauses::*share;
};
constexpr Cause kCauses[] = {{"cluster size", &ErrorCauses::clusters},
                             {"rays", &ErrorCauses::rays},
                             {"budget (cut)", &ErrorCauses::cut},
                             {"precision", &ErrorCauses::precision},
                             {"bounces", &ErrorCauses::bounces}};
constexpr double kLeastShare = 1e-5;

/// Another place on the x axis, and its points.
void add_causes(const RelightPoint& point, ChartPicture& chart) {
  const double x = double(chart.x.ticks.size());
  chart.x.ticks.emplace_back(
      x, fmt::format("{}\n{}\n{} ms", point.axis, point.value == point.axis ? "" : point.value,
                     short_number(time_of(point))));
  chart.series[0].points.push_back({x, percent(point.error.all_lights), {}, hover(point)});
  for (std::size_t c = 0; c < std::size(kCauses); ++c) {
    const double share = (*point.causes).*kCauses[c].share;
    if (share < kLeastShare) continue;
    const bool estimated = point.causes->estimated && kCauses[c].share != &ErrorCauses::bounces;
    chart.series[c + 1].points.push_back(
        {x,
         percent(share),
         {},
         fmt::format("{}: {} % from {}{}", name_of(point), short_number(percent(share)), kCauses[c].name,
                     estimated ? " (estimated)" : "")});
  }
}

std::string causes_line(const RelightPoint& point) {
  std::string csv =
      fmt::format("{},{},{:.6g},{:.6g}", point.axis, point.value, time_of(point), point.error.all_lights);
  for (const Cause& cause : kCauses) csv += fmt::format(",{:.6g}", (*point.causes).*cause.share);
  return csv + fmt::format(",{}\n", point.causes->estimated ? "yes" : "no");
}

ChartAndTable causes_chart(const ChartData& data) {
  ChartPicture chart{
      "causes",
      "What the error is made of, along the front",
      "The points of the Pareto front from fast to accurate, each error split by cause. Measured by "
      "taking one cause "
      "away at a time: bounces (converged or not), precision (values in f32), cut (full rows of the "
      "same rays), rays "
      "(two seeds); clusters are what is left. For points named --error the four are what the "
      "precompute itself "
      "estimated, on the safe side. Shares below 0.001 % are in the table alone.",
      {"points of the front, milliseconds per converged relight", false},
      {"share of the error (relative L2 over area), %"},
      {{"measured error", {}}}};
  for (const Cause& cause : kCauses) chart.series.push_back({cause.name, {}});
  std::string csv = "axis,value,ms,error,clusters,rays,cut,precision,bounces,estimated\n";
  for (const RelightPoint& point : front_of(data)) {
    if (!point.causes) continue;
    add_causes(point, chart);
    csv += causes_line(point);
  }
  return {std::move(chart), std::move(csv)};
}

ChartAndTable bytes_chart(const ChartData& data) {
  ChartPicture chart{
      "bytes",
      "Memory: megabytes against error",
      "Bytes of the bounce and gather matrices as a device holds them, against the error of the relighting.",
      {"megabytes of both matrices"},
      {kErrorLabel},
      curves(data.relights, megabytes)};
  add_default(data.relights, megabytes, chart.series);
  chart.front = pareto_front(chart.series);
  chart.level = doubt(data);
  std::string csv = "axis,value,role,format,bytes,form_factors,error,worst_light\n";
  for (const RelightPoint& p : data.relights) {
    if (!p.kernel || p.axis.starts_with("kernel")) continue;
    csv += fmt::format("{},{},{},{},{},{},{:.6g},{:.6g}\n", p.axis, p.value, role_name(p.role),
                       codec_name(p.kernel->codec), p.bytes, p.form_factors, p.error.all_lights,
                       p.error.worst_light);
  }
  return {std::move(chart), std::move(csv)};
}

}  // namespace

std::string name_of(const RelightPoint& point) {
  return point.axis == point.value ? point.value : point.axis + " " + point.value;
}

std::vector<RelightPoint> front_of(const ChartData& data) {
  std::vector<RelightPoint> sorted = data.relights, front;
  std::erase_if(sorted, [](const RelightPoint& point) { return !point.kernel; });
  std::sort(sorted.begin(), sorted.end(), [](const RelightPoint& a, const RelightPoint& b) {
    return std::pair(time_of(a), a.error.all_lights) < std::pair(time_of(b), b.error.all_lights);
  });
  for (RelightPoint& point : sorted) {
    if (front.empty() || point.error.all_lights < front.back().error.all_lights)
      front.push_back(std::move(point));
  }
  return front;
}

std::vector<ChartAndTable> make_charts(const ChartData& data) {
  return {relight_chart(data),  tracking_chart(data), precompute_chart(data),
          products_chart(data), causes_chart(data),   bytes_chart(data)};
}

}  // namespace relume
