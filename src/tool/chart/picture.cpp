// SPDX-License-Identifier: MIT
#include "tool/chart/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "tool/chart/axis_scale.h"
#include "tool/chart/label_places.h"

namespace relume {
namespace {

constexpr double kWidth = 960.0, kHeight = 600.0;
constexpr PixelBox kPlot{76.0, 52.0, 716.0, 536.0};
constexpr double kMarkSize = 5.0, kFont = 12.0, kSmallFont = 11.0, kLegendLeft = 734.0, kLegendLine = 19.0;

/// Okabe and Ito's, without the yellow that white paper swallows.
constexpr std::array kColors{"#000000", "#e69f00", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9"};

/// Outlines of radius about 1 around (0, 0).
constexpr std::array kShapes{"M-1 0A1 1 0 1 1 1 0A1 1 0 1 1 -1 0Z",                 // circle
                             "M-.9-.9H.9V.9H-.9Z",                                  // square
                             "M0-1.15L1.1 .85H-1.1Z",                               // triangle
                             "M0-1.3L1.2 0L0 1.3L-1.2 0Z",                          // diamond
                             "M0 1.15L1.1-.85H-1.1Z",                               // triangle, tip down
                             "M-.4-1.1H.4V-.4H1.1V.4H.4V1.1H-.4V.4H-1.1V-.4H-.4Z",  // plus
                             "M0-1.2L1.15-.35L.7 1H-.7L-1.15-.35Z",                 // pentagon
                             "M-1.1-1L1.1-1L-1.1 1L1.1 1Z"};                        // hourglass
constexpr const char* kCross = "M-1-1L1 1M-1 1L1-1";
constexpr std::array kDashes{"", "6 3", "2 3"};

/// How a series looks.
struct Look {
  std::string color, shape, dash;
  bool hollow = false;
};

Look look_of(std::size_t series) {
  return {kColors[series % kColors.size()], kShapes[series % kShapes.size()],
          kDashes[series / kColors.size() % kDashes.size()], series >= kColors.size()};
}

std::string glyph(const std::string& outline, double x, double y, double size, const std::string& fill,
                  const std::string& stroke, double width) {
  return fmt::format(
      R"svg(<path transform="translate({:.1f} {:.1f}) scale({})" d="{}" fill="{}" stroke="{}" stroke-width="{:.2f}"/>)svg",
      x, y, size, outline, fill, stroke, width / size);
}

std::string mark(const Look& look, double x, double y) {
  if (look.hollow) return glyph(look.shape, x, y, kMarkSize, "#fff", look.color, 1.8);
  return glyph(look.shape, x, y, kMarkSize, look.color, "#fff", 0.8);
}

std::string cross(const std::string& color, double x, double y) {
  return glyph(kCross, x, y, kMarkSize, "none", color, 2.0);
}

std::string ring(double x, double y) {
  return fmt::format(
      R"(<circle cx="{:.1f}" cy="{:.1f}" r="10" fill="none" stroke="#000" stroke-width="1.6"/>)", x, y);
}

std::string text_at(double x, double y, const std::string& text, const std::string& attributes) {
  if (text.empty()) return "";
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" {}>{}</text>)", x, y, attributes, escaped(text)) + "\n";
}

std::string line(double x1, double y1, double x2, double y2, const std::string& attributes) {
  return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)", x1, y1, x2, y2,
                     attributes) +
         "\n";
}

std::vector<double> values_on(const ChartPicture& chart, bool of_x) {
  std::vector<double> values;
  for (const ChartSeries& series : chart.series) {
    for (const ChartPoint& point : series.points) values.push_back(of_x ? point.x : point.y);
  }
  if (chart.level && !of_x) values.push_back(chart.level->y);
  return values;
}

/// A text in lines of at most so many pixels.
std::vector<std::string> wrapped(const std::string& text, double width) {
  std::vector<std::string> lines{""};
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (!lines.back().empty() && text_width(longer, kFont) > width)
      lines.push_back(word);
    else
      lines.back() = longer;
    begin = end + 1;
  }
  return lines;
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::string grid_stroke(const AxisTick& tick) {
  return tick.text.empty() ? R"(stroke="#f0f0f0")" : R"(stroke="#d8d8d8")";
}

class Drawing {
 public:
  explicit Drawing(const ChartPicture& chart)
      : chart_(chart),
        x_(chart.x, values_on(chart, true)),
        y_(chart.y, values_on(chart, false)),
        labels_(kPlot) {}

  std::string svg() {
    begin();
    draw_grid();
    draw_front();
    draw_lines();
    draw_points();
    draw_labels();
    draw_legend();
    return svg_ + "</svg>\n";
  }

 private:
  double pixel_x(double value) const { return kPlot.left + x_.place(value) * (kPlot.right - kPlot.left); }
  double pixel_y(double value) const { return kPlot.bottom - y_.place(value) * (kPlot.bottom - kPlot.top); }
  bool shows(const ChartPoint& point) const { return x_.shows(point.x) && y_.shows(point.y); }

  void begin() {
    svg_ = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" role="img" font-family="Helvetica, Arial, 'Liberation Sans', sans-serif" font-size="{2}">)",
        kWidth, kHeight, kFont);
    svg_ += "\n<title>" + escaped(chart_.title) + "</title>\n";
    svg_ += fmt::format(R"(<rect width="{}" height="{}" fill="#fff"/>)", kWidth, kHeight) + "\n";
    svg_ += text_at(kPlot.left, 30.0, chart_.title, R"(font-size="16" font-weight="bold")");
  }

  void draw_grid() {
    std::size_t lines = 1;
    for (const AxisTick& tick : x_.ticks()) {
      const double x = pixel_x(tick.value);
      svg_ += line(x, kPlot.top, x, kPlot.bottom, grid_stroke(tick));
      const std::vector<std::string> parts = split_lines(tick.text);
      for (std::size_t i = 0; i < parts.size(); ++i)
        svg_ += text_at(x, kPlot.bottom + 17.0 + 14.0 * double(i), parts[i], R"(text-anchor="middle")");
      lines = std::max(lines, parts.size());
    }
    for (const AxisTick& tick : y_.ticks()) {
      const double y = pixel_y(tick.value);
      svg_ += line(kPlot.left, y, kPlot.right, y, grid_stroke(tick));
      svg_ += text_at(kPlot.left - 7.0, y + 4.0, tick.text, R"(text-anchor="end")");
    }
    svg_ += fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="#444"/>)",
                        kPlot.left, kPlot.top, kPlot.right - kPlot.left, kPlot.bottom - kPlot.top) +
            "\n";
    name_axes(kPlot.bottom + (lines > 1 ? 16.0 + 14.0 * double(lines) : 42.0));
    if (chart_.level) draw_level(*chart_.level);
  }

  void name_axes(double bottom) {
    svg_ += text_at(0.5 * (kPlot.left + kPlot.right), bottom, chart_.x.label, R"(text-anchor="middle")");
    const double middle = 0.5 * (kPlot.top + kPlot.bottom);
    svg_ += text_at(20.0, middle, chart_.y.label,
                    fmt::format(R"svg(text-anchor="middle" transform="rotate(-90 20 {})")svg", middle));
  }

  void draw_level(const ChartLevel& level) {
    const double y = pixel_y(level.y), width = text_width(level.name, kSmallFont);
    svg_ += line(kPlot.left, y, kPlot.right, y, R"(stroke="#666" stroke-dasharray="8 4")");
    labels_.occupy({kPlot.right - width - 4.0, y - 16.0, kPlot.right, y});
    svg_ += text_at(
        kPlot.right - 5.0, y - 5.0, level.name,
        fmt::format(
            R"(text-anchor="end" font-size="{}" fill="#444" stroke="#fff" stroke-width="3" paint-order="stroke")",
            kSmallFont));
  }

  /// Nothing between two points of the front is reached: it goes by steps. Labels keep off it.
  void draw_front() {
    std::string path;
    double x = 0.0, y = 0.0;
    for (const auto& [value_x, value_y] : chart_.front) {
      const double next_x = pixel_x(value_x), next_y = pixel_y(value_y);
      path += path.empty() ? fmt::format("M{:.1f} {:.1f}", next_x, next_y)
                           : fmt::format("H{:.1f}V{:.1f}", next_x, next_y);
      if (&value_x != &chart_.front.front().first) {
        labels_.occupy({x, y - 3.0, next_x, y + 3.0});
        labels_.occupy({next_x - 3.0, y, next_x + 3.0, next_y});
      }
      x = next_x, y = next_y;
    }
    if (path.empty()) return;
    svg_ +=
        fmt::format(R"(<path d="{}" fill="none" stroke="#bbb" stroke-width="5" stroke-linejoin="round"/>)",
                    path) +
        "\n";
  }

  void draw_lines() {
    for (std::size_t s = 0; s < chart_.series.size(); ++s) {
      if (!chart_.series[s].joined) continue;
      std::string places;
      for (const ChartPoint& point : chart_.series[s].points) {
        if (shows(point) && !point.failed)
          places += fmt::format("{:.1f},{:.1f} ", pixel_x(point.x), pixel_y(point.y));
      }
      if (places.empty()) continue;
      const Look look = look_of(s);
      svg_ +=
          fmt::format(
              R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.4" stroke-dasharray="{}"/>)",
              places, look.color, look.dash.empty() ? "none" : look.dash) +
          "\n";
    }
  }

  void draw_points() {
    for (std::size_t s = 0; s < chart_.series.size(); ++s) {
      const Look look = look_of(s);
      for (const ChartPoint& point : chart_.series[s].points) {
        if (!shows(point)) continue;
        const double x = pixel_x(point.x), y = pixel_y(point.y);
        svg_ += fmt::format(R"(<g class="point"><title>{}</title>)", escaped(point.hover));
        svg_ += point.failed ? cross(look.color, x, y) : mark(look, x, y);
        svg_ += (point.chosen ? ring(x, y) : "") + "</g>\n";
        const double half = point.chosen ? 10.0 : 6.0;
        labels_.occupy({x - half, y - half, x + half, y + half});
      }
    }
  }

  void draw_labels() {
    for (const bool chosen : {true, false}) {
      for (std::size_t s = 0; s < chart_.series.size(); ++s) {
        for (const ChartPoint& point : chart_.series[s].points) {
          if (point.chosen == chosen && !point.label.empty() && shows(point))
            draw_label(point, look_of(s).color);
        }
      }
    }
  }

  void draw_label(const ChartPoint& point, const std::string& color) {
    const auto box = labels_.place(pixel_x(point.x), pixel_y(point.y), point.label, kSmallFont);
    if (!box) return;
    const std::string weight = point.chosen ? R"( font-weight="bold")" : "";
    svg_ += text_at(
        0.5 * (box->left + box->right), box->bottom - 3.0, point.label,
        fmt::format(
            R"(class="label" text-anchor="middle" font-size="{}" fill="{}"{} stroke="#fff" stroke-width="3" paint-order="stroke")",
            kSmallFont, color == "#56b4e9" || color == "#e69f00" ? "#333" : color, weight));
  }

  void draw_legend() {
    double y = kPlot.top + 10.0;
    const auto write = [&](const std::string& name) {
      for (const std::string& part : wrapped(name, kWidth - kLegendLeft - 34.0)) {
        svg_ += text_at(kLegendLeft + 28.0, y + 4.0, part, "");
        y += kLegendLine - 4.0;
      }
      y += 4.0;
    };
    for (std::size_t s = 0; s < chart_.series.size(); ++s) {
      const Look look = look_of(s);
      if (chart_.series[s].joined)
        svg_ += line(kLegendLeft, y, kLegendLeft + 22.0, y,
                     fmt::format(R"(stroke="{}" stroke-width="1.4" stroke-dasharray="{}")", look.color,
                                 look.dash.empty() ? "none" : look.dash));
      svg_ += mark(look, kLegendLeft + 11.0, y) + "\n";
      write(chart_.series[s].name);
    }
    y += 6.0;
    if (!chart_.front.empty()) {
      svg_ += line(kLegendLeft, y, kLegendLeft + 22.0, y, R"(stroke="#bbb" stroke-width="5")");
      write("Pareto front");
    }
    if (any([](const ChartPoint& point) { return point.failed; })) {
      svg_ += cross("#444", kLegendLeft + 11.0, y) + "\n";
      write("fails: hover says how");
    }
  }

  template <class Wanted>
  bool any(const Wanted& wanted) const {
    return std::any_of(chart_.series.begin(), chart_.series.end(), [&](const ChartSeries& series) {
      return std::any_of(series.points.begin(), series.points.end(), wanted);
    });
  }

  const ChartPicture& chart_;
  AxisScale x_, y_;
  LabelPlaces labels_;
  std::string svg_;
};

}  // namespace

std::string to_svg(const ChartPicture& chart) {
  return Drawing(chart).svg();
}

std::vector<std::pair<double, double>> pareto_front(const std::vector<ChartSeries>& series) {
  std::vector<std::pair<double, double>> all, front;
  for (const ChartSeries& one : series) {
    for (const ChartPoint& point : one.points) {
      if (!point.failed) all.emplace_back(point.x, point.y);
    }
  }
  std::sort(all.begin(), all.end());
  double least = std::numeric_limits<double>::infinity();
  for (const auto& point : all) {
    if (point.second >= least) continue;
    least = point.second;
    front.push_back(point);
  }
  return front;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

}  // namespace relume
