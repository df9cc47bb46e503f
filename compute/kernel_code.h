// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "compute/pipelines.h"

namespace relume {

/// The SPIR-V of a kernel, embedded when the library was built. Valid for ever.
std::span<const std::uint32_t> kernel_code(KernelId kernel);

/// Its name: the file in kernels/ without ".comp".
const char* kernel_file_name(KernelId kernel);

}  // namespace relume
