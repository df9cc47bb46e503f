// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>

namespace relume {

/// Zeros, aligned to a large page and in such pages where the system has some: first touches of small pages
/// take longer than what is done with them. Throws std::bad_alloc where there is no memory.
std::shared_ptr<std::byte> large_memory(std::size_t bytes);

}  // namespace relume
