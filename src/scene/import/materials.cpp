// SPDX-License-Identifier: MIT
#include "scene/import/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/import/images.h"
#include "scene/import/import_error.h"
#include "scene/import/unique_names.h"

namespace relume {
namespace {

constexpr std::uint64_t kImagesInAll = 4;  // times the pixels of one image that SceneLimits allows

/// Materials to be named in one warning per kind.
struct Counts {
  std::size_t clamped = 0;
  std::size_t transmission_textures = 0;
  std::size_t volumes = 0;
  std::size_t not_finite = 0;
  std::size_t without_image = 0;
  std::size_t far_uv_set = 0;
};

class Converter {
 public:
  Converter(const GltfFile& gltf, const SceneLimits& limits, Scene& scene)
      : gltf_(gltf), limits_(limits), scene_(scene), pixels_left_(limits.max_image_pixels * kImagesInAll) {}

  Result<void> convert_all() {
    UniqueNames names;
    for (std::size_t i = 0; i < gltf_.model.materials.size(); ++i) {
      const auto& source = gltf_.model.materials[i];
      SceneMaterial material;
      material.name = names.unique(source.name.empty() ? fmt::format("material{}", i) : source.name);
      convert_factors(source, material);
      if (auto result = convert_textures(source, material); !result) return result;
      scene_.materials.push_back(std::move(material));
    }
    report();
    return {};
  }

 private:
  void convert_factors(const tinygltf::Material& source, SceneMaterial& material) {
    const auto& base = source.pbrMetallicRoughness.baseColorFactor;
    material.base_color = clamped({base[0], base[1], base[2]});
    material.alpha = std::clamp(base[3], 0.0, 1.0);
    material.alpha_mode = source.alphaMode == "MASK"    ? AlphaMode::mask
                          : source.alphaMode == "BLEND" ? AlphaMode::blend
                                                        : AlphaMode::opaque;
    material.alpha_cutoff = source.alphaCutoff;
    material.transmission = transmission(source);
    material.double_sided = source.doubleSided;
    material.unlit = source.extensions.count("KHR_materials_unlit") != 0;
    const auto strength = source.extensions.find("KHR_materials_emissive_strength");
    double scale = 1.0;
    if (strength != source.extensions.end() && strength->second.Has("emissiveStrength")) {
      scale = strength->second.Get("emissiveStrength").GetNumberAsDouble();
    }
    material.emission = emission(source.emissiveFactor, scale);
  }

  double transmission(const tinygltf::Material& source) {
    if (source.extensions.count("KHR_materials_volume") != 0) ++counts_.volumes;
    const auto said = source.extensions.find("KHR_materials_transmission");
    if (said == source.extensions.end() || !said->second.Has("transmissionFactor")) return 0.0;
    const double factor = said->second.Get("transmissionFactor").GetNumberAsDouble();
    if (factor > 0.0 && said->second.Has("transmissionTexture")) ++counts_.transmission_textures;
    return factor;
  }

  Rgb clamped(const Rgb& base) {
    const Rgb inside = glm::clamp(base, Rgb(0.0), Rgb(1.0));
    if (inside != base) ++counts_.clamped;
    return inside;
  }

  Rgb emission(const std::vector<double>& factor, double strength) {
    const Rgb said = Rgb{factor[0], factor[1], factor[2]} * strength;
    const bool is_finite = std::isfinite(said.x) && std::isfinite(said.y) && std::isfinite(said.z);
    if (!is_finite || said.x < 0.0 || said.y < 0.0 || said.z < 0.0) ++counts_.not_finite;
    return is_finite ? glm::max(said, Rgb(0.0)) : Rgb(0.0);
  }

  Result<void> convert_textures(const tinygltf::Material& source, SceneMaterial& material) {
    auto base = texture_use(source.pbrMetallicRoughness.baseColorTexture);
    if (!base) return tl::unexpected(base.error());
    material.base_color_texture = *base;
    auto emitted = texture_use(source.emissiveTexture);
    if (!emitted) return tl::unexpected(emitted.error());
    material.emission_texture = *emitted;
    return {};
  }

  Result<std::optional<TextureUse>> texture_use(const tinygltf::TextureInfo& info) {
    if (info.index < 0) return std::nullopt;
    const auto& texture = gltf_.model.textures[static_cast<std::size_t>(info.index)];
    if (texture.source < 0) {
      ++counts_.without_image;
      return std::nullopt;
    }
    TextureUse use;
    use.uv_set = static_cast<std::uint32_t>(info.texCoord);
    apply_transform(info, use);
    if (use.uv_set > 1) {
      ++counts_.far_uv_set;
      return std::nullopt;
    }
    if (texture.sampler >= 0) {
      const auto& sampler = gltf_.model.samplers[static_cast<std::size_t>(texture.sampler)];
      use.wrap_s = wrap_mode(sampler.wrapS);
      use.wrap_t = wrap_mode(sampler.wrapT);
    }
    const auto image = scene_image(static_cast<std::size_t>(texture.source));
    if (!image) return tl::unexpected(image.error());
    use.image = *image;
    return use;
  }

  static WrapMode wrap_mode(int code) {
    if (code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return WrapMode::clamp_to_edge;
    if (code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return WrapMode::mirrored_repeat;
    return WrapMode::repeat;
  }

  /// KHR_texture_transform: translation x rotation x scale. The rotation is the one that its sample model and
  /// all viewers use, counter-clockwise where v points down (github.com/KhronosGroup/glTF/issues/1563), not
  /// the one of the GLSL in the extension's text.
  static void apply_transform(const tinygltf::TextureInfo& info, TextureUse& use) {
    const auto found = info.extensions.find("KHR_texture_transform");
    if (found == info.extensions.end()) return;
    const tinygltf::Value& said = found->second;
    const auto pair = [&](const char* key, double otherwise) {
      if (!said.Has(key)) return glm::dvec2(otherwise);
      return glm::dvec2(said.Get(key).Get(0).GetNumberAsDouble(), said.Get(key).Get(1).GetNumberAsDouble());
    };
    const glm::dvec2 offset = pair("offset", 0.0);
    const glm::dvec2 scale = pair("scale", 1.0);
    const double angle = said.Has("rotation") ? said.Get("rotation").GetNumberAsDouble() : 0.0;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const glm::dmat3 translation(1, 0, 0, 0, 1, 0, offset.x, offset.y, 1);
    const glm::dmat3 rotation(c, -s, 0, s, c, 0, 0, 0, 1);
    const glm::dmat3 scaling(scale.x, 0, 0, 0, scale.y, 0, 0, 0, 1);
    use.transform = translation * rotation * scaling;
    if (said.Has("texCoord")) use.uv_set = static_cast<std::uint32_t>(said.Get("texCoord").GetNumberAsInt());
  }

  Result<std::uint32_t> scene_image(std::size_t gltf_image) {
    if (const auto known = images_.find(gltf_image); known != images_.end()) return known->second;
    auto image = decode_image(gltf_.data.images[gltf_image], std::min(limits_.max_image_pixels, pixels_left_),
                              gltf_.name, json_path("images", gltf_image));
    if (!image) return tl::unexpected(image.error());
    pixels_left_ -= std::uint64_t{image->width} * image->height;
    scene_.images.push_back(std::move(*image));
    const auto index = static_cast<std::uint32_t>(scene_.images.size() - 1);
    images_[gltf_image] = index;
    return index;
  }

  void warn(std::size_t count, const char* what) {
    if (count != 0) scene_.warnings.push_back(fmt::format("{}: {}: {}", gltf_.name, what, count));
  }

  void report() {
    warn(counts_.clamped, "materials with a base colour outside 0 to 1, clamped");
    warn(counts_.not_finite, "materials with an emission below 0 or not finite, set to 0");
    warn(counts_.transmission_textures,
         "materials with a transmission texture, of which only the factor counts");
    warn(counts_.volumes,
         "materials with KHR_materials_volume, treated as thin: light passes straight and uncoloured");
    warn(counts_.without_image, "textures without an image that Relume reads, left out");
    warn(counts_.far_uv_set, "textures that use a TEXCOORD above 1, left out");
  }

  const GltfFile& gltf_;
  const SceneLimits& limits_;
  Scene& scene_;
  Counts counts_;
  std::map<std::size_t, std::uint32_t> images_;
  std::uint64_t pixels_left_;
};

}  // namespace

Result<void> convert_materials(const GltfFile& gltf, const SceneLimits& limits, Scene& scene) {
  return Converter(gltf, limits, scene).convert_all();
}

std::uint32_t default_material(Scene& scene, std::uint32_t gltf_materials) {
  if (scene.materials.size() == gltf_materials) {
    UniqueNames names;
    for (const auto& material : scene.materials) names.unique(material.name);
    SceneMaterial material;
    material.name = names.unique("no material");
    material.base_color = Rgb(kNoMaterialAlbedo);
    scene.materials.push_back(std::move(material));
  }
  return gltf_materials;
}

}  // namespace relume
