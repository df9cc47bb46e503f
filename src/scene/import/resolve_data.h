// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "core/result.h"
#include "scene/import/container.h"
#include "scene/load_scene.h"

namespace relume {

/// All bytes that a document refers to, outside of it.
struct GltfData {
  std::vector<std::vector<std::byte>> owned;
  std::vector<std::span<const std::byte>>
      views;  ///< per bufferView: its bytes, decompressed; empty where nothing is behind it
  std::vector<std::span<const std::byte>>
      images;  ///< per image: the encoded file; empty where no base colour or emission needs it
};

/// Loads buffers (GLB chunk, data URIs, files), decodes compressed views and loads the images that colours
/// need. Each is at least as long as the document says. `container` must outlive the result.
Result<GltfData> resolve_data(const nlohmann::json& document, const GltfContainer& container,
                              const std::filesystem::path& scene_file, const SceneLimits& limits);

}  // namespace relume
