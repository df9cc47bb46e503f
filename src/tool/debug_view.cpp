// SPDX-License-Identifier: MIT
#include "tool/debug_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>

#include "tool/heat_color.h"
#include "tool/lightmap_image.h"
#include "tool/lumel_numbers.h"
#include "tool/model_summary.h"
#include "tool/row_views.h"

namespace relume {
namespace {

const Rgb kChosen(0.05, 0.9, 0.2);
const Rgb kNoNumber(0.03, 0.06, 0.2);
/// What black is drawn as, so that shapes can be told.
constexpr double kDark = 0.03;

/// Where a lumel stands in the model.
struct LumelPlace {
  const System& system;
  std::size_t system_index;
  std::size_t lumel;

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

std::vector<ColorImage> draw_lumels(const Model& model, const LumelColor& color) {
  std::vector<ColorImage> images;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    // Invalid lumels are part of the picture here.
    System system = model.systems[s];
    std::vector<Rgb> colors;
    for (std::size_t i = 0; i < system.lumels.size(); ++i) colors.push_back(color({model.systems[s], s, i}));
    for (Lumel& lumel : system.lumels) lumel.flags &= ~std::uint32_t{kLumelInvalid};
    images.push_back(lightmap_image(system, colors));
  }
  return images;
}

std::uint64_t count_lumels(const Model& model, const std::function<bool(const Lumel&)>& counts) {
  std::uint64_t count = 0;
  for (const System& system : model.systems)
    count += std::uint64_t(std::count_if(system.lumels.begin(), system.lumels.end(), counts));
  return count;
}

DebugView draw_validity(const Model& model) {
  const std::uint64_t all = count_lumels(model, [](const Lumel&) { return true; });
  const std::uint64_t invalid =
      count_lumels(model, [](const Lumel& lumel) { return (lumel.flags & kLumelInvalid) != 0; });
  const std::uint64_t split = count_lumels(model, [](const Lumel& lumel) {
    return (lumel.flags & kLumelInvalid) == 0 && (lumel.flags & kLumelSplit) != 0;
  });
  return {draw_lumels(model, validity_color),
          fmt::format(
              "validity: grey valid, red inside geometry ({}), yellow split by a wall or shared with another "
              "part of the surface ({}), of {} lumels",
              invalid, split, all),
          {{"view", "validity"}, {"lumels", all}, {"invalid", invalid}, {"split", split}}};
}

/// A colour for each of `count` things.
DebugView draw_kinds(const Model& model, const std::string& view, std::uint64_t count,
                     const std::function<std::uint64_t(const LumelPlace&)>& number) {
  return {draw_lumels(model, [&](const LumelPlace& place) { return color_of_number(number(place)); }),
          fmt::format("{}: a colour for each of {}", view, count),
          {{"view", view}, {"count", count}}};
}

DebugView draw_albedo(const Model& model) {
  return {draw_lumels(model,
                      [](const LumelPlace& p) {
                        return Rgb(p.cluster().albedo[0], p.cluster().albedo[1], p.cluster().albedo[2]);
                      }),
          "albedo: of the clusters, sRGB",
          {{"view", "albedo"}}};
}

const char* name_of(HeatScale scale) {
  if (scale == HeatScale::square_root) return "square root";
  return scale == HeatScale::logarithm ? "logarithm" : "linear";
}

/// Over valid lumels that have a number.
struct Found {
  double least = 0.0, mean = 0.0, most = 0.0;
  std::uint64_t count = 0, without = 0, invalid = 0;
};

Found found_in(const Model& model, const LumelNumbers& numbers) {
  Found found;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    for (std::size_t i = 0; i < model.systems[s].lumels.size(); ++i) {
      if (model.systems[s].lumels[i].flags & kLumelInvalid) {
        ++found.invalid;
        continue;
      }
      const double value = numbers.values[s][i];
      if (std::isnan(value)) {
        ++found.without;
        continue;
      }
      found.least = found.count == 0 ? value : std::min(found.least, value);
      found.most = found.count == 0 ? value : std::max(found.most, value);
      found.mean += value;
      ++found.count;
    }
  }
  if (found.count > 0) found.mean /= double(found.count);
  return found;
}

Result<DebugView> draw_numbers(const Model& model, const std::string& view, const glm::dvec3& at) {
  const auto numbers = lumel_numbers(model, view, at);
  if (!numbers) return tl::unexpected(numbers.error());
  const bool chooses = view == "form_factors";
  const ChosenLumel chosen = chooses ? nearest_lumel(model, at) : ChosenLumel{};
  DebugView drawn;
  drawn.images = draw_lumels(model, [&](const LumelPlace& place) {
    if (chooses && place.system_index == chosen.system && place.lumel == chosen.lumel) return kChosen;
    const double value = numbers->values[place.system_index][place.lumel];
    return std::isnan(value) ? kNoNumber : kDark + (1.0 - kDark) * heat_color(heat_of(*numbers, value));
  });
  const Found found = found_in(model, *numbers);
  drawn.legend =
      fmt::format("{}: {}; black {:.3g} to white {:.3g} ({} scale), found {:.3g} to {:.3g}, mean {:.3g}",
                  view, numbers->unit, numbers->black, numbers->white, name_of(numbers->scale), found.least,
                  found.most, found.mean);
  if (found.without > 0) drawn.legend += fmt::format("; blue: {} lumels of {}", found.without, numbers->none);
  drawn.scale = {{"view", view},
                 {"unit", numbers->unit},
                 {"black", numbers->black},
                 {"white", numbers->white},
                 {"scale", name_of(numbers->scale)},
                 {"least", found.least},
                 {"mean", found.mean},
                 {"most", found.most},
                 {"lumels", found.count},
                 {"without", found.without},
                 {"invalid", found.invalid}};
  return drawn;
}

}  // namespace

const std::vector<std::string>& debug_view_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list = number_view_names();
    list.insert(list.end(), {"albedo", "clusters", "materials", "systems", "validity"});
    std::sort(list.begin(), list.end());
    return list;
  }();
  return names;
}

std::string debug_view_help() {
  return "Views of --debug; each prints its scale:\n"
         "  albedo, clusters, materials, systems  a colour for each\n"
         "  validity      red inside geometry, yellow split by a wall\n"
         "  row_sum       share of the hemisphere that has a sender; below 1 in a closed room: light is "
         "lost\n"
         "  row_length    senders of a row\n"
         "  cut           share of a row that goes to means over several clusters\n"
         "  tree_level    how high in the cluster trees a row sees: k where means are over 2^k clusters.\n"
         "                A corner that is wrong and bright here sees its neighbours too coarsely\n"
         "  rays          rays of a row\n"
         "  error         estimated error of a row by noise and cut (of files made with --error or "
         "--budget)\n"
         "  leaks         light that a row receives from behind walls, by means\n"
         "  uv_overlap    where two surfaces share texels of TEXCOORD_1; blue: charts made by Relume\n"
         "  form_factors  of the lumel nearest to --at";
}

Result<DebugView> draw_debug_view(const Model& model, const std::string& view, const glm::dvec3& at) {
  if (view == "albedo") return draw_albedo(model);
  if (view == "validity") return draw_validity(model);
  if (view == "systems") {
    return draw_kinds(model, view, model.systems.size(), [](const LumelPlace& p) { return p.system_index; });
  }
  if (view == "clusters") {
    return draw_kinds(model, view, cluster_offsets(model).back(),
                      [](const LumelPlace& p) { return p.cluster_index(); });
  }
  if (view == "materials") {
    return draw_kinds(model, view, model.materials.size(),
                      [](const LumelPlace& p) { return p.cluster().material; });
  }
  return draw_numbers(model, view, at);
}

}  // namespace relume
