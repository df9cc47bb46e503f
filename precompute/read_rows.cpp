// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>

#include "core/decode_sections.h"
#include "core/file_descriptor.h"
#include "precompute/large_memory.h"
#include "precompute/rows_file.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

/// So many bytes are still near by when their checksum is taken.
constexpr std::uint64_t kPiece = 256 << 10;

/// How many of `bytes` bytes there were at `offset`.
std::size_t read_part(int descriptor, std::byte* to, std::size_t offset, std::size_t bytes) {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t more = ::pread(descriptor, to + done, bytes - done, off_t(offset + done));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    done += std::size_t(more);
  }
  return done;
}

/// A file on its way into memory.
class FileBytes {
 public:
  FileBytes(const fs::path& file, FileDescriptor descriptor, std::size_t size)
      : name_(file.string()), descriptor_(std::move(descriptor)), size_(size), bytes_(large_memory(size)) {}

  const std::string& name() const { return name_; }
  std::size_t size() const { return size_; }
  /// Of which nothing need have been read.
  std::span<const std::byte> at(std::uint64_t offset, std::uint64_t length) const {
    return {bytes_.get() + offset, length};
  }
  /// Reads what is at `offset`.
  Result<std::span<const std::byte>> read(std::uint64_t offset, std::uint64_t length) const {
    const std::size_t found = read_part(descriptor_.get(), bytes_.get() + offset, offset, length);
    if (found == length) return at(offset, length);
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected {} bytes, found {}", name_, size_, offset + found));
  }

 private:
  std::string name_;
  FileDescriptor descriptor_;
  std::size_t size_;
  std::shared_ptr<std::byte> bytes_;
};

Result<std::vector<SectionRecord>> read_table(const FileBytes& file) {
  const std::size_t least = std::min(file.size(), sizeof(FileHeader));
  const auto header = file.read(0, least);
  if (!header) return tl::unexpected(header.error());
  FileHeader counts;
  if (least == sizeof counts) std::memcpy(&counts, header->data(), sizeof counts);
  const auto head = file.read(0, std::min<std::uint64_t>(file.size(), table_bytes(counts)));
  if (!head) return tl::unexpected(head.error());
  return read_section_table(*head, file.size(), file.name());
}

/// Reads a section and what is before it, from byte `begin` on, and verifies both.
Result<void> read_section(const FileBytes& file, const SectionRecord& record, std::uint64_t begin) {
  const auto padding = file.read(begin, record.offset - begin);
  if (!padding) return tl::unexpected(padding.error());
  if (auto checked = check_padding(*padding, begin, file.name()); !checked) return checked;
  Checksum checksum;
  for (std::uint64_t done = 0; done < record.length; done += kPiece) {
    const auto piece = file.read(record.offset + done, std::min(kPiece, record.length - done));
    if (!piece) return tl::unexpected(piece.error());
    checksum.add(*piece);
  }
  return check_section(record, checksum.value(), file.name());
}

/// Those of rays, or all others.
Result<void> read_sections(const FileBytes& file, const std::vector<SectionRecord>& records, bool of_rays) {
  std::uint64_t end = sizeof(FileHeader) + records.size() * sizeof(SectionRecord);
  for (const SectionRecord& record : records) {
    if (is_of_rays(record) == of_rays) {
      if (auto read = read_section(file, record, end); !read) return read;
    }
    end = record.offset + record.length;
  }
  return {};
}

Result<RowsFile> start_reading(const std::shared_ptr<const FileBytes>& file, std::launch policy) {
  auto records = read_table(*file);
  if (!records) return tl::unexpected(records.error());
  if (auto read = read_sections(*file, *records, false); !read) return tl::unexpected(read.error());
  std::vector<Section> sections;
  for (const SectionRecord& record : *records)
    sections.push_back({record, file->at(record.offset, record.length)});
  auto rows = decode_rows(file, sections, file->name());
  if (!rows) return rows;
  rows->arriving = std::async(policy, [file, records = std::move(*records)] {
                     return read_sections(*file, records, true);
                   }).share();
  return rows;
}

}  // namespace

Result<RowsFile> start_reading_rows(const fs::path& file, std::launch policy) {
  FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (descriptor.get() < 0) {
    return fail(ErrorCode::bad_input, fmt::format("{}: expected a file, found {}", file.string(),
                                                  std::generic_category().message(errno)));
  }
  struct stat status {};
  if (::fstat(descriptor.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected a file, found something else", file.string()));
  }
  try {
    return start_reading(
        std::make_shared<const FileBytes>(file, std::move(descriptor), std::size_t(status.st_size)), policy);
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file);
  }
}

Result<RowsFile> read_rows(const fs::path& file) {
  auto rows = start_reading_rows(file, std::launch::deferred);
  if (!rows) return rows;
  if (auto arrived = rows->await_rays(); !arrived) return tl::unexpected(arrived.error());
  return rows;
}

}  // namespace relume
