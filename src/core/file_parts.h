// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace relume {

/// The bytes of a file as parts that follow each other, so that what is large need not be copied together.
struct FileParts {
  std::vector<std::span<const std::byte>> parts;    ///< in what `owners` hold, or borrowed
  std::vector<std::shared_ptr<const void>> owners;  ///< of bytes

  /// Its bytes stay where they are.
  void own(std::vector<std::byte> bytes) {
    owners.push_back(std::make_shared<const std::vector<std::byte>>(std::move(bytes)));
  }

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
