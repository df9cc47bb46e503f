// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace relume {

/// The bytes of a file as parts that follow each other, so that what is large need not be copied together.
struct FileParts {
  std::vector<std::span<const std::byte>> parts;  ///< each in `owned`, or borrowed
  std::vector<std::vector<std::byte>> owned;      ///< may move, their bytes stay where they are

  FileParts() = default;
  FileParts(FileParts&&) = default;
  FileParts& operator=(FileParts&&) = default;

  std::size_t size() const {
    std::size_t bytes = 0;
    for (const auto part : parts) bytes += part.size();
    return bytes;
  }
  bool empty() const { return parts.empty(); }
  /// All of them in one piece.
  std::vector<std::byte> joined() const {
    std::vector<std::byte> bytes;
    bytes.reserve(size());
    for (const auto part : parts) bytes.insert(bytes.end(), part.begin(), part.end());
    return bytes;
  }
};

}  // namespace relume
