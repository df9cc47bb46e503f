// SPDX-License-Identifier: MIT
#include "tool/matrix_export.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <limits>
#include <span>

namespace relume {
namespace {

static_assert(std::endian::native == std::endian::little, "zip and .npy are written as they are in memory");

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void append(Bytes& bytes, const std::string& text) {
  append(bytes, std::as_bytes(std::span(text)));
}

template <class Number>
void append_number(Bytes& bytes, Number number) {
  append(bytes, std::as_bytes(std::span(&number, 1)));
}

/// The .npy format, version 1.0: magic, header length, a Python dictionary padded to 64 bytes, data.
Bytes encode_npy(const std::string& type, const std::string& shape, std::span<const std::byte> data) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  constexpr std::size_t kPrefix = 10;
  header.append(63 - (kPrefix + header.size()) % 64, ' ');
  header += '\n';
  Bytes bytes;
  append(bytes, std::string("\x93NUMPY\x01\x00", 8));
  append_number(bytes, static_cast<std::uint16_t>(header.size()));
  append(bytes, header);
  append(bytes, data);
  return bytes;
}

/// The fields that the local and the central header of a stored zip entry share (APPNOTE 4.3.7 and 4.3.12).
void append_entry_fields(Bytes& bytes, const std::string& name, std::uint32_t checksum, std::uint32_t size) {
  append_number<std::uint16_t>(bytes, 20);  // version needed
  append_number<std::uint16_t>(bytes, 0);   // flags
  append_number<std::uint16_t>(bytes, 0);   // stored
  append_number<std::uint16_t>(bytes, 0);   // time
  append_number<std::uint16_t>(bytes,
                               33);  // date: 1 January 1980, so that the same matrix gives the same bytes
  append_number(bytes, checksum);
  append_number(bytes, size);
  append_number(bytes, size);
  append_number(bytes, static_cast<std::uint16_t>(name.size()));
  append_number<std::uint16_t>(bytes, 0);  // extra field
}

class ZipWriter {
 public:
  void add(const std::string& name, const Bytes& content) {
    const auto checksum = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const unsigned char*>(content.data()), content.size()));
    const auto size = static_cast<std::uint32_t>(content.size());
    const auto offset = static_cast<std::uint32_t>(bytes_.size());
    append(bytes_, std::string("PK\x03\x04"));
    append_entry_fields(bytes_, name, checksum, size);
    append(bytes_, name);
    append(bytes_, content);

    append(directory_, std::string("PK\x01\x02"));
    append_number<std::uint16_t>(directory_, 20);  // version made by
    append_entry_fields(directory_, name, checksum, size);
    append(directory_, std::string(10, '\0'));  // comment, disk, attributes
    append_number(directory_, offset);
    append(directory_, name);
    ++count_;
  }

  Bytes finish() && {
    const auto offset = static_cast<std::uint32_t>(bytes_.size());
    append(bytes_, directory_);
    append(bytes_, std::string("PK\x05\x06\0\0\0\0", 8));
    append_number(bytes_, count_);
    append_number(bytes_, count_);
    append_number(bytes_, static_cast<std::uint32_t>(directory_.size()));
    append_number(bytes_, offset);
    append_number<std::uint16_t>(bytes_, 0);  // comment
    return std::move(bytes_);
  }

 private:
  Bytes bytes_;
  Bytes directory_;
  std::uint16_t count_ = 0;
};

template <class Number>
Bytes vector_npy(const char* type, const std::vector<Number>& numbers) {
  return encode_npy(type, fmt::format("({},)", numbers.size()), std::as_bytes(std::span(numbers)));
}

}  // namespace

std::vector<std::byte> encode_mtx(const CsrMatrix& matrix, const std::string& title) {
  std::string text = fmt::format("%%MatrixMarket matrix coordinate real general\n% {}\n{} {} {}\n", title,
                                 matrix.rows, matrix.columns, matrix.values.size());
  for (std::uint32_t row = 0; row < matrix.rows; ++row) {
    for (std::uint64_t k = matrix.row_offsets[row]; k < matrix.row_offsets[row + 1]; ++k) {
      fmt::format_to(std::back_inserter(text), "{} {} {}\n", row + 1, matrix.column_indices[k] + 1,
                     matrix.values[k]);
    }
  }
  Bytes bytes;
  append(bytes, text);
  return bytes;
}

Result<std::vector<std::byte>> encode_npz(const CsrMatrix& matrix) {
  constexpr std::size_t kEntryBytes = sizeof(double) + sizeof(std::uint32_t);
  const std::size_t size =
      matrix.values.size() * kEntryBytes + matrix.row_offsets.size() * sizeof(std::uint64_t) + 4096;
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return fail(
        ErrorCode::bad_input,
        fmt::format("--matrices npz: expected at most 4 GB, found {} bytes; mtx has no limit.", size));
  }
  const std::vector<std::int64_t> shape{matrix.rows, matrix.columns};
  ZipWriter zip;
  zip.add("indices.npy", vector_npy("<i4", matrix.column_indices));
  zip.add("indptr.npy", vector_npy("<i8", matrix.row_offsets));
  zip.add("format.npy", encode_npy("|S3", "()", std::as_bytes(std::span("csr", 3))));
  zip.add("shape.npy", vector_npy("<i8", shape));
  zip.add("data.npy", vector_npy("<f8", matrix.values));
  return std::move(zip).finish();
}

}  // namespace relume
