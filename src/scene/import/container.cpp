// SPDX-License-Identifier: MIT
#include "scene/import/container.h"

#include <fmt/format.h>

#include "scene/import/import_error.h"

namespace relume {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67;        // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;    // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;  // "BIN\0"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

std::uint32_t read_u32(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[offset + i]) << (8 * i);
  return value;
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string byte_at(std::size_t offset) {
  return fmt::format("byte {}", offset);
}

/// The file's bytes without what follows the length that its header states.
Result<std::span<const std::byte>> check_header(std::span<const std::byte> bytes, const std::string& file) {
  if (bytes.size() < kHeaderBytes) {
    return import_error(file, "byte 0", "a GLB header of 12 bytes", fmt::format("{} bytes", bytes.size()));
  }
  if (const auto magic = read_u32(bytes, 0); magic != kMagic) {
    return import_error(file, "byte 0", "the magic \"glTF\"", fmt::format("{:#010x}", magic));
  }
  if (const auto version = read_u32(bytes, 4); version != 2) {
    return import_error(file, "byte 4", "GLB version 2", fmt::format("{}", version));
  }
  const std::size_t length = read_u32(bytes, 8);
  if (length > bytes.size() || length < kHeaderBytes + kChunkHeaderBytes) {
    return import_error(file, "byte 8", fmt::format("a length from 20 to the file's {} bytes", bytes.size()),
                        fmt::format("{}", length));
  }
  return bytes.first(length);
}

struct Chunk {
  std::uint32_t type = 0;
  std::span<const std::byte> data;
};

Result<Chunk> read_chunk(std::span<const std::byte> bytes, std::size_t offset, const std::string& file) {
  if (bytes.size() - offset < kChunkHeaderBytes) {
    return import_error(file, byte_at(offset), "a chunk header of 8 bytes",
                        fmt::format("{} bytes", bytes.size() - offset));
  }
  const std::size_t length = read_u32(bytes, offset);
  const std::size_t rest = bytes.size() - offset - kChunkHeaderBytes;
  if (length > rest) {
    return import_error(file, byte_at(offset), fmt::format("a chunk of at most {} bytes", rest),
                        fmt::format("{} bytes", length));
  }
  return Chunk{read_u32(bytes, offset + 4), bytes.subspan(offset + kChunkHeaderBytes, length)};
}

Result<GltfContainer> split_glb(std::span<const std::byte> all, const std::string& file) {
  const auto bytes = check_header(all, file);
  if (!bytes) return tl::unexpected(bytes.error());
  GltfContainer container;
  if (bytes->size() < all.size()) {
    container.warnings.push_back(
        fmt::format("{}: {} bytes after the end of the GLB were ignored", file, all.size() - bytes->size()));
  }
  const auto json = read_chunk(*bytes, kHeaderBytes, file);
  if (!json) return tl::unexpected(json.error());
  if (json->type != kJsonChunk) {
    return import_error(file, byte_at(kHeaderBytes + 4), "a first chunk of type JSON",
                        fmt::format("type {:#010x}", json->type));
  }
  container.json = as_text(json->data);
  container.json_offset = kHeaderBytes + kChunkHeaderBytes;
  std::size_t offset = container.json_offset + json->data.size();
  while (offset < bytes->size()) {
    const auto chunk = read_chunk(*bytes, offset, file);
    if (!chunk) return tl::unexpected(chunk.error());
    if (chunk->type == kBinaryChunk && !container.binary) container.binary = chunk->data;
    offset += kChunkHeaderBytes + chunk->data.size();
  }
  return container;
}

bool is_called_glb(const std::string& file) {
  return file.size() >= 4 && file.compare(file.size() - 4, 4, ".glb") == 0;
}

}  // namespace

Result<GltfContainer> split_container(std::span<const std::byte> bytes, const std::string& file) {
  const bool has_magic = bytes.size() >= 4 && read_u32(bytes, 0) == kMagic;
  if (has_magic || is_called_glb(file)) return split_glb(bytes, file);
  GltfContainer container;
  container.json = as_text(bytes);
  return container;
}

Result<void> check_json_depth(const GltfContainer& container, std::uint32_t max_depth,
                              const std::string& file) {
  std::uint32_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < container.json.size(); ++i) {
    const char c = container.json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > max_depth) {
        return import_error(file, byte_at(container.json_offset + i),
                            fmt::format("JSON nested at most {} deep", max_depth), "deeper nesting");
      }
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return {};
}

}  // namespace relume
