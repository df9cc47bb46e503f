// SPDX-License-Identifier: MIT
#include "precompute/place_probes.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <utility>

#include "precompute/probe_critic.h"
#include "precompute/probe_tree.h"

namespace relume {
namespace {

constexpr double kMostProbes = 1e6;
/// Where probes are placed automatically, halving stops when so many places were looked from.
constexpr std::size_t kMostPlaces = 600'000;
/// Halvings of a root cell at most, across each axis; root cells are at most 0.4 times as large as
/// the scene is thin, or a sixteenth of its length if that is more.
constexpr std::uint32_t kDepth = 4;
constexpr double kRootsAcross = 0.4, kRootsAlong = 16.0;
/// What halving a cell is taken to save at least, of what it loses: halves of halves may save what neither
/// does alone.
constexpr double kHope = 0.1;
/// Halves that need no new probe are not free: they cost room.
constexpr double kLeastCost = 0.5;
/// Cells that are halved at once add up to so much of what is to be saved.
constexpr double kStep = 0.2;

/// Of all leaves that can be halved: what others lose, close to a lamp or in a narrow gap, more probes
/// elsewhere do not save.
struct Balance {
  double loss = 0.0, free = 0.0;
};

Balance balance_of(const ProbeTree& tree) {
  Balance sum;
  for (std::size_t i = 0; i < tree.cells().size(); ++i) {
    const OpenCell& cell = tree.cells()[i];
    if (!tree.splits(i).empty()) sum.loss += cell.loss, sum.free += cell.free;
  }
  return sum;
}

struct Choice {
  ChosenSplit split;
  double saved = 0.0, worth = 0.0;  ///< in all, and for each probe that it adds
};

/// Of the splits of a cell the one that saves most for each probe that it adds.
Choice best_split(const ProbeTree& tree, std::uint32_t index) {
  const OpenCell& cell = tree.cells()[index];
  Choice best;
  for (std::uint32_t p = 0; p < tree.splits(index).size(); ++p) {
    const CellSplit& split = tree.splits(index)[p];
    const double left = split.halves[0].loss + split.halves[1].loss;
    const double saves = std::max(cell.loss - left, kHope * cell.loss);
    const double worth = saves / std::max(tree.cost_of(split), kLeastCost);
    if (worth > best.worth) best = {{index, p}, saves, worth};
  }
  return best;
}

/// The cells to be halved next: those that save most for each probe that halving them adds, up to a part of
/// the `excess` that is to be saved.
std::vector<ChosenSplit> cells_to_split(const ProbeTree& tree, double excess) {
  std::vector<Choice> choices;
  for (std::uint32_t i = 0; i < tree.cells().size(); ++i) {
    if (tree.splits(i).empty()) continue;
    if (const Choice choice = best_split(tree, i); choice.worth > 0.0) choices.push_back(choice);
  }
  std::stable_sort(choices.begin(), choices.end(),
                   [](const Choice& a, const Choice& b) { return a.worth > b.worth; });
  std::vector<ChosenSplit> chosen;
  for (double saved = 0.0; excess > 0.0 && chosen.size() < choices.size() && saved < kStep * excess;) {
    saved += choices[chosen.size()].saved;
    chosen.push_back(choices[chosen.size()].split);
  }
  return chosen;
}

}  // namespace

Result<PlacedProbes> place_probe_grid(const Geometry& geometry, const RayCaster& caster, double spacing) {
  const ProbeVolume roots = cubic_roots(geometry, spacing);
  const glm::dvec3 size = glm::dvec3(geometry.upper) - glm::dvec3(geometry.lower);
  const glm::dvec3 corners = glm::ceil(size / spacing - 1e-6) + 1.0;
  if (!(corners.x * corners.y * corners.z <= kMostProbes)) {
    return fail(
        ErrorCode::usage,
        fmt::format("probe spacing {} m: expected at most {:.0f} probes in a scene of {:.4g} x {:.4g} x "
                    "{:.4g} m, found {:.3g}",
                    spacing, kMostProbes, size.x, size.y, size.z, corners.x * corners.y * corners.z));
  }
  ProbeTree tree(geometry, caster, roots, 0);
  return tree.finish();
}

Result<PlacedProbes> place_probes(const RowScene& scene, const Probing& probing, double error,
                                  RowCounts& counts, const ProgressObserver& observer) {
  const glm::vec3 size = scene.geometry.upper - scene.geometry.lower;
  const double longest = std::max({size.x, size.y, size.z}), thinnest = std::min({size.x, size.y, size.z});
  const double edge = std::max(kRootsAcross * thinnest, longest / kRootsAlong);
  ProbeTree tree(scene.geometry, scene.caster, fitted_roots(scene.geometry, edge), kDepth);
  ProbeCritic critic(scene, probing, tree);
  double done = 0.0;
  for (std::size_t first = 0; first < tree.cells().size();) {
    if (observer && !observer("probe places", done))
      return fail(ErrorCode::cancelled, "stopped while placing probes");
    critic.rate(first);
    const Balance balance = balance_of(tree);
    const double allowed = error * error * balance.free;
    done = balance.loss > allowed ? allowed / balance.loss : 1.0;
    first = tree.cells().size();
    if (critic.places() < kMostPlaces) tree.split(cells_to_split(tree, balance.loss - allowed));
  }
  critic.add_counts(counts);
  return tree.finish();
}

}  // namespace relume
