// SPDX-License-Identifier: MIT
#include "verification/truth_data.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace relume::test {
namespace {

using nlohmann::json;

json read_json(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be opened");
  return json::parse(in);
}

std::vector<Rgb> colors(const json& list) {
  std::vector<Rgb> result;
  for (const json& c : list) result.emplace_back(c[0].get<double>(), c[1].get<double>(), c[2].get<double>());
  return result;
}

}  // namespace

std::optional<std::filesystem::path> shared_folder() {
  const char* named = std::getenv("RELUME_SHARED_DIR");
  const std::filesystem::path folder = named != nullptr ? named : RELUME_SOURCE_DIR "/../shared";
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return folder;
}

RoomTruth read_room_truth(const std::filesystem::path& file) {
  const json data = read_json(file);
  RoomTruth truth;
  truth.surface = data.at("surface").get<std::vector<std::string>>();
  if (data.contains("room")) truth.room = data.at("room").get<std::vector<std::string>>();
  truth.punctual = colors(data.at("E_punctual"));
  truth.emitted = colors(data.at("E_emitted"));
  truth.standard_error = colors(data.at("se_total"));
  truth.indirect = colors(data.at("E_total"));
  for (std::size_t i = 0; i < truth.indirect.size(); ++i) truth.indirect[i] -= truth.punctual[i];
  return truth;
}

ProbeTruth read_probe_truth(const std::filesystem::path& file) {
  const json data = read_json(file);
  ProbeTruth truth;
  for (const json& p : data.at("position"))
    truth.points.push_back({std::to_string(truth.points.size()), {p[0], p[1], p[2]}});
  for (const json& probe : data.at("sh_radiance")) {
    const std::vector<Rgb> values = colors(probe);
    std::copy_n(values.begin(), kProbeHarmonics, truth.coefficients.emplace_back().begin());
  }
  return truth;
}

std::vector<SensorPoint> read_sensors(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) throw std::runtime_error(file.string() + ": cannot be read");
  std::vector<SensorPoint> sensors;
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    SensorPoint sensor;
    glm::dvec3 &p = sensor.position, &n = sensor.normal;
    if (fields >> sensor.name >> p.x >> p.y >> p.z >> n.x >> n.y >> n.z) sensors.push_back(sensor);
  }
  return sensors;
}

std::vector<FactorTruth> read_factor_truth(const std::filesystem::path& file) {
  std::vector<FactorTruth> cases;
  const json data = read_json(file);
  for (const json& item : data.at("cases")) {
    FactorTruth one;
    one.name = item.at("case").get<std::string>();
    one.mesh = item.at("mesh").get<std::string>();
    one.closed_rows = item.at("closed_rows").get<std::vector<std::string>>();
    for (const json& f : item.at("F")) {
      one.pairs.push_back(
          {f.at("from").get<std::string>(), f.at("to").get<std::string>(), f.at("value").get<double>()});
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

}  // namespace relume::test
