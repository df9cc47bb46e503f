// SPDX-License-Identifier: MIT
//
// Hand-made glTF files for tests, written to a folder that goes away.
#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "scene/scene.h"

namespace relume::test {

using Json = nlohmann::json;
using Bytes = std::vector<std::byte>;

/// A new empty folder, removed with the value.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Writes a file below the folder, making folders on the way; returns its path.
  std::filesystem::path write(const std::string& name, std::string_view text) const;
  std::filesystem::path write(const std::string& name, const Bytes& bytes) const;

 private:
  std::filesystem::path path_;
};

/// A glTF under construction: its JSON, and one binary buffer that accessors are appended to.
struct GltfSketch {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", Json::array()}}}}};
  Bytes binary;

  /// Appends to an array of the document; returns the index.
  int add(const char* array, Json element);

  int add_view(const void* data, std::size_t bytes, Json more = Json::object());

  template <class T>
  int add_accessor(const std::vector<T>& values, int component_type, const char* type, std::size_t count,
                   Json more = Json::object()) {
    Json accessor = {{"bufferView", add_view(values.data(), values.size() * sizeof(T))},
                     {"componentType", component_type},
                     {"type", type},
                     {"count", count}};
    accessor.update(more);
    return add("accessors", std::move(accessor));
  }
  int add_floats(const std::vector<float>& values, const char* type);

  /// A mesh of one primitive, with a root node that shows it. Returns the node.
  int add_mesh_node(Json primitive, Json node = Json::object());

  /// Writes NAME and, for its buffer, "data.bin".
  std::filesystem::path write(const ScratchFolder& folder, const std::string& name = "scene.gltf") const;
};

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

/// One triangle (0 0 0) (1 0 0) (0 1 0), whose front looks along +Z: accessor 0, mesh 0, node 0.
GltfSketch one_triangle(Json node = Json::object());

/// Writes and loads a sketch.
Result<Scene> load(const GltfSketch& sketch);

/// load, with a test failure and an empty scene when it fails.
Scene load_good(const GltfSketch& sketch);

/// Whether some warning contains `text`.
bool warns(const Scene& scene, std::string_view text);

/// World corners of a triangle.
std::array<glm::dvec3, 3> corners(const Scene& scene, std::size_t triangle);

/// Not normalised: twice the area.
glm::dvec3 triangle_normal(const Scene& scene, std::size_t triangle);

/// PNG of RGBA pixels, row by row.
Bytes png(int width, int height, const std::vector<std::uint8_t>& rgba);

/// Base64 with padding, for data URIs.
std::string base64(const Bytes& bytes);

}  // namespace relume::test
