// SPDX-License-Identifier: MIT
#include "scene/import/rule_table.h"

#include <array>

#include "core/quantities.h"

namespace relume {
namespace {

constexpr double kMaxOffset = 9007199254740992.0;  // 2^53: every integer below is exact in JSON
constexpr double kMaxCount = 2147483647.0;         // tinygltf keeps counts and sparse offsets in int
constexpr std::string_view kVertexTypes = "5120|5121|5122|5123|5125|5126";

constexpr Rule object(std::string_view path) {
  return {path, RuleKind::object};
}
constexpr Rule array(std::string_view path, std::size_t least = 0) {
  return {.path = path, .kind = RuleKind::array, .length = least};
}
constexpr Rule index(std::string_view path, std::string_view of) {
  return {.path = path, .kind = RuleKind::index, .of = of};
}
constexpr Rule integer(std::string_view path, double min, double max) {
  return {.path = path, .kind = RuleKind::integer, .min = min, .max = max};
}
constexpr Rule number(std::string_view path) {
  return {path, RuleKind::number};
}
constexpr Rule number(std::string_view path, double min, double max) {
  return {.path = path, .kind = RuleKind::number, .min = min, .max = max};
}
constexpr Rule positive(std::string_view path) {
  return {path, RuleKind::positive};
}
constexpr Rule numbers(std::string_view path, std::size_t length) {
  return {.path = path, .kind = RuleKind::numbers, .length = length};
}
constexpr Rule boolean(std::string_view path) {
  return {path, RuleKind::boolean};
}
constexpr Rule text(std::string_view path) {
  return {path, RuleKind::text};
}
constexpr Rule word(std::string_view path, std::string_view of) {
  return {.path = path, .kind = RuleKind::word, .of = of};
}
constexpr Rule code(std::string_view path, std::string_view of) {
  return {.path = path, .kind = RuleKind::code, .of = of};
}
constexpr Rule required(Rule rule) {
  rule.required = true;
  return rule;
}

constexpr auto kRules = std::to_array<Rule>({
    required(object("asset")),
    required(text("asset/version")),
    text("asset/minVersion"),
    array("extensionsUsed"),
    text("extensionsUsed/*"),
    array("extensionsRequired"),
    text("extensionsRequired/*"),
    object("extensions"),

    array("buffers"),
    object("buffers/*"),
    required(integer("buffers/*/byteLength", 1, kMaxOffset)),
    text("buffers/*/uri"),
    object("buffers/*/extensions"),
    object("buffers/*/extensions/EXT_meshopt_compression"),
    boolean("buffers/*/extensions/EXT_meshopt_compression/fallback"),

    array("bufferViews"),
    object("bufferViews/*"),
    required(index("bufferViews/*/buffer", "buffers")),
    integer("bufferViews/*/byteOffset", 0, kMaxOffset),
    required(integer("bufferViews/*/byteLength", 1, kMaxOffset)),
    integer("bufferViews/*/byteStride", 4, 252),
    object("bufferViews/*/extensions"),
    object("bufferViews/*/extensions/EXT_meshopt_compression"),
    required(index("bufferViews/*/extensions/EXT_meshopt_compression/buffer", "buffers")),
    integer("bufferViews/*/extensions/EXT_meshopt_compression/byteOffset", 0, kMaxOffset),
    required(integer("bufferViews/*/extensions/EXT_meshopt_compression/byteLength", 1, kMaxOffset)),
    required(integer("bufferViews/*/extensions/EXT_meshopt_compression/byteStride", 2, 256)),
    required(integer("bufferViews/*/extensions/EXT_meshopt_compression/count", 1, kMaxCount)),
    required(word("bufferViews/*/extensions/EXT_meshopt_compression/mode", "ATTRIBUTES|TRIANGLES|INDICES")),
    word("bufferViews/*/extensions/EXT_meshopt_compression/filter", "NONE|OCTAHEDRAL|QUATERNION|EXPONENTIAL"),

    array("accessors"),
    object("accessors/*"),
    index("accessors/*/bufferView", "bufferViews"),
    integer("accessors/*/byteOffset", 0, kMaxOffset),
    required(code("accessors/*/componentType", kVertexTypes)),
    boolean("accessors/*/normalized"),
    required(integer("accessors/*/count", 1, kMaxCount)),
    required(word("accessors/*/type", "SCALAR|VEC2|VEC3|VEC4|MAT2|MAT3|MAT4")),
    numbers("accessors/*/min", 0),
    numbers("accessors/*/max", 0),
    object("accessors/*/sparse"),
    required(integer("accessors/*/sparse/count", 1, kMaxCount)),
    required(object("accessors/*/sparse/indices")),
    required(index("accessors/*/sparse/indices/bufferView", "bufferViews")),
    integer("accessors/*/sparse/indices/byteOffset", 0, kMaxCount),
    required(code("accessors/*/sparse/indices/componentType", "5121|5123|5125")),
    required(object("accessors/*/sparse/values")),
    required(index("accessors/*/sparse/values/bufferView", "bufferViews")),
    integer("accessors/*/sparse/values/byteOffset", 0, kMaxCount),

    array("images"),
    object("images/*"),
    text("images/*/uri"),
    index("images/*/bufferView", "bufferViews"),
    array("samplers"),
    object("samplers/*"),
    code("samplers/*/wrapS", "33071|33648|10497"),
    code("samplers/*/wrapT", "33071|33648|10497"),
    array("textures"),
    object("textures/*"),
    index("textures/*/source", "images"),
    index("textures/*/sampler", "samplers"),

    array("materials"),
    object("materials/*"),
    text("materials/*/name"),
    object("materials/*/pbrMetallicRoughness"),
    numbers("materials/*/pbrMetallicRoughness/baseColorFactor", 4),
    object("materials/*/pbrMetallicRoughness/baseColorTexture"),
    required(index("materials/*/pbrMetallicRoughness/baseColorTexture/index", "textures")),
    integer("materials/*/pbrMetallicRoughness/baseColorTexture/texCoord", 0, 255),
    object("materials/*/pbrMetallicRoughness/baseColorTexture/extensions"),
    object("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform"),
    numbers("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset", 2),
    number("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/rotation"),
    numbers("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale", 2),
    integer("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/texCoord", 0,
            255),
    object("materials/*/pbrMetallicRoughness/metallicRoughnessTexture"),
    required(index("materials/*/pbrMetallicRoughness/metallicRoughnessTexture/index", "textures")),
    object("materials/*/normalTexture"),
    required(index("materials/*/normalTexture/index", "textures")),
    object("materials/*/occlusionTexture"),
    required(index("materials/*/occlusionTexture/index", "textures")),
    numbers("materials/*/emissiveFactor", 3),
    object("materials/*/emissiveTexture"),
    required(index("materials/*/emissiveTexture/index", "textures")),
    integer("materials/*/emissiveTexture/texCoord", 0, 255),
    object("materials/*/emissiveTexture/extensions"),
    object("materials/*/emissiveTexture/extensions/KHR_texture_transform"),
    numbers("materials/*/emissiveTexture/extensions/KHR_texture_transform/offset", 2),
    number("materials/*/emissiveTexture/extensions/KHR_texture_transform/rotation"),
    numbers("materials/*/emissiveTexture/extensions/KHR_texture_transform/scale", 2),
    integer("materials/*/emissiveTexture/extensions/KHR_texture_transform/texCoord", 0, 255),
    word("materials/*/alphaMode", "OPAQUE|MASK|BLEND"),
    number("materials/*/alphaCutoff", 0, 1e6),
    boolean("materials/*/doubleSided"),
    object("materials/*/extensions"),
    object("materials/*/extensions/KHR_materials_unlit"),
    object("materials/*/extensions/KHR_materials_emissive_strength"),
    number("materials/*/extensions/KHR_materials_emissive_strength/emissiveStrength", 0, 1e30),
    object("materials/*/extensions/KHR_materials_transmission"),
    number("materials/*/extensions/KHR_materials_transmission/transmissionFactor", 0, 1),
    object("materials/*/extensions/KHR_materials_transmission/transmissionTexture"),

    array("meshes"),
    object("meshes/*"),
    text("meshes/*/name"),
    required(array("meshes/*/primitives", 1)),
    object("meshes/*/primitives/*"),
    required(object("meshes/*/primitives/*/attributes")),
    index("meshes/*/primitives/*/attributes/*", "accessors"),
    index("meshes/*/primitives/*/indices", "accessors"),
    index("meshes/*/primitives/*/material", "materials"),
    integer("meshes/*/primitives/*/mode", 0, 6),
    array("meshes/*/primitives/*/targets"),
    object("meshes/*/primitives/*/targets/*"),
    index("meshes/*/primitives/*/targets/*/*", "accessors"),
    object("meshes/*/primitives/*/extensions"),

    array("cameras"),
    object("cameras/*"),
    required(word("cameras/*/type", "perspective|orthographic")),
    object("cameras/*/perspective"),
    required(number("cameras/*/perspective/yfov", 1e-6, kPi)),
    required(number("cameras/*/perspective/znear", 0, 1e30)),
    object("cameras/*/orthographic"),
    required(number("cameras/*/orthographic/xmag")),
    required(number("cameras/*/orthographic/ymag")),
    required(number("cameras/*/orthographic/zfar")),
    required(number("cameras/*/orthographic/znear")),

    object("extensions/KHR_lights_punctual"),
    required(array("extensions/KHR_lights_punctual/lights")),
    object("extensions/KHR_lights_punctual/lights/*"),
    text("extensions/KHR_lights_punctual/lights/*/name"),
    required(word("extensions/KHR_lights_punctual/lights/*/type", "directional|point|spot")),
    numbers("extensions/KHR_lights_punctual/lights/*/color", 3),
    number("extensions/KHR_lights_punctual/lights/*/color/*", 0, 1e30),
    number("extensions/KHR_lights_punctual/lights/*/intensity", 0, 1e30),
    positive("extensions/KHR_lights_punctual/lights/*/range"),
    object("extensions/KHR_lights_punctual/lights/*/spot"),
    number("extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", 0, kPi / 2),
    number("extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", 1e-6, kPi / 2 + 1e-6),

    array("skins"),
    object("skins/*"),
    required(array("skins/*/joints", 1)),
    index("skins/*/joints/*", "nodes"),
    index("skins/*/skeleton", "nodes"),
    index("skins/*/inverseBindMatrices", "accessors"),

    array("nodes"),
    object("nodes/*"),
    text("nodes/*/name"),
    array("nodes/*/children"),
    index("nodes/*/children/*", "nodes"),
    index("nodes/*/mesh", "meshes"),
    index("nodes/*/camera", "cameras"),
    index("nodes/*/skin", "skins"),
    numbers("nodes/*/matrix", 16),
    numbers("nodes/*/translation", 3),
    numbers("nodes/*/rotation", 4),
    numbers("nodes/*/scale", 3),
    object("nodes/*/extensions"),
    object("nodes/*/extensions/KHR_lights_punctual"),
    required(index("nodes/*/extensions/KHR_lights_punctual/light", "extensions/KHR_lights_punctual/lights")),
    object("nodes/*/extensions/EXT_mesh_gpu_instancing"),
    required(object("nodes/*/extensions/EXT_mesh_gpu_instancing/attributes")),
    index("nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*", "accessors"),
    object("nodes/*/extras/relume"),
    boolean("nodes/*/extras/relume/static"),
    word("nodes/*/extras/relume/receiver", "lightmap|clusters|probes|none"),
    text("nodes/*/extras/relume/system"),
    positive("nodes/*/extras/relume/texel_size"),
    integer("nodes/*/extras/relume/quality", 8, 1 << 20),
    integer("nodes/*/extras/relume/budget", 1, 1 << 24),
    boolean("nodes/*/extras/relume/emitter"),

    array("scenes"),
    object("scenes/*"),
    array("scenes/*/nodes"),
    index("scenes/*/nodes/*", "nodes"),
    index("scene", "scenes"),

    array("animations"),
    object("animations/*"),
    array("animations/*/channels"),
    object("animations/*/channels/*"),
    required(object("animations/*/channels/*/target")),
    index("animations/*/channels/*/target/node", "nodes"),
    required(text("animations/*/channels/*/target/path")),
});

}  // namespace

std::span<const Rule> gltf_rules() {
  return kRules;
}

}  // namespace relume
