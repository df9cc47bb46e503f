// SPDX-License-Identifier: MIT
#include "tool/sensors_csv.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <unordered_set>

#include "tool/text_file.h"

namespace relume {
namespace {

constexpr std::array<std::string_view, 7> kColumns{"id", "px", "py", "pz", "nx", "ny", "nz"};
using ColumnOrder = std::array<std::size_t, kColumns.size()>;  ///< where each of kColumns stands in a line

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

class SensorReader {
 public:
  explicit SensorReader(std::string file) : file_(std::move(file)) {}

  Result<void> read_header(std::string_view line) {
    const std::vector<std::string_view> names = split(line, ',');
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      const auto found = std::find(names.begin(), names.end(), kColumns[c]);
      if (found == names.end()) return error(1, "the header id,px,py,pz,nx,ny,nz", line);
      order_[c] = static_cast<std::size_t>(found - names.begin());
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
      return error(number, "an id that no other sensor has", sensor.name);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view position = cells[order_[1 + axis]];
      const std::string_view normal = cells[order_[4 + axis]];
      if (!to_number(position, sensor.position[axis])) return error(number, "a number", position);
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

  std::string file_;
  ColumnOrder order_{};
  std::size_t width_ = 0;
  std::unordered_set<std::string> names_;
};

}  // namespace

Result<std::vector<SensorPoint>> read_sensors(const std::filesystem::path& file) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  std::string_view rest = *text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  const std::vector<std::string_view> lines = split(rest, '\n');
  SensorReader reader(file.string());
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

}  // namespace relume
