// SPDX-License-Identifier: MIT
#include "scene/write_glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "core/model_file.h"

namespace relume {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Bytes = std::vector<std::byte>;

constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr int kFloat = 5126;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;

void append_u32(Bytes& bytes, std::uint64_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xffu));
}

void pad(Bytes& bytes, std::byte filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(filler);
}

template <class V>
OrderedJson numbers(const V& vector, int count) {
  OrderedJson out = OrderedJson::array();
  for (int i = 0; i < count; ++i) out.push_back(vector[i]);
  return out;
}

bool is_identity(const glm::dmat4& transform) {
  return transform == glm::dmat4(1.0);
}

/// Turns a GlbScene into JSON and one binary chunk.
class Encoder {
 public:
  explicit Encoder(const GlbScene& scene) : scene_(scene) {}

  Bytes encode() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "relume"}};
    write_nodes();
    for (const auto& mesh : scene_.meshes) write_mesh(mesh);
    for (const auto& material : scene_.materials) write_material(material);
    for (const auto& light : scene_.lights) write_light(light);
    for (const auto& camera : scene_.cameras) {
      json_["cameras"].push_back(
          {{"type", "perspective"},
           {"perspective", {{"yfov", camera.vertical_field_of_view}, {"znear", 0.01}}}});
    }
    for (const auto& image : scene_.images) write_image(image);
    if (!binary_.empty()) json_["buffers"] = OrderedJson::array({{{"byteLength", binary_.size()}}});
    if (!extensions_.empty()) json_["extensionsUsed"] = extensions_;
    return assembled();
  }

 private:
  void use_extension(const char* name) {
    if (std::find(extensions_.begin(), extensions_.end(), name) == extensions_.end())
      extensions_.push_back(name);
  }

  std::size_t add_view(std::span<const std::byte> bytes, int target) {
    pad(binary_, std::byte{0});
    OrderedJson view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    json_["bufferViews"].push_back(std::move(view));
    return json_["bufferViews"].size() - 1;
  }

  template <class T>
  std::size_t add_accessor(const std::vector<T>& values, int component_type, const char* type, int target,
                           std::size_t count) {
    const auto view = add_view(std::as_bytes(std::span(values)), target);
    json_["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return json_["accessors"].size() - 1;
  }

  template <class T>
  void add_attribute(OrderedJson& attributes, const char* name, const std::vector<T>& values,
                     const char* type) {
    if (!values.empty()) attributes[name] = add_accessor(values, kFloat, type, kArrayBuffer, values.size());
  }

  std::size_t add_indices(const GlbPrimitive& primitive) {
    const std::size_t count = primitive.triangles.size() * 3;
    if (primitive.positions.size() > 65535) {
      return add_accessor(primitive.triangles, kUnsignedInt, "SCALAR", kElementArrayBuffer, count);
    }
    std::vector<std::uint16_t> indices;
    for (const auto& triangle : primitive.triangles) {
      for (const std::uint32_t corner : triangle) indices.push_back(static_cast<std::uint16_t>(corner));
    }
    return add_accessor(indices, kUnsignedShort, "SCALAR", kElementArrayBuffer, count);
  }

  void write_mesh(const GlbMesh& mesh) {
    OrderedJson primitives = OrderedJson::array();
    for (const auto& primitive : mesh.primitives) {
      OrderedJson attributes = OrderedJson::object();
      add_attribute(attributes, "POSITION", primitive.positions, "VEC3");
      glm::vec3 low(std::numeric_limits<float>::infinity());
      glm::vec3 high = -low;
      for (const auto& position : primitive.positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
      }
      json_["accessors"].back()["min"] = numbers(low, 3);
      json_["accessors"].back()["max"] = numbers(high, 3);
      add_attribute(attributes, "NORMAL", primitive.normals, "VEC3");
      add_attribute(attributes, "TEXCOORD_0", primitive.uv0, "VEC2");
      add_attribute(attributes, "TEXCOORD_1", primitive.uv1, "VEC2");
      add_attribute(attributes, "COLOR_0", primitive.colors, "VEC4");
      OrderedJson out = {{"attributes", std::move(attributes)}, {"indices", add_indices(primitive)}};
      if (primitive.material) out["material"] = *primitive.material;
      primitives.push_back(std::move(out));
    }
    json_["meshes"].push_back({{"name", mesh.name}, {"primitives", std::move(primitives)}});
  }

  OrderedJson texture_info(const GlbTexture& texture) {
    const int wrap = texture.wrap == WrapMode::clamp_to_edge     ? 33071
                     : texture.wrap == WrapMode::mirrored_repeat ? 33648
                                                                 : 10497;
    json_["samplers"].push_back({{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", wrap}, {"wrapT", wrap}});
    json_["textures"].push_back({{"sampler", json_["samplers"].size() - 1}, {"source", texture.image}});
    return {{"index", json_["textures"].size() - 1}, {"texCoord", texture.uv_set}};
  }

  void write_material(const GlbMaterial& material) {
    OrderedJson pbr = {
        {"baseColorFactor", {material.base_color.x, material.base_color.y, material.base_color.z, 1.0}},
        {"metallicFactor", 0.0},
        {"roughnessFactor", 1.0}};
    if (material.base_color_texture) pbr["baseColorTexture"] = texture_info(*material.base_color_texture);
    OrderedJson out = {{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
    write_emission(material, out);
    if (material.double_sided) out["doubleSided"] = true;
    if (material.unlit) {
      use_extension("KHR_materials_unlit");
      out["extensions"]["KHR_materials_unlit"] = OrderedJson::object();
    }
    json_["materials"].push_back(std::move(out));
  }

  void write_emission(const GlbMaterial& material, OrderedJson& out) {
    const double largest = std::max({material.emission.x, material.emission.y, material.emission.z});
    if (largest <= 0.0) return;
    // A power of two, so that factor x strength gives the same number back.
    const double strength = largest <= 1.0 ? 1.0 : std::exp2(std::ceil(std::log2(largest)));
    out["emissiveFactor"] = numbers(material.emission / strength, 3);
    if (material.emission_texture) out["emissiveTexture"] = texture_info(*material.emission_texture);
    if (strength == 1.0) return;
    use_extension("KHR_materials_emissive_strength");
    out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
  }

  void write_light(const Light& light) {
    use_extension("KHR_lights_punctual");
    const double intensity = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    const Rgb color = intensity > 0.0 ? light.intensity / intensity : Rgb(1.0);
    OrderedJson out;
    if (!light.name.empty()) out["name"] = light.name;
    out["type"] = light.type == LightType::spot          ? "spot"
                  : light.type == LightType::directional ? "directional"
                                                         : "point";
    out["color"] = numbers(color, 3);
    out["intensity"] = intensity;
    if (light.range > 0.0 && light.type != LightType::directional) out["range"] = light.range;
    if (light.type == LightType::spot) {
      out["spot"] = {{"innerConeAngle", light.inner_cone_angle}, {"outerConeAngle", light.outer_cone_angle}};
    }
    json_["extensions"]["KHR_lights_punctual"]["lights"].push_back(std::move(out));
  }

  void write_image(const Bytes& png) {
    const auto view = add_view(png, 0);
    json_["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
  }

  static OrderedJson relume_extras(const NodeExtras& extras) {
    OrderedJson out = OrderedJson::object();
    if (extras.is_static) out["static"] = *extras.is_static;
    if (extras.receiver) out["receiver"] = *extras.receiver;
    if (extras.system) out["system"] = *extras.system;
    if (extras.texel_size) out["texel_size"] = *extras.texel_size;
    if (extras.quality) out["quality"] = *extras.quality;
    if (extras.budget) out["budget"] = *extras.budget;
    if (extras.emitter) out["emitter"] = *extras.emitter;
    return out;
  }

  void write_nodes() {
    OrderedJson roots = OrderedJson::array();
    std::vector<OrderedJson> children(scene_.nodes.size(), OrderedJson::array());
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      const auto& parent = scene_.nodes[i].parent;
      (parent ? children[*parent] : roots).push_back(i);
    }
    json_["scene"] = 0;
    json_["scenes"] = OrderedJson::array({{{"nodes", std::move(roots)}}});
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      json_["nodes"].push_back(node_json(scene_.nodes[i], std::move(children[i])));
    }
  }

  static OrderedJson node_json(const GlbNode& node, OrderedJson children) {
    OrderedJson out;
    out["name"] = node.name;
    if (!is_identity(node.transform)) {
      for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) out["matrix"].push_back(node.transform[column][row]);
      }
    }
    if (!children.empty()) out["children"] = std::move(children);
    if (node.mesh) out["mesh"] = *node.mesh;
    if (node.camera) out["camera"] = *node.camera;
    if (node.light) out["extensions"]["KHR_lights_punctual"]["light"] = *node.light;
    if (OrderedJson extras = relume_extras(node.extras); !extras.empty())
      out["extras"]["relume"] = std::move(extras);
    return out;
  }

  Bytes assembled() {
    const std::string text = json_.dump();
    Bytes json(text.size());
    std::memcpy(json.data(), text.data(), text.size());
    pad(json, std::byte{' '});
    pad(binary_, std::byte{0});
    Bytes out;
    append_u32(out, 0x46546C67);
    append_u32(out, 2);
    append_u32(out, 12 + 8 + json.size() + (binary_.empty() ? 0 : 8 + binary_.size()));
    append_u32(out, json.size());
    append_u32(out, 0x4E4F534A);
    out.insert(out.end(), json.begin(), json.end());
    if (!binary_.empty()) {
      append_u32(out, binary_.size());
      append_u32(out, 0x004E4942);
      out.insert(out.end(), binary_.begin(), binary_.end());
    }
    return out;
  }

  const GlbScene& scene_;
  OrderedJson json_;
  Bytes binary_;
  std::vector<std::string> extensions_;
};

Result<void> check_primitive(const GlbScene& scene, const GlbPrimitive& primitive, const std::string& mesh) {
  const std::size_t count = primitive.positions.size();
  if (count == 0 || primitive.triangles.empty()) {
    return fail(ErrorCode::usage, fmt::format("mesh {}: a primitive without vertices or triangles", mesh));
  }
  for (const std::size_t length :
       {primitive.normals.size(), primitive.uv0.size(), primitive.uv1.size(), primitive.colors.size()}) {
    if (length != 0 && length != count) {
      return fail(ErrorCode::usage,
                  fmt::format("mesh {}: an attribute has {} elements for {} positions", mesh, length, count));
    }
  }
  for (const auto& triangle : primitive.triangles) {
    if (*std::max_element(triangle.begin(), triangle.end()) >= count) {
      return fail(ErrorCode::usage, fmt::format("mesh {}: an index is not below {}", mesh, count));
    }
  }
  if (primitive.material && *primitive.material >= scene.materials.size()) {
    return fail(ErrorCode::usage,
                fmt::format("mesh {}: material {} does not exist", mesh, *primitive.material));
  }
  return {};
}

bool is_below(const std::optional<std::uint32_t>& index, std::size_t count) {
  return !index || *index < count;
}

Result<void> check_scene(const GlbScene& scene) {
  for (const auto& mesh : scene.meshes) {
    for (const auto& primitive : mesh.primitives) {
      if (auto result = check_primitive(scene, primitive, mesh.name); !result) return result;
    }
  }
  for (const auto& material : scene.materials) {
    for (const auto& texture : {material.base_color_texture, material.emission_texture}) {
      if (texture && texture->image >= scene.images.size()) {
        return fail(ErrorCode::usage,
                    fmt::format("material {}: image {} does not exist", material.name, texture->image));
      }
    }
  }
  for (const auto& node : scene.nodes) {
    const bool fits = is_below(node.mesh, scene.meshes.size()) && is_below(node.light, scene.lights.size()) &&
                      is_below(node.camera, scene.cameras.size()) &&
                      is_below(node.parent, scene.nodes.size());
    if (!fits)
      return fail(ErrorCode::usage,
                  fmt::format("node {}: refers to something that does not exist", node.name));
  }
  return {};
}

/// A rigid transform at `position` whose -Z is `forward` and whose Y is as near to `up` as can be.
glm::dmat4 looking(const glm::dvec3& position, const glm::dvec3& forward, const glm::dvec3& up) {
  const glm::dvec3 z = -glm::normalize(forward);
  const glm::dvec3 helper = std::abs(glm::dot(z, glm::normalize(up))) > 0.999 ? glm::dvec3(1, 0, 0) : up;
  const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
  return {glm::dvec4(x, 0.0), glm::dvec4(glm::cross(z, x), 0.0), glm::dvec4(z, 0.0),
          glm::dvec4(position, 1.0)};
}

}  // namespace

void add_light(GlbScene& scene, const Light& light) {
  GlbNode node;
  node.name = light.name;
  node.transform = looking(light.position, light.direction, {0.0, 1.0, 0.0});
  node.light = static_cast<std::uint32_t>(scene.lights.size());
  scene.lights.push_back(light);
  scene.nodes.push_back(std::move(node));
}

void add_camera(GlbScene& scene, const std::string& name, const Camera& camera) {
  GlbNode node;
  node.name = name;
  node.transform = looking(camera.position, camera.forward, camera.up);
  node.camera = static_cast<std::uint32_t>(scene.cameras.size());
  scene.cameras.push_back({camera.vertical_field_of_view});
  scene.nodes.push_back(std::move(node));
}

Result<std::vector<std::byte>> encode_glb(const GlbScene& scene) {
  if (auto result = check_scene(scene); !result) return tl::unexpected(result.error());
  try {
    auto bytes = Encoder(scene).encode();
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) {
      return fail(ErrorCode::usage, fmt::format("a .glb holds at most 4 GiB, not {} bytes", bytes.size()));
    }
    return bytes;
  } catch (const nlohmann::json::exception& error) {
    return fail(ErrorCode::usage, fmt::format("a name in the scene is not UTF-8 ({})", error.what()));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "no memory to write a .glb");
  }
}

Result<void> write_glb(const GlbScene& scene, const std::filesystem::path& file) {
  const auto bytes = encode_glb(scene);
  if (!bytes) return tl::unexpected(bytes.error());
  return write_file(file, *bytes);
}

}  // namespace relume
