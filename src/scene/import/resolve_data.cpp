// SPDX-License-Identifier: MIT
#include "scene/import/resolve_data.h"

#include <fmt/format.h>

#include <set>
#include <string>

#include "scene/import/import_error.h"
#include "scene/import/json_access.h"
#include "scene/import/meshopt_decode.h"
#include "scene/import/scene_folder.h"

namespace relume {
namespace {

using Json = nlohmann::json;
using ByteSpan = std::span<const std::byte>;

constexpr const char* kMeshopt = "EXT_meshopt_compression";

struct Source {
  const Json& document;
  const GltfContainer& container;
  const std::filesystem::path& scene_file;
  const SceneLimits& limits;
  std::string name;
};

/// What may still be taken: the limit holds for all that a scene file makes us read or unpack, so that many
/// names of one file do not add up.
std::uint64_t remaining_bytes(const Source& source, const GltfData& data) {
  std::uint64_t taken = 0;
  for (const auto& bytes : data.owned) taken += bytes.size();
  return taken < source.limits.max_file_bytes ? source.limits.max_file_bytes - taken : 0;
}

Result<ByteSpan> read_owned(const Source& source, const std::string& place, const std::string& uri,
                            GltfData& data) {
  auto bytes = read_uri(source.scene_file, place, uri, remaining_bytes(source, data));
  if (!bytes) return tl::unexpected(bytes.error());
  return ByteSpan(data.owned.emplace_back(std::move(*bytes)));
}

/// Buffers that hold bytes which some view needs.
std::set<std::size_t> needed_buffers(const Json& document) {
  std::set<std::size_t> needed;
  for (const Json& view : array_of(document, "bufferViews")) {
    const Json* packed = extension_of(view, kMeshopt);
    needed.insert(size_of(packed ? *packed : view, "buffer"));
  }
  return needed;
}

Result<ByteSpan> load_buffer(const Source& source, std::size_t index, GltfData& data) {
  const Json& buffer = source.document["buffers"][index];
  const std::string place = json_path("buffers", index);
  const std::size_t length = size_of(buffer, "byteLength");
  ByteSpan bytes;
  if (const auto uri = buffer.find("uri"); uri != buffer.end()) {
    auto loaded = read_owned(source, place + "/uri", uri->get_ref<const std::string&>(), data);
    if (!loaded) return loaded;
    bytes = *loaded;
  } else if (index == 0 && source.container.binary) {
    bytes = *source.container.binary;
  } else {
    return import_error(source.name, place, "a uri", "none");
  }
  if (bytes.size() < length) {
    return import_error(source.name, place + "/byteLength",
                        fmt::format("at most the {} bytes there are", bytes.size()),
                        fmt::format("{}", length));
  }
  return bytes.first(length);
}

Result<std::vector<ByteSpan>> load_buffers(const Source& source, GltfData& data) {
  std::vector<ByteSpan> buffers(array_of(source.document, "buffers").size());
  for (const std::size_t index : needed_buffers(source.document)) {
    const auto bytes = load_buffer(source, index, data);
    if (!bytes) return tl::unexpected(bytes.error());
    buffers[index] = *bytes;
  }
  return buffers;
}

Result<ByteSpan> load_view(const Source& source, std::size_t index, const std::vector<ByteSpan>& buffers,
                           GltfData& data) {
  const Json& view = source.document["bufferViews"][index];
  const Json* packed = extension_of(view, kMeshopt);
  const Json& from = packed ? *packed : view;
  const ByteSpan bytes =
      buffers[size_of(from, "buffer")].subspan(size_of(from, "byteOffset"), size_of(from, "byteLength"));
  if (!packed) return bytes;
  const std::string mode = packed->value("mode", std::string());
  const std::string filter = packed->value("filter", std::string("NONE"));
  const CompressedView compressed{mode, filter, size_of(*packed, "count"), size_of(*packed, "byteStride")};
  const std::string place = json_path("bufferViews", index) + "/extensions/" + kMeshopt;
  if (const auto left = remaining_bytes(source, data); compressed.count * compressed.stride > left) {
    return import_error(source.name, place, fmt::format("at most {} bytes", left),
                        fmt::format("{}", compressed.count * compressed.stride));
  }
  auto decoded = decode_compressed_view(compressed, bytes, source.name, place);
  if (!decoded) return tl::unexpected(decoded.error());
  return ByteSpan(data.owned.emplace_back(std::move(*decoded)));
}

void add_image_of(const Json& document, const Json& holder, const char* texture,
                  std::set<std::size_t>& images) {
  const auto use = holder.find(texture);
  if (use == holder.end()) return;
  const Json& source = array_of(document, "textures")[size_of(*use, "index")];
  if (source.contains("source")) images.insert(size_of(source, "source"));
}

std::set<std::size_t> needed_images(const Json& document) {
  std::set<std::size_t> images;
  for (const Json& material : array_of(document, "materials")) {
    add_image_of(document, material, "emissiveTexture", images);
    const auto pbr = material.find("pbrMetallicRoughness");
    if (pbr != material.end()) add_image_of(document, *pbr, "baseColorTexture", images);
  }
  return images;
}

Result<ByteSpan> load_image(const Source& source, std::size_t index, GltfData& data) {
  const Json& image = source.document["images"][index];
  const std::string place = json_path("images", index);
  if (image.contains("bufferView")) return data.views[size_of(image, "bufferView")];
  const auto uri = image.find("uri");
  if (uri == image.end()) return import_error(source.name, place, "a uri or a bufferView", "neither");
  return read_owned(source, place + "/uri", uri->get_ref<const std::string&>(), data);
}

}  // namespace

Result<GltfData> resolve_data(const Json& document, const GltfContainer& container,
                              const std::filesystem::path& scene_file, const SceneLimits& limits) {
  const Source source{document, container, scene_file, limits, scene_file.filename().string()};
  GltfData data;
  const auto buffers = load_buffers(source, data);
  if (!buffers) return tl::unexpected(buffers.error());
  data.views.resize(array_of(document, "bufferViews").size());
  for (std::size_t i = 0; i < data.views.size(); ++i) {
    const auto bytes = load_view(source, i, *buffers, data);
    if (!bytes) return tl::unexpected(bytes.error());
    data.views[i] = *bytes;
  }
  data.images.resize(array_of(document, "images").size());
  for (const std::size_t index : needed_images(document)) {
    const auto bytes = load_image(source, index, data);
    if (!bytes) return tl::unexpected(bytes.error());
    data.images[index] = *bytes;
  }
  return data;
}

}  // namespace relume
