// SPDX-License-Identifier: MIT
#include "precompute/embree_memory.h"

#include <fmt/format.h>

#include <new>

namespace relume {
namespace {

/// Stacks of threads and their allocators; and the tree, its primitives and what the builder sorts.
constexpr std::size_t kOfThreads = std::size_t{64} << 20, kOfTriangle = 512;

}  // namespace

Result<void> check_embree_memory(std::size_t triangles) {
  const std::size_t needed = kOfThreads + kOfTriangle * triangles;
  void* memory = ::operator new(needed, std::nothrow);
  if (memory == nullptr) {
    return fail(ErrorCode::out_of_memory,
                fmt::format("memory: expected {} MB more for Embree's tree over {} triangles, found less",
                            needed >> 20, triangles));
  }
  ::operator delete(memory);
  return {};
}

}  // namespace relume
