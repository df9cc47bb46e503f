// SPDX-License-Identifier: MIT
//
// A glTF file after all of its checks: tinygltf's typed view of the JSON, and the bytes behind it. Only this
// folder's sources and write_glb.cpp see tinygltf.
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/import/resolve_data.h"
#include "scene/load_scene.h"

namespace relume {

struct GltfFile {
  std::string name;  ///< for messages: the file name without its folder
  std::vector<std::byte> bytes;
  tinygltf::Model model;  ///< its buffers and images are empty: the data is in `data`
  GltfData data;
  std::vector<std::string> warnings;
};

Result<GltfFile> read_gltf(const std::filesystem::path& file, const SceneLimits& limits);

}  // namespace relume
