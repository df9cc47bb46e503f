// SPDX-License-Identifier: MIT
#include "core/import_radiosity.h"

namespace relume {

std::vector<Rgb> leaf_radiosity(const Lighting& lighting, const std::vector<Rgb>& radiosity) {
  std::vector<Rgb> leaves = radiosity;
  leaves.insert(leaves.end(), lighting.sky_radiosity.begin(), lighting.sky_radiosity.end());
  return leaves;
}

std::vector<Rgb> import_radiosity(const System& system, const LeafNumbers& numbers,
                                  const std::vector<Rgb>& leaves) {
  std::vector<Rgb> radiosity;
  for (const SenderRef& import : system.imports) {
    Rgb mean(0.0);
    for (const LeafRange& range : numbers.leaves_of(import).ranges) {
      for (std::uint32_t i = 0; i < range.count; ++i) mean += range.share_of(i) * leaves[range.first + i];
    }
    radiosity.push_back(mean);
  }
  return radiosity;
}

}  // namespace relume
