// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <system_error>

#include "core/decode_sections.h"
#include "core/file_descriptor.h"
#include "precompute/rows_file.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

/// Memory that nobody filled before, in large pages where the system has some: these files are large, and
/// first touches of small pages take longer than reading.
std::shared_ptr<std::byte> large_memory(std::size_t bytes) {
  constexpr std::size_t kLargePage = std::size_t{2} << 20;
  const std::size_t size = (bytes / kLargePage + 1) * kLargePage;
  void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  ::madvise(memory, size, MADV_HUGEPAGE);  // a wish
  return {static_cast<std::byte*>(memory), [size](std::byte* own) { ::munmap(own, size); }};
}

/// How many bytes there were, at most `bytes`; or -1.
std::ptrdiff_t read_all(int descriptor, std::byte* to, std::size_t bytes) {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t more = ::read(descriptor, to + done, bytes - done);
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) return -1;
    if (more == 0) break;
    done += std::size_t(more);
  }
  return std::ptrdiff_t(done);
}

Result<RowsFile> read(const fs::path& file, int descriptor) {
  const std::string name = file.string();
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return fail(ErrorCode::bad_input, fmt::format("{}: expected a file, found something else", name));
  const auto size = static_cast<std::size_t>(status.st_size);
  const std::shared_ptr<std::byte> bytes = large_memory(size);
  if (!bytes) return no_memory_to_read(file);
  const std::ptrdiff_t found = read_all(descriptor, bytes.get(), size);
  if (found != std::ptrdiff_t(size))
    return fail(ErrorCode::bad_input, fmt::format("{}: expected {} bytes, found {}", name, size, found));
  return decode_rows(bytes, {bytes.get(), size}, name);
}

}  // namespace

Result<RowsFile> read_rows(const fs::path& file) {
  const FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (descriptor.get() < 0) {
    return fail(ErrorCode::bad_input, fmt::format("{}: expected a file, found {}", file.string(),
                                                  std::generic_category().message(errno)));
  }
  try {
    return read(file, descriptor.get());
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file);
  }
}

}  // namespace relume
