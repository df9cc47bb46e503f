// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <new>
#include <system_error>

#include "core/decode_sections.h"
#include "core/model_file.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

Result<std::vector<std::byte>> read_bytes(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    return fail(ErrorCode::bad_input, fmt::format("{}: expected a file, found {}", file.string(),
                                                  error ? error.message() : "something else"));
  }
  const std::uintmax_t size = fs::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: cannot open: {}", file.string(),
                            std::generic_category().message(error ? error.value() : errno)));
  }
  std::vector<std::byte> bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected {} bytes, found {}", file.string(), size, stream.gcount()));
  }
  return bytes;
}

}  // namespace

tl::unexpected<Error> no_memory_to_read(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return fail(ErrorCode::out_of_memory,
              fmt::format("{}: memory ran out: expected up to {} bytes to read it, found less", file.string(),
                          error ? 0 : 2 * size));
}

Result<std::vector<std::byte>> read_file(const fs::path& file) {
  try {
    return read_bytes(file);
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file);
  }
}

Result<Model> read_model(const fs::path& file) {
  try {
    const auto bytes = read_bytes(file);
    if (!bytes) return tl::unexpected(bytes.error());
    return decode_model(*bytes, file.string());
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file);
  }
}

}  // namespace relume
