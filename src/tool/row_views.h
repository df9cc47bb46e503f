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

/// Per gather row of system `s`: how many clusters or sky patches a sender that it sees stands for, as log2,
/// mean by form factor: 0 where it sees leaves alone, k where it sees through nodes of 2^k. 0 of an empty
/// row.
std::vector<double> tree_levels(const Model& model, std::size_t s);

/// Per gather row of system `s`: sum of its form factors.
std::vector<double> row_sums(const Model& model, std::size_t s);

/// Per gather row of system `s`: how many senders it names.
std::vector<double> row_lengths(const Model& model, std::size_t s);

/// The valid lumel whose element lies nearest to `place` (world space, m).
struct ChosenLumel {
  std::size_t system = 0;
  std::size_t lumel = 0;
  double distance = 0.0;  ///< m
};
ChosenLumel nearest_lumel(const Model& model, const glm::dvec3& place);

/// Per cluster of all systems, numbered through: the form factor from the lumel to it per area, 1/m2; of a
/// node, by the shares of its leaves.
std::vector<double> form_factor_densities(const Model& model, const ChosenLumel& receiver);

}  // namespace relume
