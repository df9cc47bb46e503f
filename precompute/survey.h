// SPDX-License-Identifier: MIT
//
// A look around with few rays, before rows are traced: what lights what, in which rooms, and which
// differences matter.
#pragma once

#include <vector>

#include "precompute/number_senders.h"
#include "precompute/probed_rooms.h"
#include "precompute/probing.h"
#include "precompute/rows.h"

namespace relume {

struct Survey {
  SenderTree senders;
  Probing probing;
  std::vector<FormFactorRow> rows;  ///< per sender that is a cluster
};

/// Traces the survey, finds the rooms, unless those of an earlier survey of the same elements are given, and
/// gives clusters the numbers of its cluster tree: in `surfaces`, `lookup`, `emitters`, which are the ones
/// that `scene` borrows, and in the numbers of its sky's cells. In the calling task arena.
Result<Survey> survey(RowScene& scene, const std::vector<Chart>& charts,
                      std::vector<ClusteredSurface>& surfaces, SenderLookup& lookup, Emitters& emitters,
                      ElementRooms& rooms, RowCounts& counts, const ProgressObserver& observer);

}  // namespace relume
