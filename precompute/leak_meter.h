// SPDX-License-Identifier: MIT
//
// The leak meter: light that rows of a finished model receive from where they cannot see.
//
// A column that is a node gives a row its form factor F, and with it the mean radiosity of all clusters of
// the node: each of them takes part with F times its share of the node's area, also those that the row does
// not see. All numbers here are such shares of form factors: parts of a row's hemisphere.
//   hidden   of clusters of which the row sees no point
//   walled   of points that the row does not see, nor any of the places that it sees: behind a wall, not
//            around a corner. Counted by points, so that clusters on two sides of a wall are found too.
// A column of one cluster is looked at as well. Being seen is a matter of a few shadow rays (those below):
// what shows through a narrow slit only may be taken for hidden, so the numbers err on the high side. Noise
// is not measured, nor are senders in the sky.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "core/model.h"
#include "core/result.h"

namespace relume {

/// Points that stand for a cluster, a lumel, or whatever else has surface: one in each of so many equal parts
/// of its area.
inline constexpr std::uint32_t kLeakPoints = 8;
/// Clusters of a node that are looked at: all, or where it has more, one in each of so many equal parts of
/// its area.
inline constexpr std::uint32_t kLeakClusters = 16;
/// Rays by which a row looks around; the middle and the end of each is a place that it sees.
inline constexpr std::uint32_t kLeakViews = 32;

struct LeakOptions {
  std::uint32_t rows = 1024;  ///< lumels, and as many clusters, evenly by their numbers; at least 1
  std::uint32_t threads = 0;  ///< 0 = all
  bool clusters = true;       ///< false: lumels alone
};

enum class LeakReceiver : std::uint32_t { lumel, cluster };

/// What one row receives from where it cannot see.
struct RowLeak {
  LeakReceiver kind = LeakReceiver::lumel;
  std::uint32_t system = 0;
  std::uint32_t index = 0;  ///< of the lumel or cluster in its system
  std::uint32_t node = 0;   ///< of the scene
  glm::dvec3 place{0.0};    ///< m, world space
  double hidden = 0.0;      ///< of its hemisphere
  double walled = 0.0;      ///< of its hemisphere
  /// The cluster that takes the largest part in what is walled, or if nothing is, in what is hidden.
  SenderRef sender{kNone, kNone};
  std::uint32_t sender_node = kNone;
  glm::dvec3 sender_place{0.0};  ///< m, world space: centroid of that cluster
};

/// Over rows of one kind.
struct LeakSummary {
  std::uint64_t rows = 0;
  double mean_hidden = 0.0, largest_hidden = 0.0;
  double mean_walled = 0.0, largest_walled = 0.0;
};

struct LeakReport {
  LeakSummary lumels, clusters;
  std::vector<RowLeak> rows;  ///< all that were looked at: lumels, then clusters, both by system
};

/// Rows of invalid lumels, of sensors and of systems that are not loaded are left out. The model must be
/// valid (check_model). The same for any number of threads. Fails when memory runs out.
Result<LeakReport> measure_leaks(const Model& model, const LeakOptions& options = {});

/// The `count` rows with most of `what` (RowLeak::hidden or walled), worst first, without those that have
/// none.
std::vector<RowLeak> worst_leaks(const LeakReport& report, double RowLeak::*what, std::size_t count);

}  // namespace relume
