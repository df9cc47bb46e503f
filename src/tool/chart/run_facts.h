// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace relume {

/// Names and values, in the order of showing.
using Facts = std::vector<std::pair<std::string, std::string>>;

/// Program, version and commit; compiler; processor, cores, system, and how busy it is now.
Facts facts_of_this_run();

/// Load averages of 1, 5 and 15 minutes.
std::string load_text();

}  // namespace relume
