// SPDX-License-Identifier: MIT
#include "tool/result_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "tool/image.h"
#include "tool/json_value.h"

namespace relume {
namespace {

/// A cell as RFC 4180 has it.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

template <class Vector>
std::string cells(const Vector& v) {
  return fmt::format("{:.9g},{:.9g},{:.9g}", v[0], v[1], v[2]);
}

/// Names of six more columns, or none.
std::string bound_names(const std::string& value, const Bracket* bracket) {
  if (!bracket) return "";
  return fmt::format(",{0}_low_r,{0}_low_g,{0}_low_b,{0}_high_r,{0}_high_g,{0}_high_b", value);
}

std::string bound_cells(const Bracket* bracket, std::size_t row) {
  if (!bracket) return "";
  return fmt::format(",{},{}", cells(bracket->low[row]), cells(bracket->high[row]));
}

std::string noise_cells(const std::vector<Rgb>* noise, std::size_t row) {
  if (!noise) return "";
  return fmt::format(",{}", cells((*noise)[row]));
}

JsonObject chart_json(const Model& model, const System& system, const LightmapChart& chart) {
  const glm::vec2 size(system.lightmap_width, system.lightmap_height);
  const glm::vec2 scale = chart.scale / size;
  const glm::vec2 offset = chart.offset / size;
  const bool own = chart.uv_set == kNone;
  return {{"node", model.nodes[chart.node].path},
          {"side", chart.side == Side::front ? "front" : "back"},
          {"uv_set", own ? JsonValue() : JsonValue(chart.uv_set)},
          {"scale", own ? JsonArray{1.0, 1.0} : JsonArray{scale.x, scale.y}},
          {"offset", own ? JsonArray{0.0, 0.0} : JsonArray{offset.x, offset.y}}};
}

}  // namespace

std::string clusters_csv(const Model& model, const Lighting& lighting, std::span<const Rgb> radiosity,
                         const Bracket* bracket, const std::vector<Rgb>* noise) {
  std::string text =
      "id,system,px,py,pz,nx,ny,nz,area,albedo_r,albedo_g,albedo_b,exitance_r,exitance_g,exitance_b,"
      "direct_r,direct_g,direct_b,radiosity_r,radiosity_g,radiosity_b" +
      bound_names("radiosity", bracket) +
      (noise ? ",radiosity_noise_r,radiosity_noise_g,radiosity_noise_b" : "") + "\n";
  std::size_t id = 0;
  for (const System& system : model.systems) {
    const std::string name = csv_cell(system.name);
    for (const Cluster& cluster : system.clusters) {
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{:.9g},{},{},{},{}{}{}\n", id, name,
                     cells(model.origin + glm::dvec3(cluster.centroid)), cells(cluster.normal), cluster.area,
                     cells(lighting.albedo[id]), cells(lighting.exitance[id]), cells(lighting.direct[id]),
                     cells(radiosity[id]), bound_cells(bracket, id), noise_cells(noise, id));
      ++id;
    }
  }
  return text;
}

std::string sensors_csv(const Model& model, std::span<const Rgb> gather_direct,
                        std::span<const Rgb> gather_indirect, const Bracket* bracket) {
  std::vector<std::pair<std::uint32_t, std::string>> lines;
  std::size_t row = 0;
  for (const System& system : model.systems) {
    row += system.lumels.size();
    for (const Sensor& sensor : system.sensors) {
      lines.emplace_back(sensor.name,
                         fmt::format("{},{},{},{},{}{}\n", model.sensor_names[sensor.name],
                                     cells(sensor.position), cells(sensor.normal), cells(gather_direct[row]),
                                     cells(gather_indirect[row]), bound_cells(bracket, row)));
      ++row;
    }
  }
  std::sort(lines.begin(), lines.end());
  std::string text = "id,px,py,pz,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b" +
                     bound_names("indirect", bracket) + "\n";
  for (const auto& line : lines) text += line.second;
  return text;
}

std::string probes_csv(const Model& model, std::span<const ProbeCoefficients> coefficients) {
  std::vector<std::pair<std::uint32_t, std::string>> lines;
  for (const System& system : model.systems) {
    for (const Probe& probe : system.probes) {
      std::string line = fmt::format("{},{},{}", csv_cell(model.probe_names[probe.name]),
                                     cells(probe.position), (probe.flags & kProbeInvalid) != 0 ? 0 : 1);
      for (const Rgb& value : coefficients[probe.name]) line += ',' + cells(value);
      lines.emplace_back(probe.name, line + '\n');
    }
  }
  std::sort(lines.begin(), lines.end());
  std::string text = "id,px,py,pz,valid";
  for (std::size_t h = 0; h < kProbeHarmonics; ++h) text += fmt::format(",c{0}_r,c{0}_g,c{0}_b", h);
  text += '\n';
  for (const auto& line : lines) text += line.second;
  return text;
}

Result<std::vector<std::byte>> probes_exr(const Model& model,
                                          std::span<const ProbeCoefficients> coefficients) {
  constexpr auto kWidth = static_cast<std::uint32_t>(kProbeHarmonics);
  ColorImage image(kWidth, static_cast<std::uint32_t>(coefficients.size()));
  std::vector<float> valid(image.pixels.size(), 0.0f);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = glm::vec3(coefficients[i / kProbeHarmonics][i % kProbeHarmonics]);
  for (const System& system : model.systems) {
    for (const Probe& probe : system.probes) {
      if ((probe.flags & kProbeInvalid) != 0) continue;
      std::fill_n(valid.begin() + std::ptrdiff_t{kWidth} * probe.name, kWidth, 1.0f);
    }
  }
  return encode_exr(image, std::move(valid));
}

std::vector<std::string> system_file_names(const Model& model) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const System& system : model.systems) {
    std::string name = system.name.empty() ? "system" : system.name;
    for (char& c : name) {
      if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
    }
    if (name.front() == '.') name.front() = '_';
    std::string unique = name;
    for (int copy = 2; !taken.insert(unique).second; ++copy) unique = fmt::format("{}_{}", name, copy);
    names.push_back(unique);
  }
  return names;
}

std::string lightmaps_json(const Model& model) {
  const std::vector<std::string> names = system_file_names(model);
  JsonArray lightmaps;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    if (system.lightmap_width == 0) continue;
    JsonArray charts;
    for (const LightmapChart& chart : system.charts) charts.emplace_back(chart_json(model, system, chart));
    lightmaps.emplace_back(JsonObject{{"system", system.name},
                                      {"width", system.lightmap_width},
                                      {"height", system.lightmap_height},
                                      {"direct", "lightmaps/" + names[s] + ".direct.exr"},
                                      {"indirect", "lightmaps/" + names[s] + ".indirect.exr"},
                                      {"charts", std::move(charts)}});
  }
  return to_json_text(
             {{"unit", "lux"}, {"color_space", "linear Rec.709"}, {"lightmaps", std::move(lightmaps)}}) +
         "\n";
}

}  // namespace relume
