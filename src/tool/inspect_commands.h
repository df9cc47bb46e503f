// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "tool/console.h"

namespace relume {

struct InfoArguments {
  std::filesystem::path file;
};

struct CheckArguments {
  std::filesystem::path file;
  bool leaks = false;
};

/// `relume info`: what is in a .relume file.
Result<int> run(const InfoArguments& arguments, Console& console);

/// `relume check`: verifies a .relume file; fails with what is broken first. With `leaks`, measures what rows
/// receive from where they cannot see (precompute/leak_meter.h) and passes whatever it finds.
Result<int> run(const CheckArguments& arguments, Console& console);

}  // namespace relume
