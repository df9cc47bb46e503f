// SPDX-License-Identifier: MIT
#include "tool/debug_view.h"

#include <cmath>
#include <functional>
#include <glm/common.hpp>

#include "tool/heat_color.h"
#include "tool/lightmap_image.h"
#include "tool/row_views.h"

namespace relume {
namespace {

/// Where a lumel stands in the model.
struct LumelPlace {
  const System& system;
  std::size_t system_index;
  std::size_t lumel;
  std::size_t row;  ///< of the system's gather matrix

  const Lumel& value() const { return system.lumels[lumel]; }
  std::uint32_t cluster_index() const { return system.elements[value().element].cluster; }
  const Cluster& cluster() const { return system.clusters[cluster_index()]; }
};

using LumelColor = std::function<Rgb(const LumelPlace&)>;

/// Bright colours that differ between neighbouring numbers: hues a golden section apart.
Rgb color_of_number(std::uint64_t number) {
  const double hue = 6.0 * glm::fract(0.61803398875 * static_cast<double>(number));
  const Rgb wheel(glm::abs(hue - 3.0) - 1.0, 2.0 - glm::abs(hue - 2.0), 2.0 - glm::abs(hue - 4.0));
  const double depth = 0.35 + 0.2 * static_cast<double>(number % 3);
  return glm::mix(Rgb(0.9), glm::clamp(wheel, Rgb(0.0), Rgb(1.0)), 0.8) * depth;
}

Rgb validity_color(const LumelPlace& place) {
  if (place.value().flags & kLumelInvalid) return {0.8, 0.02, 0.02};
  if (place.value().flags & kLumelSplit) return {0.9, 0.7, 0.02};
  return Rgb(0.25);
}

LumelColor color_of_view(const std::string& view) {
  if (view == "albedo") {
    return [](const LumelPlace& p) {
      return Rgb(p.cluster().albedo[0], p.cluster().albedo[1], p.cluster().albedo[2]);
    };
  }
  if (view == "clusters") return [](const LumelPlace& p) { return color_of_number(p.cluster_index()); };
  if (view == "materials") return [](const LumelPlace& p) { return color_of_number(p.cluster().material); };
  if (view == "systems") return [](const LumelPlace& p) { return color_of_number(p.system_index); };
  return validity_color;
}

std::vector<double> row_sums(const BlockMatrix& matrix) {
  const CsrMatrix csr = decode(matrix);
  std::vector<double> sums(csr.rows, 0.0);
  for (std::uint32_t row = 0; row < csr.rows; ++row) {
    for (std::uint64_t k = csr.row_offsets[row]; k < csr.row_offsets[row + 1]; ++k)
      sums[row] += csr.values[k];
  }
  return sums;
}

/// Per gather row, for views that have a number there; else nothing.
std::vector<double> numbers_of_rows(const Model& model, std::size_t s, const std::string& view) {
  if (view == "row_sum") return row_sums(model.systems[s].gather);
  if (view == "cut") return shares_of_nodes(model, s);
  if (view == "row_length") return relative_row_lengths(model, s);
  return {};
}

ColorImage draw_system(const Model& model, std::size_t s, const std::string& view) {
  // Invalid lumels are part of the picture here.
  System system = model.systems[s];
  std::vector<Rgb> colors;
  if (const std::vector<double> numbers = numbers_of_rows(model, s, view); !numbers.empty()) {
    for (std::size_t i = 0; i < system.lumels.size(); ++i) colors.push_back(heat_color(numbers[i]));
  } else {
    const LumelColor color = color_of_view(view);
    for (std::size_t i = 0; i < system.lumels.size(); ++i) colors.push_back(color({system, s, i, i}));
  }
  for (Lumel& lumel : system.lumels) lumel.flags &= ~std::uint32_t{kLumelInvalid};
  return lightmap_image(system, colors);
}

std::vector<ColorImage> draw_form_factors(const Model& model, const glm::dvec3& at) {
  const Rgb chosen(0.05, 0.9, 0.2);
  const ChosenLumel receiver = nearest_lumel(model, at);
  const std::vector<double> densities = form_factor_densities(model, receiver);
  const auto first = cluster_offsets(model);
  std::vector<ColorImage> images;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    std::vector<Rgb> colors;
    for (const Lumel& lumel : system.lumels)
      colors.push_back(heat_color(std::sqrt(densities[first[s] + system.elements[lumel.element].cluster])));
    if (s == receiver.system) colors[receiver.lumel] = chosen;
    images.push_back(lightmap_image(system, colors));
  }
  return images;
}

}  // namespace

const std::vector<std::string>& debug_view_names() {
  static const std::vector<std::string> names{"albedo",       "clusters",  "cut",
                                              "form_factors", "materials", "row_length",
                                              "row_sum",      "systems",   "validity"};
  return names;
}

std::vector<ColorImage> draw_debug_view(const Model& model, const std::string& view, const glm::dvec3& at) {
  if (view == "form_factors") return draw_form_factors(model, at);
  std::vector<ColorImage> images;
  for (std::size_t s = 0; s < model.systems.size(); ++s) images.push_back(draw_system(model, s, view));
  return images;
}

}  // namespace relume
