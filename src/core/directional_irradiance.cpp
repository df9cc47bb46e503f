// SPDX-License-Identifier: MIT
#include "core/directional_irradiance.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "core/import_radiosity.h"
#include "core/packed_direction.h"
#include "core/value_codec.h"

namespace relume {
namespace {

constexpr double kMostFactor = 4.0;

IrradianceMoments row_moments(const MatrixBlock& block, std::uint32_t row, const std::vector<Rgb>& imports) {
  IrradianceMoments sums{};
  if (block.directions.empty()) return sums;
  const std::uint32_t tile = row / block.tile_rows, lane = row % block.tile_rows;
  for (std::uint32_t entry = block.tile_offsets[tile]; entry < block.tile_offsets[tile + 1]; ++entry) {
    const std::size_t index = std::size_t{entry} * block.tile_rows + lane;
    const double factor = unscaled_value(block.codec, block.values, index) * block.row_scales[row];
    const glm::dvec3 direction = unpack_direction(block.directions[index]);
    for (int axis = 0; axis < 3; ++axis)
      sums[std::size_t(axis)] += factor * direction[axis] * imports[block.columns[entry]];
  }
  return sums;
}

}  // namespace

bool is_directional(const System& system) {
  return std::any_of(system.gather.blocks.begin(), system.gather.blocks.end(),
                     [](const MatrixBlock& block) { return !block.directions.empty(); });
}

bool is_directional(const Model& model) {
  return std::any_of(model.systems.begin(), model.systems.end(),
                     [](const System& system) { return is_directional(system); });
}

std::vector<IrradianceMoments> directional_irradiance(const Model& model, const Lighting& lighting,
                                                      const std::vector<Rgb>& radiosity) {
  std::vector<IrradianceMoments> moments;
  if (!is_directional(model)) return moments;
  const LeafNumbers numbers(model);
  const std::vector<Rgb> leaves = leaf_radiosity(lighting, radiosity);
  for (const System& system : model.systems) {
    const std::vector<Rgb> imports = import_radiosity(system, numbers, leaves);
    for (const MatrixBlock& block : system.gather.blocks) {
      for (std::uint32_t row = 0; row < block.row_count; ++row)
        moments.push_back(row_moments(block, row, imports));
    }
  }
  return moments;
}

glm::dvec3 dominant_direction(const IrradianceMoments& moments, const Rgb& irradiance) {
  const double whole = luminance(irradiance);
  if (!(whole > 0.0)) return glm::dvec3(0.0);
  const glm::dvec3 d =
      glm::dvec3(luminance(moments[0]), luminance(moments[1]), luminance(moments[2])) / whole;
  return d / std::max(1.0, glm::length(d));
}

double bent_irradiance_factor(const glm::dvec3& d, const glm::dvec3& normal, const glm::dvec3& bent) {
  const double even = 2.0 * (1.0 - glm::length(d));
  const double here = std::max(1e-6, even + glm::dot(d, normal));
  const double there = std::max(0.0, even + glm::dot(d, bent));
  return std::min(there / here, kMostFactor);
}

FlatMoments flat_moments(const std::vector<IrradianceMoments>& moments, const std::vector<Rgb>& irradiance) {
  FlatMoments flat;
  for (std::size_t row = 0; row < moments.size(); ++row) {
    flat.values.insert(flat.values.end(), moments[row].begin(), moments[row].end());
    flat.magnitudes.insert(flat.magnitudes.end(), moments[row].size(), irradiance[row]);
  }
  return flat;
}

}  // namespace relume
