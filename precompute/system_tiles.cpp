// SPDX-License-Identifier: MIT
#include "precompute/system_tiles.h"

#include <iterator>

namespace relume {

LumelCutter::LumelCutter(const Survey& survey, const ClusteredSurface& surface,
                         const std::vector<bool>& own_elements, const std::vector<std::uint32_t>& order,
                         const CutLimits& limits)
    : survey_(survey), surface_(surface), own_elements_(own_elements), order_(order), limits_(limits) {}

void LumelCutter::take(std::uint32_t last, SystemRows& rows) {
  for (; next_ < order_.size() && surface_.cluster[order_[next_]] < last; ++next_) {
    if (own_elements_[order_[next_]]) waiting_.push_back(order_[next_]);
  }
  cut(waiting_.size() / kTileRows * kTileRows, rows);
}

std::vector<CutTile> LumelCutter::finish(SystemRows& rows) {
  cut(waiting_.size(), rows);
  return std::move(tiles_);
}

void LumelCutter::cut(std::size_t count, SystemRows& rows) {
  std::vector<const FormFactorRow*> pointers;
  for (std::size_t i = 0; i < count; ++i) pointers.push_back(&rows.elements[waiting_[i]]);
  auto tiles = cut_rows(survey_.senders.tree, survey_.probing, pointers, {kTileRows, limits_});
  std::move(tiles.begin(), tiles.end(), std::back_inserter(tiles_));
  for (std::size_t i = 0; i < count; ++i) rows.elements[waiting_[i]] = {};
  waiting_.erase(waiting_.begin(), waiting_.begin() + std::ptrdiff_t(count));
}

}  // namespace relume
