// SPDX-License-Identifier: MIT
#include "scene/gltf_sketch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <glm/geometric.hpp>

#include "scene/load_scene.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb_image_write.h>

namespace relume::test {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder() {
  static std::atomic<int> count = 0;
  path_ = fs::path(testing::TempDir()) /
          ("relume_scene_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
  fs::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path ScratchFolder::write(const std::string& name, std::string_view text) const {
  const fs::path file = path_ / name;
  fs::create_directories(file.parent_path());
  fs::remove(file);  // overwriting in place makes some file systems flush
  std::ofstream(file, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
  return file;
}

fs::path ScratchFolder::write(const std::string& name, const Bytes& bytes) const {
  return write(name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

int GltfSketch::add(const char* array, Json element) {
  json[array].push_back(std::move(element));
  return static_cast<int>(json[array].size()) - 1;
}

int GltfSketch::add_view(const void* data, std::size_t bytes, Json more) {
  while (binary.size() % 4 != 0) binary.push_back(std::byte{0});
  Json view = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}};
  view.update(more);
  const auto* first = static_cast<const std::byte*>(data);
  binary.insert(binary.end(), first, first + bytes);
  return add("bufferViews", std::move(view));
}

int GltfSketch::add_floats(const std::vector<float>& values, const char* type) {
  const std::string name(type);
  const std::size_t components = name == "SCALAR" ? 1 : static_cast<std::size_t>(name.back() - '0');
  return add_accessor(values, kFloat, type, values.size() / components);
}

int GltfSketch::add_mesh_node(Json primitive, Json node) {
  node["mesh"] = add("meshes", {{"primitives", Json::array({std::move(primitive)})}});
  const int index = add("nodes", std::move(node));
  json["scenes"][0]["nodes"].push_back(index);
  return index;
}

fs::path GltfSketch::write(const ScratchFolder& folder, const std::string& name) const {
  Json out = json;
  if (!binary.empty() && !out.contains("buffers")) {
    out["buffers"] = Json::array({{{"byteLength", binary.size()}, {"uri", "data.bin"}}});
  }
  folder.write("data.bin", binary);
  return folder.write(name, out.dump());
}

GltfSketch one_triangle(Json node) {
  GltfSketch sketch;
  const int positions = sketch.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  sketch.add_mesh_node({{"attributes", {{"POSITION", positions}}}}, std::move(node));
  return sketch;
}

Result<Scene> load(const GltfSketch& sketch) {
  const ScratchFolder folder;
  return load_scene(sketch.write(folder));
}

Scene load_good(const GltfSketch& sketch) {
  auto scene = load(sketch);
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  return std::move(*scene);
}

bool warns(const Scene& scene, std::string_view text) {
  for (const auto& warning : scene.warnings) {
    if (warning.find(text) != std::string::npos) return true;
  }
  return false;
}

std::array<glm::dvec3, 3> corners(const Scene& scene, std::size_t triangle) {
  const auto& t = scene.triangles.at(triangle);
  const auto& p = scene.vertices.positions;
  return {p.at(t[0]), p.at(t[1]), p.at(t[2])};
}

glm::dvec3 triangle_normal(const Scene& scene, std::size_t triangle) {
  const auto p = corners(scene, triangle);
  return glm::cross(p[1] - p[0], p[2] - p[0]);
}

Bytes png(int width, int height, const std::vector<std::uint8_t>& rgba) {
  Bytes out;
  const auto append = [](void* to, void* data, int size) {
    const auto* first = static_cast<const std::byte*>(data);
    static_cast<Bytes*>(to)->insert(static_cast<Bytes*>(to)->end(), first, first + size);
  };
  stbi_write_png_to_func(append, &out, width, height, 4, rgba.data(), width * 4);
  return out;
}

std::string base64(const Bytes& bytes) {
  static const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      return k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[k]) : 0u;
    };
    const std::uint32_t bits = (at(i) << 16) | (at(i + 1) << 8) | at(i + 2);
    out += letters[bits >> 18];
    out += letters[(bits >> 12) & 63u];
    out += i + 1 < bytes.size() ? letters[(bits >> 6) & 63u] : '=';
    out += i + 2 < bytes.size() ? letters[bits & 63u] : '=';
  }
  return out;
}

}  // namespace relume::test
