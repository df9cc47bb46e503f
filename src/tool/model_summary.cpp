// SPDX-License-Identifier: MIT
#include "tool/model_summary.h"

#include <fmt/format.h>

#include <algorithm>

namespace relume {

std::string counted(std::uint64_t count, std::string_view noun) {
  const std::string_view ending = count == 1 ? "" : noun.ends_with("ch") ? "es" : "s";
  return fmt::format("{} {}{}", count, noun, ending);
}

namespace {

void add(MatrixSummary& total, const MatrixSummary& part) {
  total.rows += part.rows;
  total.nonzeros += part.nonzeros;
  total.bytes += part.bytes;
  total.max_row_sum = std::max(total.max_row_sum, part.max_row_sum);
}

JsonObject matrix_json(const MatrixSummary& matrix) {
  return {{"rows", matrix.rows},
          {"columns", matrix.columns},
          {"nonzeros", matrix.nonzeros},
          {"max_row_sum", matrix.max_row_sum},
          {"bytes", matrix.bytes}};
}

JsonObject system_json(const System& system, const MatrixSummary& bounce, const MatrixSummary& gather) {
  return {{"name", system.name},
          {"clusters", system.clusters.size()},
          {"lumels", system.lumels.size()},
          {"sensors", system.sensors.size()},
          {"tree_nodes", system.tree.nodes.size()},
          {"imports", system.imports.size()},
          {"lightmap", JsonArray{system.lightmap_width, system.lightmap_height}},
          {"bounce", matrix_json(bounce)},
          {"gather", matrix_json(gather)}};
}

std::string matrix_line(const char* name, const MatrixSummary& matrix) {
  return fmt::format("{} {} x {}, {} form factors, {:.1f} MB, largest row sum {:.6f}", name, matrix.rows,
                     matrix.columns, matrix.nonzeros, 1e-6 * static_cast<double>(matrix.bytes),
                     matrix.max_row_sum);
}

}  // namespace

ModelSummary summarise_model(const Model& model) {
  ModelSummary summary;
  summary.geometry_hash = model.geometry_hash;
  summary.sky_patches = model.sky_cells.size();
  summary.occluder_triangles = model.occluders.triangles.size();
  summary.lit_by_rig = model.lit_by_rig;
  for (const System& system : model.systems) {
    const MatrixSummary bounce = summarise(system.bounce);
    const MatrixSummary gather = summarise(system.gather);
    add(summary.bounce, bounce);
    add(summary.gather, gather);
    summary.clusters += system.clusters.size();
    summary.tree_nodes += system.tree.nodes.size();
    summary.imports += system.imports.size();
    summary.lumels += system.lumels.size();
    summary.sensors += system.sensors.size();
    summary.probes += system.probes.size();
    summary.probe_entries += system.probe_senders.size();
    for (const Cluster& cluster : system.clusters) summary.area += cluster.area;
    for (const Lumel& lumel : system.lumels) summary.invalid_lumels += (lumel.flags & kLumelInvalid) != 0;
    summary.systems.push_back(system_json(system, bounce, gather));
  }
  summary.probe_cells = model.probe_volume.cells.size();
  summary.tree_nodes += model.sky_tree.nodes.size() + model.top_tree.size();
  summary.spanning_nodes = model.top_tree.size();
  summary.options = model.provenance.options;
  summary.bounce.columns =
      static_cast<std::uint32_t>(summary.clusters + summary.sky_patches + summary.tree_nodes);
  summary.gather.columns = summary.bounce.columns;
  return summary;
}

std::vector<std::string> summary_lines(const ModelSummary& summary) {
  return {fmt::format("{}, {}, {}, {}, {}, {}, {:.6g} m2, {}", counted(summary.systems.size(), "system"),
                      counted(summary.clusters, "cluster"), counted(summary.lumels, "lumel"),
                      counted(summary.sensors, "sensor"), counted(summary.probes, "probe"),
                      counted(summary.sky_patches, "sky patch"), summary.area,
                      counted(summary.occluder_triangles, "triangle")),
          fmt::format("{}, {}; asked for {}", counted(summary.tree_nodes, "tree node"),
                      counted(summary.imports, "import"), summary.options),
          matrix_line("bounce", summary.bounce), matrix_line("gather", summary.gather)};
}

std::vector<std::string> system_lines(const Model& model) {
  std::vector<std::string> lines;
  for (const System& system : model.systems) {
    if (model.systems.size() < 2) break;
    MatrixSummary both = summarise(system.bounce);
    add(both, summarise(system.gather));
    lines.push_back(fmt::format("{}: {} + {} rows, {}, {} form factors, {:.1f} MB", system.name,
                                system.clusters.size(), system.lumels.size() + system.sensors.size(),
                                counted(system.imports.size(), "import"), both.nonzeros,
                                1e-6 * static_cast<double>(both.bytes)));
  }
  return lines;
}

JsonObject summary_json(const ModelSummary& summary, std::uint64_t file_bytes) {
  return {{"systems", summary.systems.size()},
          {"clusters", summary.clusters},
          {"lumels", summary.lumels},
          {"invalid_lumels", summary.invalid_lumels},
          {"sensors", summary.sensors},
          {"probes", summary.probes},
          {"probe_entries", summary.probe_entries},
          {"probe_cells", summary.probe_cells},
          {"sky_patches", summary.sky_patches},
          {"tree_nodes", summary.tree_nodes},
          {"spanning_nodes", summary.spanning_nodes},
          {"imports", summary.imports},
          {"options", summary.options},
          {"area", summary.area},
          {"occluder_triangles", summary.occluder_triangles},
          {"bounce", matrix_json(summary.bounce)},
          {"gather", matrix_json(summary.gather)},
          {"file_bytes", file_bytes},
          {"geometry_hash", fmt::format("{:016x}", summary.geometry_hash)},
          {"lit_by_rig", summary.lit_by_rig},
          {"system_list", json_array(summary.systems)}};
}

std::string rig_sentence(const Model& model) {
  if (model.sky_radiance) {
    return fmt::format("The scene shines with nothing: lit by the stated rig, a sky of {:.0f} cd/m2 and {}.",
                       model.sky_radiance->x, counted(model.lights.size(), "light"));
  }
  return fmt::format(
      "The scene shines with nothing: lit by the stated rig, {} of 1000 cd under the ceilings.",
      counted(model.lights.size(), "point light"));
}

}  // namespace relume
