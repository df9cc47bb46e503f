// SPDX-License-Identifier: MIT
//
// Errors are values. Every function that its caller can make fail returns Result<T>; nothing in the library
// exits, aborts, prints, or throws across its border. The message is one sentence that names what failed,
// where, what was expected and what was found; the code decides the exit status of the command line.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace relume {

/// The numbers are the exit statuses of the command line.
enum class ErrorCode : int {
  check_failed = 1,   ///< well-formed data that breaks a promise
  usage = 2,          ///< an option or argument that makes no sense
  bad_input = 3,      ///< unreadable, malformed or stale input
  no_device = 4,      ///< no Vulkan device that meets the requirements, or the device was lost
  out_of_memory = 5,  ///< memory, device memory or disk space ran out
  cancelled = 130,    ///< the caller asked to stop (128 + SIGINT)
};

struct Error {
  ErrorCode code;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// What another function returned.
inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace relume
