// SPDX-License-Identifier: MIT
#include "precompute/chunk_memory.h"

#include <algorithm>
#include <cstdint>

#include "precompute/large_memory.h"

namespace relume {
namespace {

/// Bytes: some large pages, which are there once they are touched.
constexpr std::size_t kChunk = std::size_t{8} << 20;

}  // namespace

std::span<std::byte> ChunkMemory::take(std::size_t bytes) {
  constexpr std::size_t kAlignment = alignof(std::uint32_t);
  const std::size_t room = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  if (used_ + room > size_) {
    size_ = std::max(room, kChunk), used_ = 0;
    chunks_.push_back(large_memory(size_));
  }
  const std::span taken(chunks_.back().get() + used_, bytes);
  used_ += room;
  return taken;
}

}  // namespace relume
