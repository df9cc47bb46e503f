// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <new>
#include <system_error>

#include "core/decode_sections.h"
#include "core/file_descriptor.h"
#include "precompute/arena_threads.h"
#include "precompute/rows_file.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargePage = std::size_t{2} << 20;

/// Memory that nobody filled before, in large pages where the system has some: these files are large, and
/// first touches of small pages take longer than reading.
std::shared_ptr<std::byte> large_memory(std::size_t bytes) {
  const std::size_t size = (bytes / kLargePage + 1) * kLargePage;
  void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  ::madvise(memory, size, MADV_HUGEPAGE);  // a wish
  return {static_cast<std::byte*>(memory), [size](std::byte* own) { ::munmap(own, size); }};
}

/// How many of `bytes` bytes there were at `offset`.
std::size_t read_part(int descriptor, std::byte* to, std::size_t offset, std::size_t bytes) {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t more = ::pread(descriptor, to + done, bytes - done, off_t(offset + done));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    done += std::size_t(more);
  }
  return done;
}

/// How many of the first `bytes` bytes there were, read by several threads: most of the time goes into first
/// touches.
std::size_t read_parts(int descriptor, std::byte* to, std::size_t bytes, std::uint32_t threads) {
  std::atomic<std::size_t> found = 0;
  tbb::task_arena arena(arena_threads(threads));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, bytes / kLargePage + 1, [&](std::size_t page) {
      const std::size_t first = page * kLargePage;
      found += read_part(descriptor, to + first, first, std::min(kLargePage, bytes - first));
    });
  });
  return found;
}

Result<RowsFile> read(const fs::path& file, int descriptor, std::uint32_t threads) {
  const std::string name = file.string();
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return fail(ErrorCode::bad_input, fmt::format("{}: expected a file, found something else", name));
  const auto size = static_cast<std::size_t>(status.st_size);
  const std::shared_ptr<std::byte> bytes = large_memory(size);
  if (!bytes) return no_memory_to_read(file);
  const std::size_t found = read_parts(descriptor, bytes.get(), size, threads);
  if (found != size)
    return fail(ErrorCode::bad_input, fmt::format("{}: expected {} bytes, found {}", name, size, found));
  return decode_rows(bytes, {bytes.get(), size}, name);
}

}  // namespace

Result<RowsFile> read_rows(const fs::path& file, std::uint32_t threads) {
  const FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (descriptor.get() < 0) {
    return fail(ErrorCode::bad_input, fmt::format("{}: expected a file, found {}", file.string(),
                                                  std::generic_category().message(errno)));
  }
  try {
    return read(file, descriptor.get(), threads);
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file);
  }
}

}  // namespace relume
