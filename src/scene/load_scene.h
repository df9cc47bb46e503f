// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/result.h"
#include "core/sky.h"
#include "scene/scene.h"

namespace relume {

struct SceneLimits {
  std::uint64_t max_file_bytes = std::uint64_t{2} << 30;  ///< of any one file that is read
  std::uint32_t max_json_depth = 64;
  std::uint64_t max_image_pixels = std::uint64_t{1} << 28;
};

/// Reads .gltf or .glb (default scene, or the first). World transforms are in double precision. Nothing outside the scene file's folder is opened.
/// Everything is validated before use; the error is one line with file, JSON path or byte offset, what was expected and found (bad_input).
/// What is not supported is named in Scene::warnings. Triangles that are not finite, of zero area, or repeated are dropped and counted in one warning.
Result<Scene> load_scene(const std::filesystem::path& file, const SceneLimits& limits = {});

/// Reads a Radiance .hdr (equirectangular, core/sky.h).
Result<EquirectangularSky> load_sky(const std::filesystem::path& file);

}  // namespace relume
