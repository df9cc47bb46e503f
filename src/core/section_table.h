// SPDX-License-Identifier: MIT
//
// The container of a .relume file: a header, a table of sections, the sections (src/FILE_FORMAT.md). Knows
// nothing of what they hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/file_parts.h"
#include "core/result.h"

namespace relume {

inline constexpr std::array<char, 8> kFileMagic = {'R', 'E', 'L', 'U', 'M', 'E', '\x1a', '\n'};
inline constexpr std::uint32_t kFileVersion = 1;
inline constexpr std::size_t kSectionAlignment = 64;

/// A reader that does not know a section with this flag may skip it (after it has verified its checksum).
inline constexpr std::uint32_t kSectionOptional = 1u << 0;

struct FileHeader {
  std::array<char, 8> magic = kFileMagic;
  std::uint32_t version = kFileVersion;
  std::uint32_t section_count = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64 of header and table, taken with this field zero
};
static_assert(sizeof(FileHeader) == 32);

struct SectionRecord {
  std::array<char, 4> id{};
  std::uint32_t owner = 0;  ///< system, or 0xffffffff: the whole model
  std::uint32_t flags = 0;
  std::uint32_t reserved = 0;  ///< zero
  std::uint64_t offset = 0;    ///< from the beginning of the file, a multiple of kSectionAlignment
  std::uint64_t length = 0;    ///< bytes, above zero
  std::uint64_t checksum = 0;  ///< XXH3-64 of the section's bytes
};
static_assert(sizeof(SectionRecord) == 40);

/// A section as it is read: `bytes` points into the file's bytes.
struct Section {
  SectionRecord record;
  std::span<const std::byte> bytes;
};

/// "'CLUS' of system 0 at byte 4096", for messages.
std::string describe(const SectionRecord& record);

/// XXH3-64 of bytes that come one after another.
class Checksum {
 public:
  Checksum();
  ~Checksum();
  Checksum(const Checksum&) = delete;

  void add(std::span<const std::byte> bytes);
  std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Of a section of parts that follow each other.
std::uint64_t checksum_of(std::span<const std::span<const std::byte>> parts);

/// Collects sections and lays out the file. Empty sections are left out.
class SectionWriter {
 public:
  /// A copy of the bytes.
  void add(std::string_view id, std::uint32_t owner, std::span<const std::byte> bytes,
           std::uint32_t flags = 0);
  void add(std::string_view id, std::uint32_t owner, std::vector<std::byte> bytes, std::uint32_t flags = 0);

  /// One section of parts that follow each other. They are borrowed until the file is written. `checksum` of
  /// them, where it is known.
  void borrow(std::string_view id, std::uint32_t owner, std::span<const std::span<const std::byte>> parts,
              std::uint32_t flags = 0, std::optional<std::uint64_t> checksum = {});

  template <class T>
  void borrow_array(std::string_view id, std::uint32_t owner, const std::vector<T>& values,
                    std::uint32_t flags = 0) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> bytes = std::as_bytes(std::span(values));
    borrow(id, owner, std::span(&bytes, 1), flags);
  }
  /// What is borrowed may belong to the file.
  void keep(std::vector<std::byte> bytes) { file_.own(std::move(bytes)); }

  /// The bytes of the file.
  FileParts finish_parts() &&;
  std::vector<std::byte> finish() && { return std::move(*this).finish_parts().joined(); }

 private:
  std::vector<SectionRecord> records_;  ///< offsets from the end of the head
  FileParts file_;                      ///< without the head
  std::uint64_t end_ = 0;               ///< bytes in file_
};

/// Bytes of header and table of a file that begins with `header`.
std::uint64_t table_bytes(const FileHeader& header);

/// The table of a file of `file_bytes` bytes, of which `head` is the beginning, as far as table_bytes says:
/// header, table and layout are verified. `name` is used in messages.
Result<std::vector<SectionRecord>> read_section_table(std::span<const std::byte> head,
                                                      std::uint64_t file_bytes, const std::string& name);

/// Verifies the checksum of one section that was read.
Result<Section> check_section(const SectionRecord& record, std::span<const std::byte> bytes,
                              const std::string& name);
/// The same of a checksum that was `found`.
Result<void> check_section(const SectionRecord& record, std::uint64_t found, const std::string& name);

/// Verifies that `bytes`, which begin at byte `begin` of the file, between two sections, are zeros.
Result<void> check_padding(std::span<const std::byte> bytes, std::uint64_t begin, const std::string& name);

/// Verifies header, table, layout (no holes, no overlaps, padding of zeros) and every checksum. `name` is
/// used in messages.
Result<std::vector<Section>> read_sections(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume
