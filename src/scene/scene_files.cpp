// SPDX-License-Identifier: MIT
#include "scene/scene_files.h"

#include <algorithm>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "scene/import/container.h"
#include "scene/import/scene_folder.h"
#include "scene/load_scene.h"

namespace relume {
namespace {

/// `uri` of each entry of the array `key`.
void append_named(const nlohmann::json& document, const char* key, const std::filesystem::path& file,
                  std::vector<std::filesystem::path>& files) {
  const auto array = document.find(key);
  if (array == document.end() || !array->is_array()) return;
  for (const nlohmann::json& entry : *array) {
    if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
    const auto named = named_file(file, entry["uri"].get_ref<const std::string&>());
    if (named && std::find(files.begin(), files.end(), *named) == files.end()) files.push_back(*named);
  }
}

}  // namespace

std::vector<std::filesystem::path> scene_files(const std::filesystem::path& file) {
  std::vector<std::filesystem::path> files{file};
  try {
    const SceneLimits limits;
    const std::string name = file.filename().string();
    const auto bytes = read_regular_file(file, limits.max_file_bytes);
    if (!bytes) return files;
    const auto container = split_container(*bytes, name);
    if (!container || container->json.size() > limits.max_json_bytes ||
        !check_json_depth(*container, limits.max_json_depth, name))
      return files;
    const auto document = nlohmann::json::parse(container->json, nullptr, /*allow_exceptions=*/false);
    if (!document.is_object()) return files;
    append_named(document, "buffers", file, files);
    append_named(document, "images", file, files);
  } catch (const std::bad_alloc&) {
    // Whoever loads the scene says so.
  }
  return files;
}

}  // namespace relume
