// SPDX-License-Identifier: MIT
#include "scene/import/gltf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>

#include "scene/import/document.h"
#include "scene/import/import_error.h"
#include "scene/import/scene_folder.h"

namespace relume {
namespace {

bool never_exists(const std::string&, void*) {
  return false;
}
std::string same_path(const std::string& path, void*) {
  return path;
}
bool never_reads(std::vector<unsigned char>*, std::string* error, const std::string&, void*) {
  if (error) *error += "tinygltf asked for a file";
  return false;
}
bool never_writes(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// tinygltf only turns JSON into its structs: it gets neither buffers nor images, and no way to open a file.
Result<tinygltf::Model> typed_model(nlohmann::json document, const std::string& file) {
  document.erase("buffers");
  document.erase("images");
  const std::string text = document.dump();
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks({&never_exists, &same_path, &never_reads, &never_writes, nullptr});
  reader.RemoveImageLoader();
  tinygltf::Model model;
  std::string errors;
  std::string warnings;
  if (!reader.LoadASCIIFromString(&model, &errors, &warnings, text.data(),
                                  static_cast<unsigned int>(text.size()), "")) {
    std::replace(errors.begin(), errors.end(), '\n', ' ');
    return import_error(file, "/", "a glTF that tinygltf accepts", errors.substr(0, 400));
  }
  return model;
}

Result<GltfFile> read_checked(const std::filesystem::path& file, const SceneLimits& limits) {
  GltfFile gltf;
  gltf.name = file.filename().string();
  auto bytes = read_regular_file(file, limits.max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  gltf.bytes = std::move(*bytes);
  auto container = split_container(gltf.bytes, gltf.name);
  if (!container) return tl::unexpected(container.error());
  gltf.warnings = std::move(container->warnings);
  auto document = parse_document(*container, limits, gltf.name, gltf.warnings);
  if (!document) return tl::unexpected(document.error());
  auto data = resolve_data(*document, *container, file, limits);
  if (!data) return tl::unexpected(data.error());
  gltf.data = std::move(*data);
  auto model = typed_model(std::move(*document), gltf.name);
  if (!model) return tl::unexpected(model.error());
  gltf.model = std::move(*model);
  return gltf;
}

}  // namespace

Result<GltfFile> read_gltf(const std::filesystem::path& file, const SceneLimits& limits) {
  try {
    return read_checked(file, limits);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, fmt::format("{}: no memory to read it", file.string()));
  } catch (const std::exception& error) {
    return import_error(file.filename().string(), "/", "a readable scene", error.what());
  }
}

}  // namespace relume
