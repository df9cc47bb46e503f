// SPDX-License-Identifier: MIT
#include "tool/chart/page.h"

#include <fmt/format.h>

namespace relume {
namespace {

constexpr const char* kStyle = R"(
body { font-family: Helvetica, Arial, 'Liberation Sans', sans-serif; max-width: 980px; margin: 1.5em auto; padding: 0 1em; color: #111; background: #fff; line-height: 1.45; }
h1 { font-size: 1.5em; } figure { margin: 2em 0; break-inside: avoid; }
svg { max-width: 100%; height: auto; } figcaption { max-width: 75ch; }
table { border-collapse: collapse; font-size: 0.9em; } td { padding: 0.1em 1em 0.1em 0; vertical-align: top; }
g.point:hover { stroke: #000; }
)";

}  // namespace

std::string chart_page(const std::string& title, const std::vector<ChartAndTable>& charts, const Facts& facts,
                       const std::vector<std::string>& notes) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta "
      "charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n"
      "</head>\n<body>\n<h1>{0}</h1>\n<table>\n",
      escaped(title), kStyle);
  for (const auto& [name, value] : facts)
    page += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escaped(name), escaped(value));
  page += "</table>\n";
  for (const ChartAndTable& one : charts) {
    page += fmt::format("<figure>\n{}<figcaption>{} Numbers: {}.csv.</figcaption>\n</figure>\n",
                        to_svg(one.chart), escaped(one.chart.text), escaped(one.chart.name));
  }
  if (!notes.empty()) page += "<h2>What could not be measured</h2>\n<ul>\n";
  for (const std::string& note : notes) page += "<li>" + escaped(note) + "</li>\n";
  if (!notes.empty()) page += "</ul>\n";
  return page + "</body>\n</html>\n";
}

}  // namespace relume
