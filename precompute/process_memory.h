// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace relume {

/// Bytes of memory that the process has now, and has had at most. 0 where the system does not say.
std::uint64_t resident_bytes();
std::uint64_t peak_resident_bytes();

/// Bytes of addresses that the process has had at most: what a limit of addresses (ulimit -v) counts.
std::uint64_t peak_address_bytes();

/// Bytes of addresses that it has beyond its memory.
std::uint64_t reserved_bytes();

/// Gives memory that was freed back to the system, where the allocator would keep it.
void return_free_memory();

}  // namespace relume
