// SPDX-License-Identifier: MIT
#include "precompute/system_tiles.h"

#include <iterator>

namespace relume {

std::vector<CutLimits> cluster_cuts(const TracedSystem& system, const std::vector<CutLimits>& node_cuts) {
  std::vector<CutLimits> cuts(system.surface.cluster_count);
  for (std::size_t e = 0; e < system.surface.cluster.size(); ++e)
    cuts[system.surface.cluster[e]] = node_cuts[system.node(std::uint32_t(e))];
  return cuts;
}

LumelCutter::LumelCutter(const ClusterTree& tree, const Probing& probing, const TracedSystem& system,
                         const std::vector<std::uint32_t>& order, const std::vector<CutLimits>& node_cuts)
    : tree_(tree), probing_(probing), system_(system), order_(order), node_cuts_(node_cuts) {}

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
  std::vector<const FormFactorRow*> pointers;
  std::vector<CutLimits> limits;
  for (std::size_t i = 0; i < count; ++i) {
    pointers.push_back(&rows.elements[waiting_[i]]);
    limits.push_back(node_cuts_[system_.node(waiting_[i])]);
  }
  if (count == 0) return;
  auto tiles = cut_rows(tree_, probing_, pointers, {kTileRows, limits});
  std::move(tiles.begin(), tiles.end(), std::back_inserter(tiles_));
  for (std::size_t i = 0; i < count; ++i) rows.elements[waiting_[i]] = {};
  waiting_.erase(waiting_.begin(), waiting_.begin() + std::ptrdiff_t(count));
}

}  // namespace relume
