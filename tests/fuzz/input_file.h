// SPDX-License-Identifier: MIT
//
// Readers want a file; libFuzzer has bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/result.h"

namespace relume::test {

/// Writes the bytes to a file of that name in a folder of this process, which goes away with it; the same
/// file each time.
std::filesystem::path input_file(const std::string& name, const std::uint8_t* bytes, std::size_t size);

/// Ends the process, so that the fuzzer keeps the input.
void require(bool holds, const char* promise);

/// An error is bad input (exit 3) in one line that begins with the file.
void require_one_line(const Error& error, const std::string& name);

}  // namespace relume::test
