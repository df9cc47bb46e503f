// SPDX-License-Identifier: MIT
#include "tool/lumel_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "precompute/leak_meter.h"
#include "tool/row_views.h"
#include "tool/uv_overlap.h"

namespace relume {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
/// Where few lumels stand out, white is where so many of them are below.
constexpr double kMostLumels = 0.99;
/// Rows that are measured for a picture of leaks: the others are drawn as those next to them.
constexpr std::uint32_t kLeakRows = 4096;

/// Of each gather row of each system; sensors have no place in a picture.
LumelNumbers of_rows(const Model& model,
                     const std::function<std::vector<double>(const Model&, std::size_t)>& rows) {
  LumelNumbers numbers;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    numbers.values.push_back(rows(model, s));
    numbers.values.back().resize(model.systems[s].lumels.size());
  }
  return numbers;
}

/// White is the number below which a share of the valid lumels lies, so that few that stand out do not leave
/// all others dark; 1 more than black if there is none.
LumelNumbers up_to(double share, const Model& model, LumelNumbers numbers) {
  std::vector<double> all;
  for (std::size_t s = 0; s < numbers.values.size(); ++s) {
    for (std::size_t i = 0; i < numbers.values[s].size(); ++i) {
      const bool valid = (model.systems[s].lumels[i].flags & kLumelInvalid) == 0;
      if (valid && !std::isnan(numbers.values[s][i])) all.push_back(numbers.values[s][i]);
    }
  }
  double most = numbers.black;
  if (!all.empty()) {
    const auto place = all.begin() + std::ptrdiff_t(share * double(all.size() - 1));
    std::nth_element(all.begin(), place, all.end());
    most = *place > numbers.black ? *place : *std::max_element(all.begin(), all.end());
  }
  numbers.white = most > numbers.black ? most : numbers.black + 1.0;
  return numbers;
}

/// What rows inside geometry are made of says nothing.
LumelNumbers without_invalid(const Model& model, LumelNumbers numbers) {
  for (std::size_t s = 0; s < numbers.values.size(); ++s) {
    for (std::size_t i = 0; i < numbers.values[s].size(); ++i) {
      if (model.systems[s].lumels[i].flags & kLumelInvalid) numbers.values[s][i] = kNoNumber;
    }
  }
  return numbers;
}

Result<LumelNumbers> row_sum_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers = of_rows(model, row_sums);
  numbers.unit = std::string("sum of a lumel's form factors: the share of its hemisphere that has a sender");
  return numbers;
}

Result<LumelNumbers> cut_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers = of_rows(model, shares_of_nodes);
  numbers.unit = std::string("share of a lumel's form factors that goes to means over several clusters");
  return numbers;
}

Result<LumelNumbers> tree_level_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers = up_to(1.0, model, of_rows(model, tree_levels));
  numbers.unit = std::string(
      "levels of the cluster trees above the clusters, mean by form factor: k where a lumel sees "
      "means over 2^k clusters");
  return numbers;
}

Result<LumelNumbers> row_length_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers = up_to(1.0, model, of_rows(model, row_lengths));
  numbers.unit = std::string("senders that a lumel's row names");
  return numbers;
}

Result<LumelNumbers> uv_overlap_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers = of_rows(model, uv_overlaps);
  numbers.unit = std::string("share of a lumel where two triangles lie over each other in TEXCOORD_1");
  numbers.none = std::string("charts made by Relume, which do not overlap");
  return numbers;
}

Result<LumelNumbers> ray_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers;
  numbers.unit = std::string("rays of a lumel");
  for (const System& system : model.systems) {
    if (system.rays.empty() && !system.lumels.empty()) {
      return fail(ErrorCode::usage,
                  "--debug rays: expected a file that tells how many rays rows have, found "
                  "none; precompute the scene again");
    }
    auto& values = numbers.values.emplace_back();
    for (const Lumel& lumel : system.lumels)
      values.push_back(double(system.rays[system.elements[lumel.element].cluster].count));
  }
  numbers = up_to(1.0, model, std::move(numbers));
  numbers.black = std::max(1.0, numbers.white / 256.0);
  numbers.scale = HeatScale::logarithm;
  return numbers;
}

Result<LumelNumbers> error_numbers(const Model& model, const glm::dvec3&) {
  LumelNumbers numbers;
  bool noise = false, cut = false;
  for (const System& system : model.systems) {
    auto& values = numbers.values.emplace_back();
    cut = cut || !system.cut_errors.empty();
    for (std::size_t i = 0; i < system.lumels.size(); ++i) {
      const double of_rays =
          system.rays.empty() ? 0.0
                              : double(system.rays[system.elements[system.lumels[i].element].cluster].noise);
      const double of_cut = system.cut_errors.empty() ? 0.0 : double(system.cut_errors[i]);
      noise = noise || of_rays > 0.0;
      values.push_back(std::hypot(of_rays, of_cut));
    }
  }
  if (!noise && !cut) {
    return fail(ErrorCode::usage,
                "--debug error: expected a file with estimates (precompute --error or --budget), "
                "found one without");
  }
  numbers = up_to(kMostLumels, model, std::move(numbers));
  numbers.unit = fmt::format(
      "estimated error of a lumel's row by {}, relative to the root mean square irradiance of its room; "
      "without "
      "what cluster sizes and stored values add",
      noise && cut ? "the noise of its rays and its cut"
      : noise      ? "the noise of its rays"
                   : "its cut alone");
  numbers.scale = HeatScale::square_root;
  return numbers;
}

Result<LumelNumbers> leak_numbers(const Model& model, const glm::dvec3&) {
  LeakOptions options;
  options.rows = kLeakRows;
  options.clusters = false;
  const auto report = measure_leaks(model, options);
  if (!report) return tl::unexpected(report.error());
  std::vector<std::map<std::uint32_t, double>> measured(model.systems.size());
  for (const RowLeak& row : report->rows) measured[row.system][row.index] = row.walled;
  LumelNumbers numbers;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    auto& values = numbers.values.emplace_back(model.systems[s].lumels.size(), kNoNumber);
    if (measured[s].empty()) continue;
    for (std::uint32_t i = 0; i < values.size(); ++i) {
      if (model.systems[s].lumels[i].flags & kLumelInvalid) continue;
      auto next = measured[s].lower_bound(i);
      const bool before = next != measured[s].begin() &&
                          (next == measured[s].end() || i - std::prev(next)->first < next->first - i);
      values[i] = (before ? std::prev(next) : next)->second;
    }
  }
  numbers = up_to(kMostLumels, model, std::move(numbers));
  numbers.unit = fmt::format(
      "share of a lumel's hemisphere that it receives from behind walls, by means over clusters that it "
      "cannot "
      "see; {} of the lumels are measured, the others are drawn as their neighbours",
      report->lumels.rows);
  numbers.scale = HeatScale::square_root;
  return numbers;
}

Result<LumelNumbers> form_factor_numbers(const Model& model, const glm::dvec3& at) {
  const std::vector<double> densities = form_factor_densities(model, nearest_lumel(model, at));
  const auto first = cluster_offsets(model);
  LumelNumbers numbers;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    auto& values = numbers.values.emplace_back();
    for (const Lumel& lumel : model.systems[s].lumels)
      values.push_back(densities[first[s] + model.systems[s].elements[lumel.element].cluster]);
  }
  numbers = up_to(kMostLumels, model, std::move(numbers));
  numbers.unit = std::string("form factor from the chosen lumel (green), per m2");
  numbers.scale = HeatScale::square_root;
  return numbers;
}

using Maker = Result<LumelNumbers> (*)(const Model&, const glm::dvec3&);

const std::map<std::string, Maker>& makers() {
  static const std::map<std::string, Maker> all{{"cut", cut_numbers},
                                                {"error", error_numbers},
                                                {"form_factors", form_factor_numbers},
                                                {"leaks", leak_numbers},
                                                {"rays", ray_numbers},
                                                {"row_length", row_length_numbers},
                                                {"row_sum", row_sum_numbers},
                                                {"tree_level", tree_level_numbers},
                                                {"uv_overlap", uv_overlap_numbers}};
  return all;
}

}  // namespace

const std::vector<std::string>& number_view_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [name, maker] : makers()) list.push_back(name);
    return list;
  }();
  return names;
}

Result<LumelNumbers> lumel_numbers(const Model& model, const std::string& view, const glm::dvec3& at) {
  auto numbers = makers().at(view)(model, at);
  // Why they are inside is what their sums tell.
  if (!numbers || view == "row_sum" || view == "form_factors") return numbers;
  return without_invalid(model, std::move(*numbers));
}

double heat_of(const LumelNumbers& numbers, double value) {
  const auto scaled = [&](double v) {
    if (numbers.scale == HeatScale::square_root) return std::sqrt(std::max(0.0, v));
    return numbers.scale == HeatScale::logarithm ? std::log2(std::max(1e-30, v)) : v;
  };
  const double black = scaled(numbers.black), white = scaled(numbers.white);
  return white > black ? std::clamp((scaled(value) - black) / (white - black), 0.0, 1.0) : 0.0;
}

}  // namespace relume
