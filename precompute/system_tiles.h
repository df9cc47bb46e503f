// SPDX-License-Identifier: MIT
//
// Rows of a system in the order that the model stores, cut into tiles as they are traced.
#pragma once

#include <vector>

#include "precompute/cut_rows.h"
#include "precompute/row_plan.h"
#include "precompute/rows.h"

namespace relume {

inline constexpr std::uint32_t kTileRows = 8;

struct SystemTiles {
  std::vector<CutTile> clusters, lumels, sensors;  ///< sensors: tiles of one row
};

/// Tiles of the rows of all clusters; `node_cuts` per node of the scene.
std::vector<CutTile> cut_clusters(const CutSenders& senders, const TracedSystem& system,
                                  const SystemRows& rows, const std::vector<CutLimits>& node_cuts);

/// Cuts the rows of lumels batch by batch and lets go of them.
class LumelCutter {
 public:
  /// Borrows all; `order`: the elements in the order that the model stores, by cluster; `node_cuts` per node
  /// of the scene.
  LumelCutter(const CutSenders& senders, const TracedSystem& system, const std::vector<std::uint32_t>& order,
              const std::vector<CutLimits>& node_cuts);

  /// Rows of the elements of all clusters below `last` are there. What does not fill a tile waits for more.
  void take(std::uint32_t last, SystemRows& rows);
  /// All tiles; the last may have fewer rows.
  std::vector<CutTile> finish(SystemRows& rows);

 private:
  void cut(std::size_t count, SystemRows& rows);

  TileCutters cutters_;
  TracedSystem system_;
  const std::vector<std::uint32_t>& order_;
  const std::vector<CutLimits>& node_cuts_;
  std::size_t next_ = 0;                ///< in order_
  std::vector<std::uint32_t> waiting_;  ///< elements whose rows are not cut yet
  std::vector<CutTile> tiles_;
};

}  // namespace relume
