// SPDX-License-Identifier: MIT
#include "scene/import/scene_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <new>
#include <optional>
#include <string>
#include <system_error>

#include "scene/import/data_uri.h"
#include "scene/import/import_error.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

std::optional<int> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

/// A '%' that no two hex digits follow stands for itself: exporters leave such names unencoded.
std::string percent_decoded(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      const auto high = hex_digit(text[i + 1]);
      const auto low = hex_digit(text[i + 2]);
      if (high && low) {
        out.push_back(static_cast<char>(*high * 16 + *low));
        i += 2;
        continue;
      }
    }
    out.push_back(text[i]);
  }
  return out;
}

bool has_scheme(std::string_view path) {
  const auto colon = path.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  return std::all_of(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(colon), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.';
  });
}

/// What is wrong with a decoded relative path, or nothing.
std::optional<std::string> path_objection(const std::string& path) {
  if (path.empty()) return "an empty path";
  if (path.find('\0') != std::string::npos) return "a path with a NUL byte";
  if (path.front() == '/' || path.front() == '\\') return fmt::format("the absolute path \"{}\"", path);
  if (has_scheme(path)) return fmt::format("\"{}\" with a scheme", path);
  std::size_t start = 0;
  while (start <= path.size()) {
    const auto end = std::min(path.find_first_of("/\\", start), path.size());
    if (path.compare(start, end - start, "..") == 0) return fmt::format("\"{}\" with \"..\"", path);
    start = end + 1;
  }
  return std::nullopt;
}

bool is_inside(const fs::path& folder, const fs::path& file) {
  const auto [at, end] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return at == folder.end();
}

std::string uri_name(std::string_view uri) {
  return fmt::format("\"{}\"", uri.substr(0, 200));
}

}  // namespace

Result<std::vector<std::byte>> read_regular_file(const fs::path& file, std::uint64_t max_bytes) {
  std::error_code error;
  const auto status = fs::status(file, error);
  if (!fs::exists(status)) return import_error(file.string(), "file", "a file", "none");
  if (!fs::is_regular_file(status)) {
    return import_error(file.string(), "file", "a regular file", "something else");
  }
  const auto size = fs::file_size(file, error);
  if (error) return import_error(file.string(), "file", "a readable file", error.message());
  if (size > max_bytes) {
    return import_error(file.string(), "file", fmt::format("at most {} bytes", max_bytes),
                        fmt::format("{} bytes", size));
  }
  try {
    std::vector<std::byte> bytes(size);
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in) return import_error(file.string(), "file", fmt::format("{} readable bytes", size), "fewer");
    return bytes;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, fmt::format("{}: no memory for {} bytes", file.string(), size));
  }
}

std::optional<fs::path> named_file(const fs::path& scene_file, std::string_view uri) {
  const std::string relative = percent_decoded(uri);
  if (is_data_uri(uri) || path_objection(relative)) return std::nullopt;
  return scene_file.parent_path() / relative;
}

Result<std::vector<std::byte>> read_uri(const fs::path& scene_file, std::string_view place,
                                        std::string_view uri, std::uint64_t max_bytes) {
  const std::string name = scene_file.filename().string();
  if (is_data_uri(uri)) {
    auto bytes = decode_data_uri(uri);
    if (!bytes) return import_error(name, place, "a base64 data URI", bytes.error().message);
    return bytes;
  }
  const std::string relative = percent_decoded(uri);
  if (const auto objection = path_objection(relative)) {
    return import_error(name, place, "a relative path inside the folder of the scene", *objection);
  }
  std::error_code error;
  const fs::path folder =
      fs::canonical(scene_file.parent_path().empty() ? "." : scene_file.parent_path(), error);
  if (error) return import_error(name, place, "a readable folder", error.message());
  const fs::path file = fs::canonical(folder / relative, error);
  if (error)
    return import_error(name, place, "a file in the folder of the scene", "no " + uri_name(relative));
  if (!is_inside(folder, file)) {
    return import_error(name, place, "a file inside the folder of the scene",
                        uri_name(relative) + " outside of it");
  }
  if (!fs::is_regular_file(file, error)) {
    return import_error(name, place, "a regular file", uri_name(relative) + ", which is none");
  }
  const auto size = fs::file_size(file, error);
  if (error || size > max_bytes) {
    return import_error(name, place, fmt::format("a file of at most {} bytes", max_bytes),
                        fmt::format("{} of {} bytes", uri_name(relative), size));
  }
  return read_regular_file(file, max_bytes);
}

}  // namespace relume
