// SPDX-License-Identifier: MIT
#include "tool/leak_report.h"

#include <fmt/format.h>

#include "tool/model_summary.h"

namespace relume {
namespace {

constexpr std::size_t kWorst = 10;

const char* kind_name(LeakReceiver kind) {
  return kind == LeakReceiver::lumel ? "lumel" : "cluster";
}

std::string summary_line(const LeakSummary& summary, const char* kind) {
  return fmt::format("{}: walled {:.2g} mean, {:.2g} worst; hidden {:.2g} mean, {:.2g} worst",
                     counted(summary.rows, kind), summary.mean_walled, summary.largest_walled,
                     summary.mean_hidden, summary.largest_hidden);
}

std::string place_text(const glm::dvec3& place) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", place.x, place.y, place.z);
}

void append_worst(const Model& model, const LeakReport& report, double RowLeak::*what, const char* name,
                  std::vector<std::string>& lines) {
  const std::vector<RowLeak> worst = worst_leaks(report, what, kWorst);
  if (!worst.empty()) lines.push_back(fmt::format("worst {}:", name));
  for (const RowLeak& row : worst) {
    lines.push_back(fmt::format("  {:.2g} at {} on {} ({} {} of {}), most from {} on {}", row.*what,
                                place_text(row.place), model.nodes[row.node].path, kind_name(row.kind),
                                row.index, model.systems[row.system].name, place_text(row.sender_place),
                                model.nodes[row.sender_node].path));
  }
}

JsonObject summary_json(const LeakSummary& summary) {
  return {{"rows", summary.rows},
          {"mean_walled", summary.mean_walled},
          {"largest_walled", summary.largest_walled},
          {"mean_hidden", summary.mean_hidden},
          {"largest_hidden", summary.largest_hidden}};
}

JsonArray worst_json(const Model& model, const LeakReport& report, double RowLeak::*what) {
  JsonArray rows;
  for (const RowLeak& row : worst_leaks(report, what, kWorst)) {
    rows.emplace_back(JsonObject{{"walled", row.walled},
                                 {"hidden", row.hidden},
                                 {"kind", kind_name(row.kind)},
                                 {"system", model.systems[row.system].name},
                                 {"index", row.index},
                                 {"node", model.nodes[row.node].path},
                                 {"place", row.place},
                                 {"sender_system", model.systems[row.sender.system].name},
                                 {"sender_cluster", row.sender.index},
                                 {"sender_node", model.nodes[row.sender_node].path},
                                 {"sender_place", row.sender_place}});
  }
  return rows;
}

}  // namespace

std::vector<std::string> leak_lines(const Model& model, const LeakReport& report) {
  std::vector<std::string> lines{
      "light from where rows cannot see, in shares of their hemisphere (walled: behind a wall, hidden: "
      "around "
      "a corner too):",
      "  " + summary_line(report.lumels, "lumel"), "  " + summary_line(report.clusters, "cluster")};
  append_worst(model, report, &RowLeak::walled, "walled", lines);
  append_worst(model, report, &RowLeak::hidden, "hidden", lines);
  return lines;
}

JsonObject leaks_json(const Model& model, const LeakReport& report) {
  return {{"lumels", summary_json(report.lumels)},
          {"clusters", summary_json(report.clusters)},
          {"worst_walled", worst_json(model, report, &RowLeak::walled)},
          {"worst_hidden", worst_json(model, report, &RowLeak::hidden)}};
}

}  // namespace relume
