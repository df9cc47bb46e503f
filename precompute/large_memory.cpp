// SPDX-License-Identifier: MIT
#include "precompute/large_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <new>

namespace relume {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;

std::size_t whole_pages(std::size_t bytes) {
  return (bytes + kLargePage - 1) / kLargePage * kLargePage;
}

}  // namespace

std::shared_ptr<std::byte> large_memory(std::size_t bytes) {
  const std::size_t size = whole_pages(bytes) + kLargePage;
  void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  ::madvise(memory, size, MADV_HUGEPAGE);  // a wish
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  auto* const aligned = static_cast<std::byte*>(memory) + (whole_pages(address) - address);
  return {aligned, [memory, size](std::byte*) { ::munmap(memory, size); }};
}

}  // namespace relume
