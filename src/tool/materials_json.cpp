// SPDX-License-Identifier: MIT
#include "tool/materials_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "tool/json_fields.h"

namespace relume {
namespace {

std::string known_names(const Model& model) {
  constexpr std::size_t kShown = 8;
  std::vector<std::string> names;
  for (const MaterialRecord& material : model.materials) {
    if (names.size() == kShown) {
      names.push_back(fmt::format("... ({} in all)", model.materials.size()));
      break;
    }
    names.push_back(json_name(material.name));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<MaterialOverride> read_override(const Json& json, const std::string& name, const std::string& file,
                                       const Model& model) {
  const std::string path = "/materials/" + json_name(name);
  const auto record = std::find_if(model.materials.begin(), model.materials.end(),
                                   [&](const MaterialRecord& material) { return material.name == name; });
  if (record == model.materials.end()) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: {}: expected a material of the model ({}), found an unknown name.", file,
                            path, known_names(model)));
  }
  JsonFields fields(json, file, path);
  MaterialOverride entry;
  entry.material = static_cast<std::uint32_t>(record - model.materials.begin());
  const Rgb albedo = fields.triple("albedo", Rgb(0.0), {0.0, 1.0});
  const Rgb emission = fields.triple("emission", Rgb(0.0), {});
  if (fields.has("albedo")) entry.albedo = albedo;
  if (fields.has("emission")) entry.emission = emission;
  if (const Result<void> done = fields.finish(); !done) return tl::unexpected(done.error());
  return entry;
}

}  // namespace

Result<std::vector<MaterialOverride>> read_material_overrides(const std::filesystem::path& file,
                                                              const Model& model) {
  const Result<Json> json = read_json_file(file);
  if (!json) return tl::unexpected(json.error());
  JsonFields fields(*json, file.string(), "");
  fields.require("materials");
  const Json& materials = fields.object("materials");
  if (const Result<void> done = fields.finish(); !done) return tl::unexpected(done.error());
  std::vector<MaterialOverride> overrides;
  for (const auto& member : materials.items()) {
    Result<MaterialOverride> entry = read_override(member.value(), member.key(), file.string(), model);
    if (!entry) return tl::unexpected(entry.error());
    overrides.push_back(*entry);
  }
  return overrides;
}

std::uint32_t apply_material_overrides(const Model& model, const std::vector<MaterialOverride>& overrides,
                                       double max_albedo, Lighting& lighting) {
  std::uint32_t clamped = 0;
  for (const MaterialOverride& entry : overrides) {
    if (entry.albedo && glm::any(glm::greaterThan(*entry.albedo, Rgb(max_albedo)))) ++clamped;
    std::size_t row = 0;
    for (const System& system : model.systems) {
      for (const Cluster& cluster : system.clusters) {
        const std::size_t i = row++;
        if (cluster.material != entry.material) continue;
        if (entry.albedo) lighting.albedo[i] = glm::min(*entry.albedo, Rgb(max_albedo));
        if (entry.emission) lighting.exitance[i] = exitance_from_radiance(*entry.emission);
      }
    }
  }
  return clamped;
}

}  // namespace relume
