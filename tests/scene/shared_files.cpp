// SPDX-License-Identifier: MIT
#include "scene/shared_files.h"

#include <cstdlib>

namespace relume::test {

std::optional<std::filesystem::path> shared_files() {
  const char* said = std::getenv("RELUME_SHARED_DIR");
  const std::filesystem::path folder =
      said ? std::filesystem::path(said) : std::filesystem::path(RELUME_SOURCE_DIR) / "../shared";
  if (!std::filesystem::is_directory(folder / "scenes")) return std::nullopt;
  return folder;
}

}  // namespace relume::test
