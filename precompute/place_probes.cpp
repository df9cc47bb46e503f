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
/// Halvings of a root cell at most; root cells are half as large as the scene is thin, but no less than a
/// sixteenth of its length.
constexpr std::uint32_t kDepth = 3;
constexpr double kRootsAcross = 0.5, kRootsAlong = 16.0;
/// Cells that are halved at once add up to so much of what is to be saved.
constexpr double kStep = 0.3;

/// Of all leaves that can be halved: what others lose, close to a lamp or in a narrow gap, more probes
/// elsewhere do not save.
struct Balance {
  double loss = 0.0, free = 0.0;
};

Balance balance_of(const ProbeTree& tree) {
  Balance sum;
  for (const OpenCell& cell : tree.cells()) {
    if (cell.first_child == 0 && cell.edge >= 2) sum.loss += cell.loss, sum.free += cell.free;
  }
  return sum;
}

/// The cells to be halved next: those that lose most for each probe that halving them adds, up to a part of
/// the `excess` that is to be saved.
std::vector<std::uint32_t> cells_to_halve(const ProbeTree& tree, double excess) {
  std::vector<std::pair<double, std::uint32_t>> worth;
  for (std::uint32_t i = 0; i < tree.cells().size(); ++i) {
    const OpenCell& cell = tree.cells()[i];
    if (cell.first_child != 0) continue;
    if (cell.edge >= 2 && cell.loss > 0.0) worth.emplace_back(cell.loss / tree.cost_of_halving(cell), i);
  }
  std::sort(worth.begin(), worth.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  std::vector<std::uint32_t> chosen;
  for (double saved = 0.0; excess > 0.0 && chosen.size() < worth.size() && saved < kStep * excess;) {
    chosen.push_back(worth[chosen.size()].second);
    saved += tree.cells()[chosen.back()].loss;
  }
  return chosen;
}

}  // namespace

Result<PlacedProbes> place_probe_grid(const Geometry& geometry, const RayCaster& caster, double spacing) {
  const ProbeVolume roots = root_volume(geometry, spacing);
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
  ProbeTree tree(scene.geometry, scene.caster, root_volume(scene.geometry, edge), kDepth);
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
    if (critic.places() < kMostPlaces) tree.halve(cells_to_halve(tree, balance.loss - allowed));
  }
  critic.add_counts(counts);
  return tree.finish();
}

}  // namespace relume
