// SPDX-License-Identifier: MIT
#include "scene/import/rules.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/quantities.h"
#include "scene/import/import_error.h"

namespace relume {
namespace {

using Json = nlohmann::json;

enum class Kind { object, array, index, integer, number, positive, numbers, boolean, text, word, code };

/// What a property must be. In `path`, '*' stands for every element of an array or every member of an object.
struct Rule {
  std::string_view path;
  Kind kind;
  bool required = false;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::size_t length = 0;  ///< numbers: exact count, 0 = any; array: least count
  std::string_view of =
      {};  ///< index: the array that it points into; word, code: the allowed ones, with '|' between
};

constexpr double kMaxOffset = 9007199254740992.0;  // 2^53: every integer below is exact in JSON
constexpr double kMaxCount = 2147483647.0;         // tinygltf keeps counts and sparse offsets in int
constexpr std::string_view kVertexTypes = "5120|5121|5122|5123|5125|5126";

constexpr Rule object(std::string_view path) {
  return {path, Kind::object};
}
constexpr Rule array(std::string_view path, std::size_t least = 0) {
  return {.path = path, .kind = Kind::array, .length = least};
}
constexpr Rule index(std::string_view path, std::string_view of) {
  return {.path = path, .kind = Kind::index, .of = of};
}
constexpr Rule integer(std::string_view path, double min, double max) {
  return {.path = path, .kind = Kind::integer, .min = min, .max = max};
}
constexpr Rule number(std::string_view path) {
  return {path, Kind::number};
}
constexpr Rule number(std::string_view path, double min, double max) {
  return {.path = path, .kind = Kind::number, .min = min, .max = max};
}
constexpr Rule positive(std::string_view path) {
  return {path, Kind::positive};
}
constexpr Rule numbers(std::string_view path, std::size_t length) {
  return {.path = path, .kind = Kind::numbers, .length = length};
}
constexpr Rule boolean(std::string_view path) {
  return {path, Kind::boolean};
}
constexpr Rule text(std::string_view path) {
  return {path, Kind::text};
}
constexpr Rule word(std::string_view path, std::string_view of) {
  return {.path = path, .kind = Kind::word, .of = of};
}
constexpr Rule code(std::string_view path, std::string_view of) {
  return {.path = path, .kind = Kind::code, .of = of};
}
constexpr Rule required(Rule rule) {
  rule.required = true;
  return rule;
}

// A container stands before what it holds: a rule may rely on those above it.
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
    integer("nodes/*/extras/relume/quality", 1, 1 << 24),
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

/// Where the walk stands; the text of the path is only made for a message.
struct Place {
  const Place* parent;
  std::string_view key;
  std::size_t element;  ///< used when `key` is empty
};

std::string path_of(const Place* place) {
  if (!place) return "";
  return path_of(place->parent) + "/" +
         (place->key.empty() ? std::to_string(place->element) : std::string(place->key));
}

std::string described(const Json& value) {
  if (value.is_object()) return fmt::format("an object with {} members", value.size());
  if (value.is_array()) return fmt::format("an array of {} values", value.size());
  const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() > 80 ? text.substr(0, 80) + "..." : text;
}

const Json* find_path(const Json& document, std::string_view path) {
  const Json* at = &document;
  while (!path.empty()) {
    const auto slash = path.find('/');
    if (!at->is_object()) return nullptr;
    const auto member = at->find(path.substr(0, slash));
    if (member == at->end()) return nullptr;
    at = &*member;
    path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  }
  return at;
}

bool is_one_of(std::string_view value, std::string_view allowed) {
  while (!allowed.empty()) {
    const auto bar = allowed.find('|');
    if (allowed.substr(0, bar) == value) return true;
    allowed = bar == std::string_view::npos ? std::string_view() : allowed.substr(bar + 1);
  }
  return false;
}

bool is_in_range(const Json& value, const Rule& rule) {
  const double number = value.get<double>();
  return std::isfinite(number) && number >= rule.min && number <= rule.max;
}

bool is_numbers(const Json& value, std::size_t length) {
  if (!value.is_array() || (length != 0 && value.size() != length)) return false;
  for (const Json& element : value) {
    if (!element.is_number()) return false;
  }
  return true;
}

bool obeys(const Json& value, const Rule& rule, std::size_t index_limit) {
  switch (rule.kind) {
    case Kind::object:
      return value.is_object();
    case Kind::array:
      return value.is_array() && value.size() >= rule.length;
    case Kind::index:
      return value.is_number_unsigned() && value.get<std::uint64_t>() < index_limit;
    case Kind::integer:
      return value.is_number_integer() && is_in_range(value, rule);
    case Kind::number:
      return value.is_number() && is_in_range(value, rule);
    case Kind::positive:
      return value.is_number() && value.get<double>() > 0.0;
    case Kind::numbers:
      return is_numbers(value, rule.length);
    case Kind::boolean:
      return value.is_boolean();
    case Kind::text:
      return value.is_string();
    case Kind::word:
      return value.is_string() && is_one_of(value.get_ref<const std::string&>(), rule.of);
    case Kind::code:
      return value.is_number_unsigned() && is_one_of(std::to_string(value.get<std::uint64_t>()), rule.of);
  }
  return false;
}

std::string range_text(const Rule& rule) {
  if (std::isinf(rule.min) && std::isinf(rule.max)) return "";
  return fmt::format(" from {} to {}", rule.min, rule.max);
}

std::string expected_text(const Rule& rule, std::size_t index_limit) {
  switch (rule.kind) {
    case Kind::object:
      return "an object";
    case Kind::array:
      return rule.length == 0 ? "an array" : fmt::format("an array of at least {}", rule.length);
    case Kind::index:
      return fmt::format("an index into the {} {}", index_limit, rule.of);
    case Kind::integer:
      return "an integer" + range_text(rule);
    case Kind::number:
      return "a number" + range_text(rule);
    case Kind::positive:
      return "a number above 0";
    case Kind::numbers:
      return rule.length == 0 ? "an array of numbers" : fmt::format("an array of {} numbers", rule.length);
    case Kind::boolean:
      return "true or false";
    case Kind::text:
      return "a string";
    case Kind::word:
    case Kind::code:
      return fmt::format("one of {}", rule.of);
  }
  return "";
}

/// Checks one rule everywhere that its path leads to.
class RuleWalk {
 public:
  RuleWalk(const Json& document, const Rule& rule, const std::string& file) : rule_(rule), file_(file) {
    if (rule.kind != Kind::index) return;
    const Json* target = find_path(document, rule.of);
    if (target && target->is_array()) index_limit_ = target->size();
  }

  Result<void> walk(const Json& value, std::string_view path, const Place* place) const {
    if (path.empty()) return check(value, place);
    const auto slash = path.find('/');
    const auto key = path.substr(0, slash);
    const auto rest = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
    if (key == "*") return walk_all(value, rest, place);
    if (!value.is_object()) return {};
    const Place next{place, key, 0};
    const auto member = value.find(key);
    if (member != value.end()) return walk(*member, rest, &next);
    if (rule_.required && rest.empty()) return complain(&next, "nothing");
    return {};
  }

 private:
  Result<void> walk_all(const Json& value, std::string_view rest, const Place* place) const {
    if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        const Place next{place, {}, i};
        if (auto result = walk(value[i], rest, &next); !result) return result;
      }
    } else if (value.is_object()) {
      for (auto member = value.begin(); member != value.end(); ++member) {
        const Place next{place, member.key(), 0};
        if (auto result = walk(*member, rest, &next); !result) return result;
      }
    }
    return {};
  }

  Result<void> check(const Json& value, const Place* place) const {
    if (obeys(value, rule_, index_limit_)) return {};
    return complain(place, described(value));
  }

  Result<void> complain(const Place* place, const std::string& found) const {
    return import_error(file_, path_of(place), expected_text(rule_, index_limit_), found);
  }

  const Rule& rule_;
  const std::string& file_;
  std::size_t index_limit_ = 0;
};

}  // namespace

Result<void> check_rules(const Json& document, const std::string& file) {
  if (!document.is_object()) return import_error(file, "/", "a JSON object", described(document));
  for (const Rule& rule : kRules) {
    if (auto result = RuleWalk(document, rule, file).walk(document, rule.path, nullptr); !result)
      return result;
  }
  return {};
}

}  // namespace relume
