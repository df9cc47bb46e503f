// SPDX-License-Identifier: MIT
#include "tool/option_kinds.h"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace relume {
std::size_t choose(const std::string& name, const std::vector<std::string>& words, const std::string& text) {
  const auto word = std::find(words.begin(), words.end(), text);
  if (word != words.end()) return static_cast<std::size_t>(word - words.begin());
  throw CLI::ValidationError(name, fmt::format("expected {}, found '{}'", fmt::join(words, " or "), text));
}

std::optional<double> parse_number(const std::string& text) {
  double number = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return {};
  return number;
}

std::optional<double> parse_share(const std::string& text) {
  if (!text.ends_with('%')) return parse_number(text);
  const std::optional<double> percent = parse_number(text.substr(0, text.size() - 1));
  return percent ? std::optional(*percent / 100.0) : std::nullopt;
}

std::optional<double> parse_bytes(const std::string& text) {
  constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
  if (unit == std::string_view::npos) return parse_number(text);
  const std::optional<double> number = parse_number(text.substr(0, text.size() - 1));
  return number ? std::optional(std::floor(*number * std::pow(1000.0, double(unit + 1)))) : std::nullopt;
}

CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& metavar, const Take& take,
                      const std::string& help) {
  return app.add_option_function<std::string>(name, take, help)->type_name(metavar);
}

CLI::Option* add_choice(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                        const std::function<void(std::size_t)>& take, const std::string& help) {
  const auto choose_one = [name, words, take](const std::string& text) { take(choose(name, words, text)); };
  return add_text(app, name, fmt::format("{}", fmt::join(words, "|")), choose_one, help);
}

}  // namespace relume
