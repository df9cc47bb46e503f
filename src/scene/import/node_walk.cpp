// SPDX-License-Identifier: MIT
#include "scene/import/node_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scene/import/accessor_reader.h"
#include "scene/import/import_error.h"

namespace relume {
namespace {

constexpr std::size_t kMaxPathNames = 32;
constexpr std::size_t kMaxNameBytes = 128;
constexpr auto kExtrasKeys = std::to_array<const char*>(
    {"static", "receiver", "system", "texel_size", "quality", "budget", "emitter"});

Result<glm::dmat4> rotation_matrix(const double* xyzw, const std::string& file, const std::string& place) {
  const glm::dquat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  const double length = glm::length(q);
  if (!(length > 0.0) || !std::isfinite(length)) {
    return import_error(file, place, "a quaternion of length 1", fmt::format("length {}", length));
  }
  return glm::mat4_cast(q / length);
}

Result<glm::dmat4> local_transform(const GltfFile& gltf, std::size_t index) {
  const auto& node = gltf.model.nodes[index];
  glm::dmat4 local(1.0);
  if (node.matrix.size() == 16) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row)
        local[column][row] = node.matrix[static_cast<std::size_t>(4 * column + row)];
    }
    return local;
  }
  if (node.translation.size() == 3) {
    local = glm::translate(local, {node.translation[0], node.translation[1], node.translation[2]});
  }
  if (node.rotation.size() == 4) {
    const auto rotation =
        rotation_matrix(node.rotation.data(), gltf.name, json_path("nodes", index) + "/rotation");
    if (!rotation) return rotation;
    local *= *rotation;
  }
  if (node.scale.size() == 3) local = glm::scale(local, {node.scale[0], node.scale[1], node.scale[2]});
  return local;
}

NodeExtras inherited(NodeExtras extras, const tinygltf::Value& said) {
  if (!said.IsObject()) return extras;
  if (said.Has("static")) extras.is_static = said.Get("static").Get<bool>();
  if (said.Has("receiver")) extras.receiver = said.Get("receiver").Get<std::string>();
  if (said.Has("system")) extras.system = said.Get("system").Get<std::string>();
  if (said.Has("texel_size")) extras.texel_size = said.Get("texel_size").GetNumberAsDouble();
  if (said.Has("quality")) extras.quality = static_cast<std::uint32_t>(said.Get("quality").GetNumberAsInt());
  if (said.Has("budget")) extras.budget = static_cast<std::uint32_t>(said.Get("budget").GetNumberAsInt());
  if (said.Has("emitter")) extras.emitter = said.Get("emitter").Get<bool>();
  return extras;
}

void warn_about_unknown_keys(GltfFile& gltf, std::size_t index, const tinygltf::Value& said) {
  for (const std::string& key : said.Keys()) {
    if (std::find(kExtrasKeys.begin(), kExtrasKeys.end(), key) != kExtrasKeys.end()) continue;
    gltf.warnings.push_back(fmt::format("{}: /nodes/{}/extras/relume/{} is not known and was not read",
                                        gltf.name, index, key.substr(0, 100)));
  }
}

std::vector<bool> animated_nodes(const tinygltf::Model& model) {
  std::vector<bool> animated(model.nodes.size(), false);
  for (const auto& animation : model.animations) {
    for (const auto& channel : animation.channels) {
      const bool moves = channel.target_path == "translation" || channel.target_path == "rotation" ||
                         channel.target_path == "scale";
      if (moves && channel.target_node >= 0) animated[static_cast<std::size_t>(channel.target_node)] = true;
    }
  }
  return animated;
}

std::vector<std::size_t> root_nodes(GltfFile& gltf) {
  const auto& model = gltf.model;
  std::vector<std::size_t> roots;
  if (!model.scenes.empty()) {
    const auto scene = static_cast<std::size_t>(std::max(model.defaultScene, 0));
    for (const int node : model.scenes[scene].nodes) roots.push_back(static_cast<std::size_t>(node));
    return roots;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const auto& node : model.nodes) {
    for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
  }
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (!is_child[i]) roots.push_back(i);
  }
  if (!roots.empty()) {
    gltf.warnings.push_back(fmt::format("{}: it holds no scene, so all of its nodes were read", gltf.name));
  }
  return roots;
}

/// At most kMaxNameBytes, cut between UTF-8 characters.
std::string short_name(const GltfFile& gltf, std::size_t node) {
  std::string name = gltf.model.nodes[node].name;
  if (name.empty()) return fmt::format("node{}", node);
  if (name.size() <= kMaxNameBytes) return name;
  std::size_t end = kMaxNameBytes;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
  return name.substr(0, end);
}

Result<AccessorValues> instance_attribute(const GltfFile& gltf, std::size_t node, const std::string& name,
                                          int type, bool only_float) {
  const auto& attributes = gltf.model.nodes[node].extensions.at("EXT_mesh_gpu_instancing").Get("attributes");
  if (!attributes.Has(name)) return AccessorValues{};
  const AccessorUse use{fmt::format("/nodes/{}/extensions/EXT_mesh_gpu_instancing/attributes/{}", node, name),
                        {type},
                        only_float,
                        true};
  return read_accessor(gltf, attributes.Get(name).GetNumberAsInt(), use);
}

glm::dvec3 vector_at(const AccessorValues& values, std::size_t i) {
  return {values.values[3 * i], values.values[3 * i + 1], values.values[3 * i + 2]};
}

}  // namespace

Result<std::vector<WalkedNode>> walk_nodes(GltfFile& gltf) {
  struct Pending {
    std::size_t node;
    std::size_t parent;
  };
  const auto animated = animated_nodes(gltf.model);
  std::vector<Pending> stack;
  const auto roots = root_nodes(gltf);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, SIZE_MAX});
  std::vector<WalkedNode> walk;
  while (!stack.empty()) {
    const Pending next = stack.back();
    stack.pop_back();
    const WalkedNode parent = next.parent == SIZE_MAX ? WalkedNode{} : walk[next.parent];
    const auto local = local_transform(gltf, next.node);
    if (!local) return tl::unexpected(local.error());
    const auto& node = gltf.model.nodes[next.node];
    const tinygltf::Value said = node.extras.Has("relume") ? node.extras.Get("relume") : tinygltf::Value();
    warn_about_unknown_keys(gltf, next.node, said);
    walk.push_back({next.node, next.parent, parent.world * *local, inherited(parent.extras, said),
                    parent.is_animated || animated[next.node]});
    const std::size_t self = walk.size() - 1;
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      stack.push_back({static_cast<std::size_t>(*child), self});
    }
  }
  return walk;
}

Result<std::vector<glm::dmat4>> instance_transforms(const GltfFile& gltf, std::size_t node) {
  const auto& extensions = gltf.model.nodes[node].extensions;
  if (extensions.find("EXT_mesh_gpu_instancing") == extensions.end())
    return std::vector<glm::dmat4>{glm::dmat4(1.0)};
  const auto translations = instance_attribute(gltf, node, "TRANSLATION", TINYGLTF_TYPE_VEC3, true);
  if (!translations) return tl::unexpected(translations.error());
  const auto rotations = instance_attribute(gltf, node, "ROTATION", TINYGLTF_TYPE_VEC4, false);
  if (!rotations) return tl::unexpected(rotations.error());
  const auto scales = instance_attribute(gltf, node, "SCALE", TINYGLTF_TYPE_VEC3, true);
  if (!scales) return tl::unexpected(scales.error());
  const std::string place = fmt::format("/nodes/{}/extensions/EXT_mesh_gpu_instancing", node);
  const std::uint64_t count = std::max({translations->count, rotations->count, scales->count});
  for (const auto* values : {&*translations, &*rotations, &*scales}) {
    if (values->count != 0 && values->count != count) {
      return import_error(gltf.name, place, "attributes of one length",
                          fmt::format("lengths {} and {}", count, values->count));
    }
  }
  std::vector<glm::dmat4> transforms(std::max<std::uint64_t>(count, 1), glm::dmat4(1.0));
  for (std::size_t i = 0; i < count; ++i) {
    if (translations->count) transforms[i] = glm::translate(transforms[i], vector_at(*translations, i));
    if (rotations->count) {
      const auto rotation =
          rotation_matrix(&rotations->values[4 * i], gltf.name, place + "/attributes/ROTATION");
      if (!rotation) return tl::unexpected(rotation.error());
      transforms[i] *= *rotation;
    }
    if (scales->count) transforms[i] = glm::scale(transforms[i], vector_at(*scales, i));
  }
  return transforms;
}

std::string node_path(const GltfFile& gltf, const std::vector<WalkedNode>& walk, std::size_t at) {
  std::vector<std::size_t> chain;
  for (; at != SIZE_MAX && chain.size() < kMaxPathNames; at = walk[at].parent) chain.push_back(walk[at].node);
  std::string path = at == SIZE_MAX ? "" : ".../";
  for (auto node = chain.rbegin(); node != chain.rend(); ++node) {
    if (node != chain.rbegin()) path.push_back('/');
    path += short_name(gltf, *node);
  }
  return path;
}

}  // namespace relume
