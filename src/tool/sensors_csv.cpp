// SPDX-License-Identifier: MIT
#include "tool/sensors_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_set>

#include "tool/text_file.h"

namespace relume {
namespace {

constexpr std::array<std::string_view, 7> kSensorColumns{"id", "px", "py", "pz", "nx", "ny", "nz"};
constexpr std::size_t kProbeColumns = 4;  ///< the first of them

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    parts.push_back(trimmed(text.substr(start, end - start)));
    start = end + 1;
  }
  return parts;
}

/// Of sensors, or of probes, which have no normal.
class PointReader {
 public:
  PointReader(std::string file, std::string noun, std::size_t columns)
      : file_(std::move(file)), noun_(std::move(noun)), columns_(std::span(kSensorColumns).first(columns)) {}

  Result<void> read_header(std::string_view line) {
    const std::vector<std::string_view> names = split(line, ',');
    for (const std::string_view column : columns_) {
      const auto found = std::find(names.begin(), names.end(), column);
      if (found == names.end()) return error(1, fmt::format("the header {}", fmt::join(columns_, ",")), line);
      order_.push_back(static_cast<std::size_t>(found - names.begin()));
    }
    width_ = names.size();
    return {};
  }

  Result<SensorPoint> read_line(std::size_t number, std::string_view line) {
    const std::vector<std::string_view> cells = split(line, ',');
    if (cells.size() != width_)
      return error(number, fmt::format("{} cells", width_), fmt::format("{}", cells.size()));
    SensorPoint sensor;
    sensor.name = cells[order_[0]];
    if (sensor.name.empty() || sensor.name.find('"') != std::string::npos) {
      return error(number, "an id without quotes", sensor.name.empty() ? "none" : sensor.name);
    }
    if (!names_.insert(sensor.name).second)
      return error(number, fmt::format("an id that no other {} has", noun_), sensor.name);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view position = cells[order_[1 + axis]];
      if (!to_number(position, sensor.position[axis])) return error(number, "a number", position);
      if (columns_.size() == kProbeColumns) continue;
      const std::string_view normal = cells[order_[4 + axis]];
      if (!to_number(normal, sensor.normal[axis])) return error(number, "a number", normal);
    }
    if (sensor.normal == glm::dvec3(0.0)) return error(number, "a normal that is not zero", "0,0,0");
    return sensor;
  }

 private:
  static bool to_number(std::string_view text, double& value) {
    constexpr double kFarthest = 1e12;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc() && end == text.data() + text.size() && std::abs(value) <= kFarthest;
  }

  tl::unexpected<Error> error(std::size_t number, std::string_view expected, std::string_view found) const {
    return fail(ErrorCode::bad_input, fmt::format("{}: line {}: expected {}, found '{}'.", file_, number,
                                                  expected, found.substr(0, 60)));
  }

  std::string file_, noun_;
  std::span<const std::string_view> columns_;
  std::vector<std::size_t> order_;  ///< where each of them stands in a line
  std::size_t width_ = 0;
  std::unordered_set<std::string> names_;
};

Result<std::vector<SensorPoint>> read_points(const std::filesystem::path& file, const std::string& noun,
                                             std::size_t columns) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  std::string_view rest = *text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  const std::vector<std::string_view> lines = split(rest, '\n');
  PointReader reader(file.string(), noun, columns);
  if (const Result<void> header = reader.read_header(lines[0]); !header)
    return tl::unexpected(header.error());
  std::vector<SensorPoint> sensors;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    Result<SensorPoint> sensor = reader.read_line(i + 1, lines[i]);
    if (!sensor) return tl::unexpected(sensor.error());
    sensors.push_back(std::move(*sensor));
  }
  return sensors;
}

}  // namespace

Result<std::vector<SensorPoint>> read_sensors(const std::filesystem::path& file) {
  return read_points(file, "sensor", kSensorColumns.size());
}

Result<std::vector<ProbePoint>> read_probes(const std::filesystem::path& file) {
  auto points = read_points(file, "probe", kProbeColumns);
  if (!points) return tl::unexpected(points.error());
  std::vector<ProbePoint> probes;
  for (SensorPoint& point : *points) probes.push_back({std::move(point.name), point.position});
  return probes;
}

}  // namespace relume
