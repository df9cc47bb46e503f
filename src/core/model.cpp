// SPDX-License-Identifier: MIT
#include "core/model.h"

namespace relume {

std::vector<std::uint32_t> cluster_offsets(const Model& model) {
  std::vector<std::uint32_t> offsets{0};
  for (const System& system : model.systems) {
    offsets.push_back(offsets.back() + static_cast<std::uint32_t>(system.clusters.size()));
  }
  return offsets;
}

std::vector<std::uint32_t> gather_offsets(const Model& model) {
  std::vector<std::uint32_t> offsets{0};
  for (const System& system : model.systems) {
    offsets.push_back(offsets.back() +
                      static_cast<std::uint32_t>(system.lumels.size() + system.sensors.size()));
  }
  return offsets;
}

}  // namespace relume
