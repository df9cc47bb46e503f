// SPDX-License-Identifier: MIT
#include "precompute/embree_memory.h"

#include <fmt/format.h>
#include <sys/mman.h>

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
  // Asked of the system, as Embree does: what the program has freed may be kept for itself.
  const std::size_t bytes = embree_memory(triangles);
  void* const memory =
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) return tl::unexpected(no_embree_memory(triangles));
  ::munmap(memory, bytes);
  return {};
}

}  // namespace relume
