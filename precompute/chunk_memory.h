// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace relume {

/// Memory of many small arrays that are given up together. Not thread-safe.
class ChunkMemory {
 public:
  /// Zeros, aligned for 32 bits; lives as long as this does, wherever it moves.
  std::span<std::byte> take(std::size_t bytes);

 private:
  std::vector<std::shared_ptr<std::byte>> chunks_;
  std::size_t used_ = 0, size_ = 0;  ///< bytes of the last chunk
};

}  // namespace relume
