// SPDX-License-Identifier: MIT
//
// Who may include and call what: the borders between the folders of the project.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace relume::test {

/// One sentence per crossing ("src/core/x.cpp:12: ..."), of all sources below `root`.
std::vector<std::string> find_crossings(const std::filesystem::path& root);

}  // namespace relume::test
