// SPDX-License-Identifier: MIT
#include "precompute/embree_memory.h"

#include <fmt/format.h>

#include <new>

namespace relume {
namespace {

/// Stacks of threads and their allocators; and the tree, its primitives and what the builder sorts.
constexpr std::size_t kOfThreads = std::size_t{96} << 20, kOfTriangle = 512;

}  // namespace

std::size_t embree_memory(std::size_t triangles) {
  return kOfThreads + kOfTriangle * triangles;
}

Error no_embree_memory(std::size_t triangles) {
  return {ErrorCode::out_of_memory,
          fmt::format("memory: expected {} MB more for Embree's tree over {} triangles, found less",
                      embree_memory(triangles) >> 20, triangles)};
}

Result<void> check_embree_memory(std::size_t triangles) {
  void* memory = ::operator new(embree_memory(triangles), std::nothrow);
  if (memory == nullptr) return tl::unexpected(no_embree_memory(triangles));
  ::operator delete(memory);
  return {};
}

}  // namespace relume
