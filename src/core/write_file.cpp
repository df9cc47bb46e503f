// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>
#include <vector>

#include "core/file_descriptor.h"
#include "core/model_file.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

/// Removes a file unless it was given its final name.
class TemporaryName {
 public:
  explicit TemporaryName(fs::path path) : path_(std::move(path)) {}
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;
  ~TemporaryName() {
    if (!renamed_) ::unlink(path_.c_str());
  }
  const fs::path& path() const { return path_; }
  void keep() { renamed_ = true; }

 private:
  fs::path path_;
  bool renamed_ = false;
};

/// Space, quota and failing disks are code 5; a place that cannot be written is a wrong argument.
ErrorCode code_of(int error) {
  const bool storage =
      error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO || error == ENOMEM;
  return storage ? ErrorCode::out_of_memory : ErrorCode::usage;
}

tl::unexpected<Error> cannot(const char* verb, const fs::path& file, int error) {
  return fail(code_of(error),
              fmt::format("{}: cannot {}: {}", file.string(), verb, std::generic_category().message(error)));
}

using Parts = std::span<const std::span<const std::byte>>;

/// So many parts are written at once, at most (IOV_MAX of Linux).
constexpr std::size_t kPartsAtOnce = 1024;

/// Of `parts`, what follows the first `done` bytes.
std::vector<iovec> rest_of(Parts parts, std::size_t done) {
  std::vector<iovec> rest;
  for (const auto part : parts) {
    const std::size_t skipped = std::min(done, part.size());
    done -= skipped;
    if (skipped == part.size()) continue;
    rest.push_back({const_cast<std::byte*>(part.data() + skipped), part.size() - skipped});
  }
  return rest;
}

Result<void> write_all(int fd, Parts parts, const fs::path& file) {
  for (; !parts.empty(); parts = parts.subspan(std::min(kPartsAtOnce, parts.size()))) {
    const Parts some = parts.first(std::min(kPartsAtOnce, parts.size()));
    std::size_t done = 0;
    for (auto rest = rest_of(some, done); !rest.empty(); rest = rest_of(some, done)) {
      const ssize_t written = ::writev(fd, rest.data(), int(rest.size()));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return cannot("write", file, errno);
      done += std::size_t(written);
    }
  }
  return {};
}

/// Devices and pipes cannot be replaced; they are written into.
Result<void> write_into(const fs::path& file, Parts bytes) {
  const FileDescriptor descriptor(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
  if (!descriptor.open()) return cannot("open", file, errno);
  return write_all(descriptor.get(), bytes, file);
}

/// A name in the folder of `file` that nobody uses yet (a killed process of the same number may have left
/// one), opened.
int create_temporary(const fs::path& file, fs::path& temporary) {
  constexpr int kAttempts = 100;
  int descriptor = -1;
  for (int attempt = 0; attempt < kAttempts && descriptor < 0; ++attempt) {
    temporary = file.parent_path() / fmt::format(".relume-{}-{}.tmp", ::getpid(), attempt);
    descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) break;
  }
  return descriptor;
}

Result<void> sync_folder(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot sync a folder (EINVAL); the file itself is safe by then.
  if (!descriptor.open() || (::fsync(descriptor.get()) != 0 && errno != EINVAL))
    return cannot("sync", folder, errno);
  return {};
}

Result<void> replace(const fs::path& file, Parts bytes) {
  fs::path path;
  const int created = create_temporary(file, path);
  if (created < 0) return cannot("create", file, errno);
  TemporaryName temporary(path);
  {
    const FileDescriptor descriptor(created);
    if (auto written = write_all(descriptor.get(), bytes, file); !written) return written;
    if (::fsync(descriptor.get()) != 0) return cannot("sync", file, errno);
  }
  if (::rename(temporary.path().c_str(), file.c_str()) != 0) return cannot("rename to", file, errno);
  temporary.keep();
  return sync_folder(file);
}

}  // namespace

Result<void> write_file(const fs::path& file, std::span<const std::byte> bytes) {
  return write_parts(file, Parts(&bytes, 1));
}

Result<void> write_parts(const fs::path& file, Parts bytes) {
  std::error_code ignored;
  // A symbolic link stays; what it names is replaced.
  const fs::path target = fs::is_symlink(file, ignored) ? fs::weakly_canonical(file, ignored) : file;
  struct stat status {};
  if (::stat(target.c_str(), &status) != 0) {
    if (errno != ENOENT) return cannot("write", file, errno);
    return replace(target, bytes);
  }
  if (S_ISDIR(status.st_mode)) return cannot("write", file, EISDIR);
  return S_ISREG(status.st_mode) ? replace(target, bytes) : write_into(target, bytes);
}

Result<void> write_model(const Model& model, const fs::path& file) {
  for (const System& system : model.systems) {
    if (system.loaded) continue;
    return fail(ErrorCode::usage, fmt::format("{}: expected a whole model, found system {} not loaded",
                                              file.string(), system.name));
  }
  try {
    return write_parts(file, encode_model_parts(model).parts);
  } catch (const std::bad_alloc&) {
    std::size_t matrices = 0;
    for (const System& system : model.systems) {
      for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) {
        for (const MatrixBlock& block : matrix->blocks) matrices += block_bytes(block);
      }
    }
    return fail(ErrorCode::out_of_memory,
                fmt::format("{}: memory ran out: expected more than {} bytes more to write it, found less",
                            file.string(), matrices));
  }
}

}  // namespace relume
