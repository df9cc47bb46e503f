// SPDX-License-Identifier: MIT
#include "tool/output_folder.h"

#include <fmt/format.h>

#include "core/model_file.h"
#include "tool/interrupt.h"

namespace relume {
namespace {

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (!code) return {};
  const bool full = code == std::errc::no_space_on_device;
  return fail(
      full ? ErrorCode::out_of_memory : ErrorCode::bad_input,
      fmt::format("{}: expected a folder that can be made, found: {}.", folder.string(), code.message()));
}

}  // namespace

OutputFolder::OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

void OutputFolder::add(const std::string& name, std::vector<std::byte> bytes) {
  files_.push_back({folder_ / name, std::move(bytes)});
}

void OutputFolder::add(const std::string& name, const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  add(name, std::vector<std::byte>(first, first + text.size()));
}

Result<void> OutputFolder::add(const std::string& name, Result<std::vector<std::byte>> bytes) {
  if (!bytes) return tl::unexpected(bytes.error());
  add(name, std::move(*bytes));
  return {};
}

Result<void> OutputFolder::write() const {
  if (const Result<void> go_on = check_interrupted(); !go_on) return go_on;
  let_finish();
  for (const File& file : files_) {
    if (const Result<void> made = make_folder(file.path.parent_path()); !made) return made;
    if (const Result<void> written = write_file(file.path, file.bytes); !written) return written;
  }
  return {};
}

std::vector<std::filesystem::path> OutputFolder::paths() const {
  std::vector<std::filesystem::path> paths;
  for (const File& file : files_) paths.push_back(file.path);
  return paths;
}

}  // namespace relume
