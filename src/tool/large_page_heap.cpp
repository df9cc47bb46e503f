// SPDX-License-Identifier: MIT
//
// What C++ allocates in this program lies in large pages, where the system gives some to who asks: a
// precompute fills hundreds of megabytes once, and the first touch of each small page may take longer than
// filling it, the more so in virtual machines. Small pages are a slower fallback, nothing else.
#include <oneapi/tbb/scalable_allocator.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20, kGranularity = std::size_t{64} << 10;

/// Of a last large page, less than this is left to small ones.
constexpr std::size_t kWorthwhile = kLargePage / 4;

/// Aligned to large pages; `bytes` becomes what there is.
void* map_pages(std::intptr_t, std::size_t& bytes) {
  const std::size_t rest = bytes % kLargePage;
  if (rest >= kWorthwhile) bytes += kLargePage - rest;
  const std::size_t mapped = bytes + kLargePage;
  void* const memory =
      ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  auto* const begin = static_cast<std::byte*>(memory);
  const std::size_t before = (kLargePage - reinterpret_cast<std::uintptr_t>(begin) % kLargePage) % kLargePage;
  if (before > 0) ::munmap(begin, before);
  ::munmap(begin + before + bytes, kLargePage - before);
  ::madvise(begin + before, bytes / kLargePage * kLargePage, MADV_HUGEPAGE);  // a wish
  return begin + before;
}

int unmap_pages(std::intptr_t, void* memory, std::size_t bytes) {
  return ::munmap(memory, bytes);
}

rml::MemoryPool* make_pool() {
  // What was freed is filled again: to return pages and touch others costs more than to keep them.
  constexpr bool kFixed = false, kKeepsAll = true;
  const rml::MemPoolPolicy policy(map_pages, unmap_pages, kGranularity, kFixed, kKeepsAll);
  rml::MemoryPool* pool = nullptr;
  if (rml::pool_create_v1(0, &policy, &pool) != rml::POOL_OK) std::abort();
  return pool;
}

/// Never destroyed: memory is freed until the process ends.
rml::MemoryPool* pool() {
  static rml::MemoryPool* const own = make_pool();
  return own;
}

void* allocate(std::size_t bytes) noexcept {
  return rml::pool_malloc(pool(), bytes > 0 ? bytes : 1);
}

void* allocate(std::size_t bytes, std::align_val_t alignment) noexcept {
  return rml::pool_aligned_malloc(pool(), bytes > 0 ? bytes : 1, static_cast<std::size_t>(alignment));
}

void* or_throw(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void release(void* memory) noexcept {
  if (memory != nullptr) rml::pool_free(pool(), memory);
}

}  // namespace

// All that the standard lets a program replace, but those that call others of these unless replaced.
void* operator new(std::size_t bytes) {
  return or_throw(allocate(bytes));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return or_throw(allocate(bytes, alignment));
}
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(bytes, alignment);
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}
