// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/result.h"
#include "core/sky.h"
#include "scene/scene.h"

namespace relume {

/// What a scene may ask for. A file that wants more is refused before memory is taken for it.
struct SceneLimits {
  std::uint64_t max_file_bytes = 2ull << 30;  ///< of the scene file, and again of all it refers to, unpacked
  std::uint64_t max_json_bytes = 256ull << 20;
  std::uint32_t max_json_depth = 64;
  std::uint64_t max_image_pixels = 1ull << 26;  ///< of one image; all together may have four times as many
  std::uint64_t max_triangles = 1ull << 25;     ///< with every instance counted
};

/// Reads .gltf or .glb (default scene, or the first; without any, all nodes). World transforms are in double
/// precision. Nothing outside the scene file's folder is opened. Everything is validated before use; the
/// error is one line with file, JSON path or byte offset, what was expected and found (bad_input;
/// out_of_memory where memory ends). What is not supported is named in Scene::warnings. Triangles that are
/// not finite, of zero area, or repeated are dropped and counted in one warning; those of dynamic nodes in
/// another. A material that a file leaves out reflects 0.5. Numbers in a file that are not finite are an
/// error.
Result<Scene> load_scene(const std::filesystem::path& file, const SceneLimits& limits = {});

/// Reads a Radiance .hdr (equirectangular, core/sky.h; width = 2 x height). Values must be finite and not
/// below 0.
Result<EquirectangularSky> load_sky(const std::filesystem::path& file, const SceneLimits& limits = {});

}  // namespace relume
