// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <new>
#include <system_error>

#include "core/decode_sections.h"
#include "core/model_file.h"
#include "core/model_sections.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string_view id_of(const SectionRecord& record) {
  return {record.id.data(), record.id.size()};
}

/// A file of which only some sections are read.
class SectionFile {
 public:
  static Result<SectionFile> open(const fs::path& path) {
    SectionFile file;
    file.name_ = path.string();
    std::error_code error;
    const std::uintmax_t size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
    file.stream_.open(path, std::ios::binary);
    if (error || !file.stream_) return fail(ErrorCode::bad_input, file.name_ + ": cannot open it as a file");
    const auto header = file.read(0, std::min<std::uint64_t>(size, sizeof(FileHeader)));
    if (!header) return tl::unexpected(header.error());
    FileHeader counts;
    if (header->size() == sizeof counts) std::memcpy(&counts, header->data(), sizeof counts);
    const auto head = file.read(0, std::min<std::uint64_t>(size, table_bytes(counts)));
    if (!head) return tl::unexpected(head.error());
    auto records = read_section_table(*head, size, file.name_);
    if (!records) return tl::unexpected(records.error());
    file.records_ = std::move(*records);
    return file;
  }

  const std::string& name() const { return name_; }
  const std::vector<SectionRecord>& records() const { return records_; }

  /// Verified; valid as long as this is.
  Result<Section> section(const SectionRecord& record) {
    auto bytes = read(record.offset, record.length);
    if (!bytes) return tl::unexpected(bytes.error());
    contents_.push_back(std::move(*bytes));
    return check_section(record, contents_.back(), name_);
  }

 private:
  Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t length) {
    std::vector<std::byte> bytes(length);
    stream_.seekg(static_cast<std::streamoff>(offset));
    stream_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(length));
    if (static_cast<std::uint64_t>(stream_.gcount()) == length) return bytes;
    return fail(ErrorCode::bad_input, fmt::format("{}: byte {}: expected {} bytes, found {}", name_, offset,
                                                  length, stream_.gcount()));
  }

  std::string name_;
  std::ifstream stream_;
  std::vector<SectionRecord> records_;
  std::vector<std::vector<std::byte>> contents_;
};

Result<std::vector<std::string>> system_names(SectionFile& file) {
  std::vector<std::string> names;
  for (const SectionRecord& record : file.records()) {
    if (id_of(record) != sections::kSystem) continue;
    const auto section = file.section(record);
    if (!section) return tl::unexpected(section.error());
    auto name = decode_system_name(*section);
    if (!name) return fail(name.error().code, file.name() + ": " + name.error().message);
    names.push_back(std::move(*name));
  }
  return names;
}

Result<std::vector<bool>> choose(const SectionFile& file, const std::vector<std::string>& all,
                                 std::span<const std::string> names) {
  std::vector<bool> chosen(all.size(), false);
  for (const std::string& name : names) {
    const auto found = std::find(all.begin(), all.end(), name);
    if (found == all.end()) {
      return fail(ErrorCode::usage, fmt::format("{}: expected one of the systems {}, found '{}'", file.name(),
                                                fmt::join(all, ", "), name));
    }
    chosen[std::size_t(found - all.begin())] = true;
  }
  if (names.empty())
    return fail(ErrorCode::usage, file.name() + ": expected the name of at least one system, found none");
  return chosen;
}

Result<Model> read_chosen(SectionFile& file, const std::vector<bool>& chosen) {
  std::vector<Section> wanted;
  for (const SectionRecord& record : file.records()) {
    const bool skipped = record.owner < chosen.size() && !chosen[record.owner];
    if (skipped && id_of(record) != sections::kSystem) continue;
    auto section = file.section(record);
    if (!section) return tl::unexpected(section.error());
    wanted.push_back(*section);
  }
  return decode_sections(wanted, chosen, file.name());
}

}  // namespace

Result<std::vector<std::string>> read_system_names(const fs::path& path) {
  try {
    auto file = SectionFile::open(path);
    if (!file) return tl::unexpected(file.error());
    return system_names(*file);
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(path);
  }
}

Result<Model> read_systems(const fs::path& path, std::span<const std::string> names) {
  try {
    auto file = SectionFile::open(path);
    if (!file) return tl::unexpected(file.error());
    const auto all = system_names(*file);
    if (!all) return tl::unexpected(all.error());
    const auto chosen = choose(*file, *all, names);
    if (!chosen) return tl::unexpected(chosen.error());
    return read_chosen(*file, *chosen);
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(path);
  }
}

}  // namespace relume
