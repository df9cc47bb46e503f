// SPDX-License-Identifier: MIT
#include "scene/import/structure.h"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "scene/import/import_error.h"
#include "scene/import/json_access.h"

namespace relume {
namespace {

using Json = nlohmann::json;
using Size = std::uint64_t;

constexpr Size kNoParent = ~Size{0};

Size component_bytes(Size component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    default:
      return 4;
  }
}

Size component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  return type == "MAT3" ? 9 : 16;
}

/// offset + length within `available`; all three are below 2^54, so nothing wraps.
Result<void> check_span(Size offset, Size length, Size available, const std::string& file,
                        const std::string& place, std::string_view what) {
  if (offset <= available && length <= available - offset) return {};
  return import_error(file, place, fmt::format("an end within the {} bytes of its {}", available, what),
                      fmt::format("{} bytes from offset {}", length, offset));
}

Result<void> check_compressed_view(const Json& view, const Json& buffers, const std::string& file,
                                   const std::string& place) {
  const Json* extension = extension_of(view, "EXT_meshopt_compression");
  if (!extension) return {};
  const Json& packed = *extension;
  const std::string packed_place = place + "/extensions/EXT_meshopt_compression";
  const Size decoded = size_of(packed, "count") * size_of(packed, "byteStride");
  if (decoded != size_of(view, "byteLength")) {
    return import_error(file, packed_place,
                        fmt::format("count x byteStride = {} bytes of the view", size_of(view, "byteLength")),
                        fmt::format("{}", decoded));
  }
  return check_span(size_of(packed, "byteOffset"), size_of(packed, "byteLength"),
                    size_of(buffers[size_of(packed, "buffer")], "byteLength"), file, packed_place, "buffer");
}

Result<void> check_view(const Json& view, const Json& buffers, const std::string& file,
                        const std::string& place) {
  if (size_of(view, "byteStride") % 4 != 0) {
    return import_error(file, place + "/byteStride", "a multiple of 4",
                        fmt::format("{}", size_of(view, "byteStride")));
  }
  auto inside = check_span(size_of(view, "byteOffset"), size_of(view, "byteLength"),
                           size_of(buffers[size_of(view, "buffer")], "byteLength"), file, place, "buffer");
  if (!inside) return inside;
  return check_compressed_view(view, buffers, file, place);
}

Result<void> check_sparse(const Json& accessor, const Json& views, Size element_bytes,
                          const std::string& file, const std::string& place) {
  const auto sparse = accessor.find("sparse");
  if (sparse == accessor.end()) return {};
  const Size count = size_of(*sparse, "count");
  if (count > size_of(accessor, "count")) {
    return import_error(file, place + "/sparse/count", fmt::format("at most {}", size_of(accessor, "count")),
                        fmt::format("{}", count));
  }
  const Json& indices = (*sparse)["indices"];
  const Size index_bytes = component_bytes(size_of(indices, "componentType"));
  auto inside = check_span(size_of(indices, "byteOffset"), count * index_bytes,
                           size_of(views[size_of(indices, "bufferView")], "byteLength"), file,
                           place + "/sparse/indices", "view");
  if (!inside) return inside;
  const Json& values = (*sparse)["values"];
  return check_span(size_of(values, "byteOffset"), count * element_bytes,
                    size_of(views[size_of(values, "bufferView")], "byteLength"), file,
                    place + "/sparse/values", "view");
}

Result<void> check_accessor(const Json& accessor, const Json& views, const std::string& file,
                            const std::string& place) {
  const Size element_bytes = component_bytes(size_of(accessor, "componentType")) *
                             component_count(accessor["type"].get_ref<const std::string&>());
  if (accessor.contains("bufferView")) {
    const Json& view = views[size_of(accessor, "bufferView")];
    const Size stride = view.contains("byteStride") ? size_of(view, "byteStride") : element_bytes;
    const Size length = stride * (size_of(accessor, "count") - 1) + element_bytes;
    auto inside =
        check_span(size_of(accessor, "byteOffset"), length, size_of(view, "byteLength"), file, place, "view");
    if (!inside) return inside;
  }
  return check_sparse(accessor, views, element_bytes, file, place);
}

Result<void> check_primitive(const Json& primitive, const Json& accessors, const std::string& file,
                             const std::string& place) {
  const Json& attributes = primitive["attributes"];
  const auto has_data = [&](const Json& holder, const char* name) {
    if (!holder.contains(name)) return true;
    const Json& accessor = accessors[size_of(holder, name)];
    return accessor.contains("bufferView") || accessor.contains("sparse");
  };
  const bool is_packed = extension_of(primitive, "KHR_draco_mesh_compression") != nullptr;
  if (is_packed && !has_data(attributes, "POSITION")) {
    return import_error(file, place + "/extensions",
                        "triangles that are not packed, or by EXT_meshopt_compression",
                        "KHR_draco_mesh_compression");
  }
  if (!has_data(primitive, "indices")) {
    return import_error(file, place + "/indices", "an accessor with a bufferView", "one without data");
  }
  return {};
}

/// The parent of each node.
Result<std::vector<Size>> parents_of(const Json& nodes, const std::string& file) {
  std::vector<Size> parents(nodes.size(), kNoParent);
  for (Size i = 0; i < nodes.size(); ++i) {
    const Json& children = array_of(nodes[i], "children");
    for (Size k = 0; k < children.size(); ++k) {
      const Size child = children[k].get<Size>();
      if (parents[child] != kNoParent) {
        return import_error(file, fmt::format("/nodes/{}/children/{}", i, k), "a node without another parent",
                            fmt::format("node {}, a child of node {}", child, parents[child]));
      }
      parents[child] = i;
    }
  }
  return parents;
}

}  // namespace

Result<void> check_ranges(const Json& document, const std::string& file) {
  const Json& buffers = array_of(document, "buffers");
  const Json& views = array_of(document, "bufferViews");
  const Json& accessors = array_of(document, "accessors");
  for (Size i = 0; i < views.size(); ++i) {
    if (auto result = check_view(views[i], buffers, file, json_path("bufferViews", i)); !result)
      return result;
  }
  for (Size i = 0; i < accessors.size(); ++i) {
    if (auto result = check_accessor(accessors[i], views, file, json_path("accessors", i)); !result)
      return result;
  }
  return {};
}

Result<void> check_primitives(const Json& document, const std::string& file) {
  const Json& meshes = array_of(document, "meshes");
  for (Size m = 0; m < meshes.size(); ++m) {
    const Json& primitives = meshes[m]["primitives"];
    for (Size p = 0; p < primitives.size(); ++p) {
      auto result = check_primitive(primitives[p], array_of(document, "accessors"), file,
                                    fmt::format("/meshes/{}/primitives/{}", m, p));
      if (!result) return result;
    }
  }
  return {};
}

Result<void> check_variants(const Json& document, const std::string& file) {
  const Json& cameras = array_of(document, "cameras");
  for (Size i = 0; i < cameras.size(); ++i) {
    const auto& type = cameras[i]["type"].get_ref<const std::string&>();
    if (!cameras[i].contains(type))
      return import_error(file, json_path("cameras", i) + "/" + type, "an object", "nothing");
  }
  const Json* punctual = extension_of(document, "KHR_lights_punctual");
  if (!punctual) return {};
  const Json& lights = array_of(*punctual, "lights");
  for (Size i = 0; i < lights.size(); ++i) {
    if (lights[i]["type"] == "spot" && !lights[i].contains("spot")) {
      return import_error(file, json_path("extensions/KHR_lights_punctual/lights", i) + "/spot", "an object",
                          "nothing");
    }
  }
  return {};
}

Result<void> check_node_forest(const Json& document, const std::string& file) {
  const Json& nodes = array_of(document, "nodes");
  const auto parents = parents_of(nodes, file);
  if (!parents) return tl::unexpected(parents.error());
  // Upwards from each node: `walk_of` remembers the walk that came by, so every node is walked once.
  std::vector<Size> walk_of(nodes.size(), kNoParent);
  for (Size start = 0; start < nodes.size(); ++start) {
    Size at = start;
    while (at != kNoParent && walk_of[at] == kNoParent) {
      walk_of[at] = start;
      at = (*parents)[at];
    }
    if (at != kNoParent && walk_of[at] == start) {
      return import_error(file, json_path("nodes", at), "a node that is not below itself", "a cycle");
    }
  }
  const Json& scenes = array_of(document, "scenes");
  std::vector<Size> named_by(nodes.size(), kNoParent);
  for (Size s = 0; s < scenes.size(); ++s) {
    const Json& roots = array_of(scenes[s], "nodes");
    for (Size k = 0; k < roots.size(); ++k) {
      const Size root = roots[k].get<Size>();
      const bool again = named_by[root] == s;
      if ((*parents)[root] != kNoParent || again) {
        return import_error(file, fmt::format("/scenes/{}/nodes/{}", s, k), "a root node, named once",
                            fmt::format("node {}{}", root, again ? " again" : ", a child of another node"));
      }
      named_by[root] = s;
    }
  }
  return {};
}

}  // namespace relume
