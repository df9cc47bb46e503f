// SPDX-License-Identifier: MIT
#include "scene/import/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "scene/import/accessor_reader.h"
#include "scene/import/import_error.h"

namespace relume {
namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;
constexpr double kCoordinatePrecision =
    0x1p-22;  // two roundings of a 24-bit mantissa, relative to the largest coordinate

bool has_triangles(const tinygltf::Primitive& primitive) {
  return primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

std::uint64_t triangles_in(int mode, std::uint64_t corners) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

/// glTF 2.0, 3.7.2.1: triangle i of a strip is {i, i + 1 + i % 2, i + 2 - i % 2}, of a fan {i + 1, i + 2, 0}.
std::vector<std::array<std::uint32_t, 3>> assemble(int mode, const std::vector<std::uint32_t>& corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles(triangles_in(mode, corners.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      triangles[i] = {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]};
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      triangles[i] = {corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]};
    } else {
      triangles[i] = {corners[i + 1], corners[i + 2], corners[0]};
    }
  }
  return triangles;
}

bool has_area(const AccessorValues& positions, const std::array<std::uint32_t, 3>& triangle) {
  std::array<glm::dvec3, 3> p{};
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double* at = &positions.values[std::size_t{3} * triangle[i]];
    p[i] = {at[0], at[1], at[2]};
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(p[i][axis]));
  }
  const double longest =
      std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])});
  const double double_area = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  return double_area > kCoordinatePrecision * largest * longest;
}

/// Reads the parts of one primitive.
class PrimitiveReader {
 public:
  PrimitiveReader(const GltfFile& gltf, const tinygltf::Primitive& primitive, std::string place)
      : gltf_(gltf), primitive_(primitive), place_(std::move(place)) {}

  Result<MeshPrimitive> read(PrimitiveCounts& counts) const {
    const auto positions = attribute("POSITION", {TINYGLTF_TYPE_VEC3}, false);
    if (!positions) return tl::unexpected(positions.error());
    const auto corners = read_corners(positions->count);
    if (!corners) return tl::unexpected(corners.error());
    MeshPrimitive out;
    out.material = primitive_.material;
    out.triangles = assemble(primitive_.mode, *corners);
    out.without_area = std::erase_if(out.triangles, [&](const auto& t) { return !has_area(*positions, t); });
    const auto kept = keep_used(positions->count, out.triangles);
    out.positions.reserve(kept.size());
    for (const std::uint32_t i : kept) {
      const double* p = &positions->values[std::size_t{3} * i];
      out.positions.emplace_back(p[0], p[1], p[2]);
    }
    auto result = read_uvs("TEXCOORD_0", positions->count, kept, out.uv0);
    if (result) result = read_uvs("TEXCOORD_1", positions->count, kept, out.uv1);
    if (result) result = read_colors(positions->count, kept, out.colors, counts);
    if (!result) return tl::unexpected(result.error());
    return out;
  }

 private:
  Result<AccessorValues> attribute(const char* name, std::vector<int> types, bool normalised) const {
    return read_accessor(
        gltf_, primitive_.attributes.at(name),
        {fmt::format("{}/attributes/{}", place_, name), std::move(types), false, normalised});
  }

  Result<std::vector<std::uint32_t>> read_corners(std::uint64_t vertices) const {
    if (primitive_.indices >= 0)
      return read_indices(gltf_, primitive_.indices, place_ + "/indices", vertices);
    std::vector<std::uint32_t> corners(vertices);
    std::iota(corners.begin(), corners.end(), 0u);
    return corners;
  }

  /// Renumbers `triangles`; returns the old numbers of the vertices that they use, in order.
  static std::vector<std::uint32_t> keep_used(std::uint64_t vertices,
                                              std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::vector<std::uint32_t> number(vertices, kUnused);
    for (const auto& triangle : triangles) {
      for (const std::uint32_t corner : triangle) number[corner] = 0;
    }
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < vertices; ++i) {
      if (number[i] == kUnused) continue;
      number[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(i);
    }
    for (auto& triangle : triangles) {
      for (std::uint32_t& corner : triangle) corner = number[corner];
    }
    return kept;
  }

  Result<void> check_count(const char* name, std::uint64_t found, std::uint64_t vertices) const {
    if (found == vertices) return {};
    return import_error(gltf_.name, fmt::format("{}/attributes/{}", place_, name),
                        fmt::format("as many elements as positions ({})", vertices),
                        fmt::format("{}", found));
  }

  Result<void> read_uvs(const char* name, std::uint64_t vertices, const std::vector<std::uint32_t>& kept,
                        std::vector<glm::vec2>& out) const {
    if (primitive_.attributes.count(name) == 0) return {};
    const auto values = attribute(name, {TINYGLTF_TYPE_VEC2}, false);
    if (!values) return tl::unexpected(values.error());
    if (auto result = check_count(name, values->count, vertices); !result) return result;
    for (const std::uint32_t i : kept) out.emplace_back(values->values[2 * i], values->values[2 * i + 1]);
    return {};
  }

  Result<void> read_colors(std::uint64_t vertices, const std::vector<std::uint32_t>& kept,
                           std::vector<glm::vec4>& out, PrimitiveCounts& counts) const {
    if (primitive_.attributes.count("COLOR_0") == 0) return {};
    const auto values = attribute("COLOR_0", {TINYGLTF_TYPE_VEC4, TINYGLTF_TYPE_VEC3}, true);
    if (!values) return tl::unexpected(values.error());
    if (auto result = check_count("COLOR_0", values->count, vertices); !result) return result;
    bool clamped = false;
    for (const std::uint32_t i : kept) {
      glm::vec4 color(1.0f);
      for (int c = 0; c < values->components; ++c) {
        color[c] =
            static_cast<float>(values->values[std::size_t{i} * static_cast<std::size_t>(values->components) +
                                              static_cast<std::size_t>(c)]);
      }
      out.push_back(glm::clamp(color, 0.0f, 1.0f));
      clamped = clamped || out.back() != color;
    }
    if (clamped) ++counts.colors_clamped;
    return {};
  }

  const GltfFile& gltf_;
  const tinygltf::Primitive& primitive_;
  std::string place_;
};

}  // namespace

std::uint64_t count_triangles(const tinygltf::Model& model, const tinygltf::Mesh& mesh) {
  std::uint64_t count = 0;
  for (const auto& primitive : mesh.primitives) {
    const auto position = primitive.attributes.find("POSITION");
    if (!has_triangles(primitive) || position == primitive.attributes.end()) continue;
    const int corners = primitive.indices >= 0 ? primitive.indices : position->second;
    count += triangles_in(primitive.mode, model.accessors[static_cast<std::size_t>(corners)].count);
  }
  return count;
}

Result<std::vector<MeshPrimitive>> read_mesh(const GltfFile& gltf, std::size_t mesh,
                                             PrimitiveCounts& counts) {
  std::vector<MeshPrimitive> out;
  const auto& primitives = gltf.model.meshes[mesh].primitives;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const auto& primitive = primitives[i];
    const std::string place = fmt::format("/meshes/{}/primitives/{}", mesh, i);
    if (!has_triangles(primitive)) {
      ++counts.points_or_lines;
      continue;
    }
    if (primitive.attributes.count("POSITION") == 0) {
      ++counts.without_position;
      continue;
    }
    if (!primitive.targets.empty()) ++counts.with_morph_targets;
    auto read = PrimitiveReader(gltf, primitive, place).read(counts);
    if (!read) return tl::unexpected(read.error());
    out.push_back(std::move(*read));
  }
  return out;
}

}  // namespace relume
