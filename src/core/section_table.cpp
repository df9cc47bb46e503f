// SPDX-License-Identifier: MIT
#include "core/section_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace relume {
namespace {

static_assert(std::endian::native == std::endian::little,
              "files are little-endian and read as they are in memory");

std::uint64_t align_up(std::uint64_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

/// Small parts that lie scattered take longer to reach than to read.
constexpr std::size_t kFetchedAhead = 2, kFetchedBytes = 1024, kCacheLine = 64;

void fetch_beginning(std::span<const std::byte> part) {
  for (std::size_t i = 0; i < std::min(kFetchedBytes, part.size()); i += kCacheLine)
    __builtin_prefetch(part.data() + i);
}

/// Checksum of header (its checksum field zero) and table.
std::uint64_t table_checksum(FileHeader header, std::span<const SectionRecord> records) {
  header.checksum = 0;
  std::vector<std::byte> bytes(sizeof header + records.size_bytes());
  std::memcpy(bytes.data(), &header, sizeof header);
  if (!records.empty()) std::memcpy(bytes.data() + sizeof header, records.data(), records.size_bytes());
  return checksum_of(bytes);
}

tl::unexpected<Error> malformed(const std::string& name, const std::string& sentence) {
  return fail(ErrorCode::bad_input, name + ": " + sentence);
}

Result<FileHeader> read_header(std::span<const std::byte> bytes, std::uint64_t file_bytes,
                               const std::string& name) {
  FileHeader header;
  if (bytes.size() < sizeof header) {
    return malformed(
        name, fmt::format("expected a header of {} bytes, found a file of {}", sizeof header, bytes.size()));
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kFileMagic) {
    return malformed(
        name, "byte 0: expected 'RELUME' as the first letters of a .relume file, found something else");
  }
  if (header.version != kFileVersion) {
    return malformed(name,
                     fmt::format("byte 8: expected file version {}, found {}", kFileVersion, header.version));
  }
  if (header.file_bytes != file_bytes) {
    return malformed(
        name, fmt::format("byte 16: expected {} bytes in the file, found {}", header.file_bytes, file_bytes));
  }
  return header;
}

Result<std::vector<SectionRecord>> read_table(std::span<const std::byte> bytes, const FileHeader& header,
                                              const std::string& name) {
  if (table_bytes(header) > bytes.size()) {
    return malformed(name, fmt::format("byte 12: expected room for {} sections, found a file of {} bytes",
                                       header.section_count, header.file_bytes));
  }
  std::vector<SectionRecord> records(header.section_count);
  if (!records.empty())
    std::memcpy(records.data(), bytes.data() + sizeof header, table_bytes(header) - sizeof header);
  const std::uint64_t found = table_checksum(header, records);
  if (found != header.checksum) {
    return malformed(
        name, fmt::format("byte 24: expected checksum {:016x} of header and section table, found {:016x}",
                          header.checksum, found));
  }
  return records;
}

Result<void> check_record(const SectionRecord& record, std::uint64_t expected_offset,
                          std::uint64_t file_bytes, const std::string& name) {
  if ((record.flags & ~kSectionOptional) != 0 || record.reserved != 0) {
    return malformed(name, fmt::format("section {}: expected known flags, found {:#x} and {:#x}",
                                       describe(record), record.flags, record.reserved));
  }
  if (record.offset != expected_offset) {
    return malformed(name, fmt::format("section {}: expected it at byte {}, right after the one before",
                                       describe(record), expected_offset));
  }
  if (record.length == 0 || record.offset > file_bytes || record.length > file_bytes - record.offset) {
    return malformed(name, fmt::format("section {}: expected 1 to {} bytes, found {}", describe(record),
                                       file_bytes - std::min(record.offset, file_bytes), record.length));
  }
  return {};
}

}  // namespace

struct Checksum::State {
  XXH3_state_t xxh;
};

Checksum::Checksum() : state_(std::make_unique<State>()) {
  XXH3_64bits_reset(&state_->xxh);
}

Checksum::~Checksum() = default;

void Checksum::add(std::span<const std::byte> bytes) {
  XXH3_64bits_update(&state_->xxh, bytes.data(), bytes.size());
}

std::uint64_t Checksum::value() const {
  return XXH3_64bits_digest(&state_->xxh);
}

std::uint64_t checksum_of(std::span<const std::span<const std::byte>> parts) {
  if (parts.size() == 1) return checksum_of(parts[0]);
  Checksum checksum;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i + kFetchedAhead < parts.size()) fetch_beginning(parts[i + kFetchedAhead]);
    checksum.add(parts[i]);
  }
  return checksum.value();
}

std::string describe(const SectionRecord& record) {
  std::string id;
  for (const char letter : record.id) id += letter >= ' ' && letter <= '~' ? letter : '?';
  const std::string owner =
      record.owner == 0xffffffffu ? "of the model" : fmt::format("of system {}", record.owner);
  return fmt::format("'{}' {} at byte {}", id, owner, record.offset);
}

void SectionWriter::add(std::string_view id, std::uint32_t owner, std::span<const std::byte> bytes,
                        std::uint32_t flags) {
  add(id, owner, std::vector(bytes.begin(), bytes.end()), flags);
}

void SectionWriter::add(std::string_view id, std::uint32_t owner, std::vector<std::byte> bytes,
                        std::uint32_t flags) {
  borrow(id, owner, std::vector<std::span<const std::byte>>{bytes}, flags);
  keep(std::move(bytes));
}

void SectionWriter::borrow(std::string_view id, std::uint32_t owner,
                           std::span<const std::span<const std::byte>> parts, std::uint32_t flags,
                           std::optional<std::uint64_t> checksum) {
  static constexpr std::array<std::byte, kSectionAlignment> kPadding{};
  SectionRecord record;
  assert(id.size() == record.id.size());
  std::copy(id.begin(), id.end(), record.id.begin());
  record.owner = owner, record.flags = flags;
  for (const auto part : parts) record.length += part.size();
  if (record.length == 0) return;
  record.checksum = checksum ? *checksum : checksum_of(parts);
  record.offset = align_up(end_);
  if (record.offset > end_) file_.parts.push_back(std::span(kPadding).first(record.offset - end_));
  file_.parts.insert(file_.parts.end(), parts.begin(), parts.end());
  end_ = record.offset + record.length;
  records_.push_back(record);
}

FileParts SectionWriter::finish_parts() && {
  FileHeader header;
  header.section_count = static_cast<std::uint32_t>(records_.size());
  const std::uint64_t table_end = table_bytes(header), body_begin = align_up(table_end);
  for (SectionRecord& record : records_) record.offset += body_begin;
  header.file_bytes = body_begin + end_;
  header.checksum = table_checksum(header, records_);
  std::vector<std::byte> head(body_begin);
  std::memcpy(head.data(), &header, sizeof header);
  if (!records_.empty()) std::memcpy(head.data() + sizeof header, records_.data(), table_end - sizeof header);
  file_.parts.insert(file_.parts.begin(), head);
  file_.own(std::move(head));
  return std::move(file_);
}

std::uint64_t table_bytes(const FileHeader& header) {
  return sizeof header + std::uint64_t{header.section_count} * sizeof(SectionRecord);
}

Result<std::vector<SectionRecord>> read_section_table(std::span<const std::byte> head,
                                                      std::uint64_t file_bytes, const std::string& name) {
  const auto header = read_header(head, file_bytes, name);
  if (!header) return tl::unexpected(header.error());
  auto records = read_table(head, *header, name);
  if (!records) return records;
  std::uint64_t end = table_bytes(*header);
  for (const SectionRecord& record : *records) {
    if (auto checked = check_record(record, align_up(end), file_bytes, name); !checked)
      return tl::unexpected(checked.error());
    end = record.offset + record.length;
  }
  if (end == file_bytes) return records;
  return malformed(
      name, fmt::format("byte {}: expected the end of the file, found {} bytes more", end, file_bytes - end));
}

Result<void> check_section(const SectionRecord& record, std::uint64_t found, const std::string& name) {
  if (found == record.checksum) return {};
  return malformed(name, fmt::format("section {}: expected checksum {:016x}, found {:016x}", describe(record),
                                     record.checksum, found));
}

Result<Section> check_section(const SectionRecord& record, std::span<const std::byte> bytes,
                              const std::string& name) {
  if (auto checked = check_section(record, checksum_of(bytes), name); !checked)
    return tl::unexpected(checked.error());
  return Section{record, bytes};
}

Result<void> check_padding(std::span<const std::byte> bytes, std::uint64_t begin, const std::string& name) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] == std::byte{0}) continue;
    return malformed(name, fmt::format("byte {}: expected 0 between sections, found {}", begin + i,
                                       std::to_integer<int>(bytes[i])));
  }
  return {};
}

Result<std::vector<Section>> read_sections(std::span<const std::byte> bytes, const std::string& name) {
  const auto records = read_section_table(bytes, bytes.size(), name);
  if (!records) return tl::unexpected(records.error());
  std::vector<Section> sections;
  std::uint64_t end = sizeof(FileHeader) + records->size() * sizeof(SectionRecord);
  for (const SectionRecord& record : *records) {
    if (auto checked = check_padding(bytes.subspan(end, record.offset - end), end, name); !checked)
      return tl::unexpected(checked.error());
    auto section = check_section(record, bytes.subspan(record.offset, record.length), name);
    if (!section) return tl::unexpected(section.error());
    sections.push_back(*section);
    end = record.offset + record.length;
  }
  return sections;
}

}  // namespace relume
