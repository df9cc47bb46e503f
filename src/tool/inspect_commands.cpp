// SPDX-License-Identifier: MIT
#include "tool/inspect_commands.h"

#include <fmt/format.h>

#include "core/model_file.h"
#include "tool/leak_report.h"
#include "tool/model_summary.h"
#include "tool/named_errors.h"

namespace relume {
namespace {

JsonObject light_counts(const Model& model) {
  std::uint64_t emitting = 0;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) emitting += cluster.exitance != std::array<float, 3>{};
  }
  return {{"punctual_lights", model.lights.size()},
          {"emitting_clusters", emitting},
          {"sky_radiance", model.sky_radiance ? JsonValue(*model.sky_radiance) : JsonValue()}};
}

JsonArray material_list(const Model& model) {
  JsonArray materials;
  for (const MaterialRecord& material : model.materials) {
    materials.emplace_back(JsonObject{{"name", material.name},
                                      {"double_sided", material.double_sided},
                                      {"possible_emitter", material.possible_emitter}});
  }
  return materials;
}

}  // namespace

Result<int> run(const InfoArguments& arguments, Console& console) {
  const Result<Model> model = read_model(arguments.file);
  if (!model) return tl::unexpected(model.error());
  const std::uint64_t file_bytes = std::filesystem::file_size(arguments.file);
  const ModelSummary summary = summarise_model(*model);
  console.say(fmt::format("{}: {:.1f} MB, geometry {:016x}, from {} by {} ({})", arguments.file.string(),
                          1e-6 * static_cast<double>(file_bytes), model->geometry_hash,
                          model->provenance.scene_file, model->provenance.tool,
                          model->provenance.ray_tracer));
  for (const std::string& line : summary_lines(summary)) console.say("  " + line);
  for (const std::string& line : system_lines(*model)) console.say("  " + line);
  console.say("  " + stored_errors_line(*model));
  console.say(fmt::format(
      "  {}, {}, {}{}", counted(model->materials.size(), "material"), counted(model->nodes.size(), "node"),
      counted(model->lights.size(), "punctual light"), model->lit_by_rig ? " (the stated rig)" : ""));

  JsonObject object{{"file", arguments.file}};
  for (auto& member : summary_json(summary, file_bytes)) object.push_back(std::move(member));
  for (auto& member : light_counts(*model)) object.push_back(std::move(member));
  object.insert(object.end(), {{"errors", stored_errors_json(*model)},
                               {"material_list", material_list(*model)},
                               {"scene_file", model->provenance.scene_file},
                               {"tool", model->provenance.tool},
                               {"ray_tracer", model->provenance.ray_tracer},
                               {"options", model->provenance.options}});
  console.finish(std::move(object));
  return 0;
}

Result<int> run(const CheckArguments& arguments, Console& console) {
  const Result<Model> model = read_model(arguments.file);
  if (!model) return tl::unexpected(model.error());
  const ModelSummary summary = summarise_model(*model);
  const std::vector<std::string> verified{
      "format version, section table, sizes and the checksum of every section",
      fmt::format("{}: {}, their areas, normals, albedos and index ranges",
                  counted(summary.systems.size(), "system"), counted(summary.clusters, "cluster")),
      fmt::format("{} and {}: positions in the lightmaps, elements and pieces",
                  counted(summary.lumels, "lumel"), counted(summary.sensors, "sensor")),
      fmt::format(
          "{} + {} form factors: finite, not negative, columns ascending and in range, row sums up to {:.9f}",
          summary.bounce.nonzeros, summary.gather.nonzeros,
          std::max(summary.bounce.max_row_sum, summary.gather.max_row_sum)),
      fmt::format("{} of cluster trees, {} of them above the systems: ranges, parts and areas",
                  counted(summary.tree_nodes, "node"), summary.spanning_nodes),
      fmt::format("{}, {}, {}", counted(summary.occluder_triangles, "occluder triangle"),
                  counted(model->lights.size(), "light"), counted(summary.sky_patches, "sky patch"))};
  console.say(fmt::format("{}: passed", arguments.file.string()));
  for (const std::string& line : verified) console.say("  " + line);
  JsonObject object{{"file", arguments.file}, {"passed", true}, {"verified", json_array(verified)}};
  if (arguments.leaks) {
    const Result<LeakReport> leaks = measure_leaks(*model);
    if (!leaks) return tl::unexpected(leaks.error());
    for (const std::string& line : leak_lines(*model, *leaks)) console.say("  " + line);
    object.emplace_back("leaks", leaks_json(*model, *leaks));
  }
  console.finish(std::move(object));
  return 0;
}

}  // namespace relume
