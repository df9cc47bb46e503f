// SPDX-License-Identifier: MIT
#include "precompute/check_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <set>

#include "precompute/system_tiles.h"

namespace relume {
namespace {

constexpr std::uint32_t kFewestSystemLumels = 64, kMostSystemLumels = 1u << 24;

/// Which root each sender stands under.
std::vector<std::uint32_t> roots_of(const ClusterTree& tree, std::size_t senders) {
  std::vector<std::uint32_t> roots(senders, 0);
  for (const auto root : tree.roots) {
    const TreeNodeRange& range = tree.nodes[root];
    std::fill_n(roots.begin() + std::ptrdiff_t(range.first), range.count, root);
  }
  return roots;
}

/// The tile that is furthest below what it needs.
struct Shortage {
  std::uint32_t budget = 0, needed = 0, node = 0;
};

/// Per cluster: the node of the scene that it lies on.
std::vector<std::uint32_t> nodes_of(const Surfaces& surfaces, const ClusteredSurface& system) {
  std::vector<std::uint32_t> nodes(system.cluster_count);
  for (std::size_t e = 0; e < system.cluster.size(); ++e)
    nodes[system.cluster[e]] = surfaces.charts[system.surface.elements[e].chart].node;
  return nodes;
}

void check_system(const ClusteredSurface& system, const std::vector<std::uint32_t>& nodes,
                  const std::vector<std::uint32_t>& roots, const std::vector<FormFactorRow>& rows,
                  const std::vector<CutLimits>& node_cuts, Shortage& shortage) {
  for (std::uint32_t first = 0; first < system.cluster_count; first += kTileRows) {
    std::set<std::uint32_t> seen;
    std::uint32_t budget = 0, node = 0;
    bool limited = true;
    for (std::uint32_t c = first; c < std::min(first + kTileRows, system.cluster_count); ++c) {
      for (const auto sender : rows[system.senders[c]].senders) seen.insert(roots[sender]);
      limited = limited && node_cuts[nodes[c]].budget > 0;
      if (node_cuts[nodes[c]].budget > budget) budget = node_cuts[nodes[c]].budget, node = nodes[c];
    }
    if (limited && seen.size() > budget && seen.size() > shortage.needed)
      shortage = {budget, std::uint32_t(seen.size()), node};
  }
}

}  // namespace

Result<void> check_options(const PrecomputeOptions& options) {
  const auto bad = [](const std::string& text) { return fail(ErrorCode::usage, text); };
  if (!(options.texel_size >= 0.0) || !std::isfinite(options.texel_size)) {
    return bad(fmt::format("texel size {}: expected a length in metres above 0 (or 0 for automatic)",
                           options.texel_size));
  }
  if (!(options.cluster_size >= 0.0) || !std::isfinite(options.cluster_size)) {
    return bad(fmt::format("cluster size {}: expected a length in metres above 0 (or 0 for automatic)",
                           options.cluster_size));
  }
  if (!(options.error >= 0.0 && options.error < 1.0)) {
    return bad(fmt::format("error {}: expected above 0 and below 1 (5% or 0.05)", options.error));
  }
  if (!(options.probe_spacing >= 0.0) || !std::isfinite(options.probe_spacing)) {
    return bad(fmt::format("probe spacing {}: expected a length in metres above 0 (or 0 for no grid)",
                           options.probe_spacing));
  }
  if (options.quality != 0 && (options.quality < 8 || options.quality > kMaxQuality)) {
    return bad(fmt::format("quality {}: expected 8 to {} rays per lumel", options.quality, kMaxQuality));
  }
  if (options.system_lumels < kFewestSystemLumels || options.system_lumels > kMostSystemLumels) {
    return bad(fmt::format("system lumels {}: expected {} to {} lumels in a system", options.system_lumels,
                           kFewestSystemLumels, kMostSystemLumels));
  }
  if (!(options.max_albedo > 0.0 && options.max_albedo <= 0.9999)) {
    return bad(fmt::format("max albedo {}: expected above 0 and at most 0.9999", options.max_albedo));
  }
  return {};
}

Result<void> check_sizes(const PrecomputeOptions& options, const Geometry& geometry) {
  const double diagonal = double(glm::length(geometry.upper - geometry.lower));
  const auto check = [&](const char* what, double size) -> Result<void> {
    if (size <= diagonal) return {};
    return fail(ErrorCode::usage,
                fmt::format("{} size {}: expected at most the diagonal of the scene, {:.4g} m", what, size,
                            diagonal));
  };
  if (auto ok = check("cluster", options.cluster_size); !ok) return ok;
  return check("texel", options.texel_size);
}

Result<void> check_budgets(const Scene& scene, const Surfaces& surfaces, const ClusterTree& tree,
                           const std::vector<FormFactorRow>& rows, const std::vector<CutLimits>& node_cuts) {
  std::size_t senders = 0;
  for (const auto root : tree.roots)
    senders = std::max<std::size_t>(senders, tree.nodes[root].first + tree.nodes[root].count);
  const std::vector<std::uint32_t> roots = roots_of(tree, senders);
  Shortage shortage;
  for (const ClusteredSurface& system : surfaces.systems)
    check_system(system, nodes_of(surfaces, system), roots, rows, node_cuts, shortage);
  if (shortage.needed == 0) return {};
  const SceneNode& node = scene.nodes[shortage.node];
  const std::string of_node =
      node.extras.budget ? fmt::format(" of node \"{}\" (extras.relume)", node.path) : "";
  return fail(
      ErrorCode::usage,
      fmt::format("budget {}{}: expected at least {}, one node for each cluster tree that a tile of {} "
                  "rows sees; every room, lamp and the sky has its own",
                  shortage.budget, of_node, shortage.needed, kTileRows));
}

}  // namespace relume
