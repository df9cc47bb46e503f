// SPDX-License-Identifier: MIT
#include "precompute/system_tiles.h"

#include <iterator>

namespace relume {

namespace {

/// Errors of clusters are those of many senders by the time that they reach a lumel, and mostly cancel: 0.4
/// here instead takes 1.3 times the form factors between clusters, and lessens the error of no light by a
/// twentieth (two furnished rooms; a dark room that light reaches through a door).
constexpr double kClusterShareOfError = 0.8;
/// Where halvings are kept, for narrow bounds: what rows between clusters leave open goes through all
/// bounces.
constexpr double kClusterShareForBounds = 0.4;

/// Limits of each row of a system's clusters.
std::vector<CutLimits> cluster_cuts(const TracedSystem& system, const std::vector<CutLimits>& node_cuts,
                                    double share) {
  std::vector<CutLimits> cuts(system.surface.cluster_count);
  for (std::size_t e = 0; e < system.surface.cluster.size(); ++e)
    cuts[system.surface.cluster[e]] = node_cuts[system.node(std::uint32_t(e))];
  for (CutLimits& cut : cuts) cut.node_error *= share;
  return cuts;
}

}  // namespace

std::vector<CutTile> cut_clusters(const CutSenders& senders, const TracedSystem& system,
                                  const SystemRows& rows, const std::vector<CutLimits>& node_cuts) {
  std::vector<CutRow> cut(system.surface.cluster_count);
  for (std::size_t c = 0; c < cut.size(); ++c) cut[c].row = &rows.clusters[c];
  for (std::size_t e = 0; e < system.surface.cluster.size(); ++e) {
    const Element& element = system.surface.surface.elements[e];
    CutRow& row = cut[system.surface.cluster[e]];
    row.rays += float(rows.element_rays[e].count);
    row.area += element.area;
    row.place = {element.position, element.normal};
  }
  const double share = senders.places != nullptr ? kClusterShareForBounds : kClusterShareOfError;
  const std::vector<CutLimits> limits = cluster_cuts(system, node_cuts, share);
  return cut_rows(senders, cut, {kTileRows, limits});
}

LumelCutter::LumelCutter(const CutSenders& senders, const TracedSystem& system,
                         const std::vector<std::uint32_t>& order, const std::vector<CutLimits>& node_cuts)
    : cutters_([senders] { return TileCutter(senders); }),
      system_(system),
      order_(order),
      node_cuts_(node_cuts) {}

void LumelCutter::take(std::uint32_t last, SystemRows& rows) {
  for (; next_ < order_.size() && system_.surface.cluster[order_[next_]] < last; ++next_) {
    if (system_.own_elements[order_[next_]]) waiting_.push_back(order_[next_]);
  }
  cut(waiting_.size() / kTileRows * kTileRows, rows);
}

std::vector<CutTile> LumelCutter::finish(SystemRows& rows) {
  cut(waiting_.size(), rows);
  return std::move(tiles_);
}

void LumelCutter::cut(std::size_t count, SystemRows& rows) {
  std::vector<CutRow> cut;
  std::vector<CutLimits> limits;
  for (std::size_t i = 0; i < count; ++i) {
    const Element& element = system_.surface.surface.elements[waiting_[i]];
    cut.push_back({&rows.elements[waiting_[i]],
                   float(rows.element_rays[waiting_[i]].count),
                   element.area,
                   {element.position, element.normal}});
    limits.push_back(node_cuts_[system_.node(waiting_[i])]);
  }
  if (count == 0) return;
  auto tiles = cut_rows(cutters_, cut, {kTileRows, limits});
  std::move(tiles.begin(), tiles.end(), std::back_inserter(tiles_));
  for (std::size_t i = 0; i < count; ++i) rows.elements[waiting_[i]] = {};
  waiting_.erase(waiting_.begin(), waiting_.begin() + std::ptrdiff_t(count));
}

}  // namespace relume
