// SPDX-License-Identifier: MIT
#include "core/solve.h"

#include <fmt/format.h>

#include <cmath>

namespace relume {
namespace {

constexpr double kMaxAlbedo = 0.9999;

Result<void> check_array(const char* name, const std::vector<Rgb>& values, std::size_t length, double upper) {
  if (values.size() != length) {
    return fail(ErrorCode::check_failed,
                fmt::format("lighting: expected {} entries in {}, found {}", length, name, values.size()));
  }
  for (std::size_t index = 0; index < length; ++index) {
    for (int channel = 0; channel < 3; ++channel) {
      const double value = values[index][channel];
      if (std::isfinite(value) && value >= 0.0 && value <= upper) continue;
      return fail(ErrorCode::check_failed,
                  fmt::format("lighting: {}[{}], channel {}: expected a finite value from 0 to {}, found {}",
                              name, index, channel, upper, value));
    }
  }
  return {};
}

Rgb to_rgb(const std::array<float, 3>& value) {
  return {value[0], value[1], value[2]};
}

}  // namespace

Lighting stored_lighting(const Model& model) {
  Lighting lighting;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) {
      lighting.albedo.push_back(to_rgb(cluster.albedo));
      lighting.exitance.push_back(to_rgb(cluster.exitance));
    }
  }
  lighting.direct.assign(lighting.albedo.size(), Rgb(0.0));
  lighting.sky_radiosity.assign(model.sky_cells.size(), Rgb(0.0));
  return lighting;
}

Result<void> check_lighting(const Model& model, const Lighting& lighting) {
  const std::size_t clusters = cluster_offsets(model).back();
  // Values beyond this cannot be told apart from a mistake, and would overflow 32-bit sums.
  constexpr double kLargest = 1e30;
  if (auto checked = check_array("albedo", lighting.albedo, clusters, kMaxAlbedo); !checked) return checked;
  if (auto checked = check_array("exitance", lighting.exitance, clusters, kLargest); !checked) return checked;
  if (auto checked = check_array("direct", lighting.direct, clusters, kLargest); !checked) return checked;
  return check_array("sky_radiosity", lighting.sky_radiosity, model.sky_cells.size(), kLargest);
}

}  // namespace relume
