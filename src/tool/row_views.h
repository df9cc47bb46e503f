// SPDX-License-Identifier: MIT
//
// What the rows of lumels are made of, as numbers to be drawn.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "core/model.h"

namespace relume {

/// Per gather row of system `s`, 0 to 1: the share of its form factors that goes to nodes of several clusters
/// or sky patches, whose light the row takes as a mean.
std::vector<double> shares_of_nodes(const Model& model, std::size_t s);

/// Per gather row of system `s`: how many senders it names, relative to the row that names most.
std::vector<double> relative_row_lengths(const Model& model, std::size_t s);

/// The valid lumel whose element lies nearest to `place` (world space, m).
struct ChosenLumel {
  std::size_t system = 0;
  std::size_t lumel = 0;
  double distance = 0.0;  ///< m
};
ChosenLumel nearest_lumel(const Model& model, const glm::dvec3& place);

/// Per cluster of all systems, numbered through, 0 to 1: the form factor from the lumel to it per area,
/// relative to the largest; of a node, by the shares of its leaves.
std::vector<double> form_factor_densities(const Model& model, const ChosenLumel& receiver);

}  // namespace relume
