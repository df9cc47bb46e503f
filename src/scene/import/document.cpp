// SPDX-License-Identifier: MIT
#include "scene/import/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <nlohmann/json.hpp>
#include <string_view>

#include "scene/import/import_error.h"
#include "scene/import/rules.h"
#include "scene/import/structure.h"

namespace relume {
namespace {

using Json = nlohmann::json;

constexpr auto kSupportedExtensions = std::to_array<std::string_view>({
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
});

bool is_supported(std::string_view extension) {
  return std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), extension) !=
         kSupportedExtensions.end();
}

/// "[json.exception.parse_error.101] parse error at ..." without the bracket.
std::string readable(std::string_view what) {
  const auto bracket = what.find("] ");
  std::string text(bracket == std::string_view::npos ? what : what.substr(bracket + 2));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

Result<Json> parse(const GltfContainer& container, const std::string& file) {
  try {
    return Json::parse(container.json.begin(), container.json.end());
  } catch (const Json::parse_error& error) {
    return import_error(file, fmt::format("byte {}", container.json_offset + error.byte), "JSON",
                        readable(error.what()));
  } catch (const Json::exception& error) {
    return import_error(file, fmt::format("byte {}", container.json_offset), "JSON", readable(error.what()));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, fmt::format("{}: no memory to parse its JSON", file));
  }
}

/// Major version 2 is promised to be compatible upwards; minVersion says what a reader must know.
Result<void> check_version(const Json& asset, const std::string& file) {
  const auto& version = asset["version"].get_ref<const std::string&>();
  if (version.substr(0, 2) != "2.") {
    return import_error(file, "/asset/version", "a version 2 of glTF", fmt::format("\"{}\"", version));
  }
  const std::string needed = asset.value("minVersion", std::string("2.0"));
  if (needed != "2.0") {
    return import_error(file, "/asset/minVersion", "\"2.0\", the version that is read",
                        fmt::format("\"{}\"", needed));
  }
  return {};
}

Result<void> check_extensions(const Json& document, const std::string& file,
                              std::vector<std::string>& warnings) {
  if (const auto needed = document.find("extensionsRequired"); needed != document.end()) {
    for (std::size_t i = 0; i < needed->size(); ++i) {
      const auto& name = (*needed)[i].get_ref<const std::string&>();
      if (is_supported(name)) continue;
      return import_error(file, json_path("extensionsRequired", i), "an extension that Relume reads",
                          fmt::format("\"{}\"", name.substr(0, 200)));
    }
  }
  if (const auto used = document.find("extensionsUsed"); used != document.end()) {
    for (const Json& extension : *used) {
      const auto& name = extension.get_ref<const std::string&>();
      if (!is_supported(name)) {
        warnings.push_back(fmt::format("{}: the extension {} is not read", file, name.substr(0, 200)));
      }
    }
  }
  return {};
}

}  // namespace

Result<Json> parse_document(const GltfContainer& container, const SceneLimits& limits,
                            const std::string& file, std::vector<std::string>& warnings) {
  if (container.json.size() > limits.max_json_bytes) {
    return import_error(file, fmt::format("byte {}", container.json_offset),
                        fmt::format("at most {} bytes of JSON", limits.max_json_bytes),
                        fmt::format("{}", container.json.size()));
  }
  if (auto result = check_json_depth(container, limits.max_json_depth, file); !result) {
    return tl::unexpected(result.error());
  }
  auto document = parse(container, file);
  if (!document) return document;
  auto result = check_rules(*document, file);
  if (result) result = check_version((*document)["asset"], file);
  if (result) result = check_extensions(*document, file, warnings);
  if (result) result = check_ranges(*document, file);
  if (result) result = check_primitives(*document, file);
  if (result) result = check_variants(*document, file);
  if (result) result = check_node_forest(*document, file);
  if (!result) return tl::unexpected(result.error());
  return document;
}

}  // namespace relume
