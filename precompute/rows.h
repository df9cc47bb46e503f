// SPDX-License-Identifier: MIT
//
// All rows of a model: the same rays serve a cluster's row of K and its lumels' rows of G.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/result.h"
#include "precompute/precompute.h"
#include "precompute/probing.h"
#include "precompute/row_store.h"
#include "precompute/row_tracer.h"

namespace relume {

struct SystemRows {
  std::vector<FormFactorRow> clusters;
  std::vector<FormFactorRow>
      elements;  ///< rows of the elements that are lumels' own; empty ones for the others
  /// In place of either, where they are encoded as they are traced.
  std::vector<StoredRow> stored_clusters, stored_elements;
  std::vector<RowStore> stores;                ///< of the stored ones
  std::vector<float> element_back_face_share;  ///< per element
  std::vector<RowRays> element_rays;           ///< per element
};

/// How many rays a row gets.
struct RayLimits {
  std::uint32_t rays = 512;   ///< per row; with an exchange, at most
  std::uint32_t least = 512;  ///< to begin with
  double exchange = 0.0;      ///< above 0: doubled while the square of the noise of a cluster's elements
                              ///< together, divided by the rays of each, is larger; 0: `rays` at once
  double area = 0.0;          ///< m2, of elements on average: noise counts by area
  const Probing* probing = nullptr;  ///< needed with an exchange
  std::uint32_t every = 1;           ///< only rows in_sample() are traced, the others stay empty
};

/// Whether rows of a cluster and its elements belong to a sample of one in `every` tiles of 8 clusters of
/// each system.
inline bool in_sample(std::uint32_t cluster, std::uint32_t every) {
  return cluster / 8 % every == 0;
}

struct RowCounts {
  std::uint64_t traced = 0, kept = 0;  ///< of both kinds: in this run, and taken from an earlier one
  std::uint64_t rays = 0;
  std::uint64_t occlusion_rays = 0;
  std::uint64_t probe_rays = 0;  ///< of both kinds, those of light probes
  std::uint64_t cluster_entries = 0,
                element_entries = 0;  ///< form factors of full rows, of lumels' own elements
};

/// Adds what a tracer, of rows or of probes, has counted.
template <class Tracer>
void add_rays(const Tracer& tracer, RowCounts& counts) {
  counts.rays += tracer.rays();
  counts.occlusion_rays += tracer.occlusion_rays();
  counts.traced += tracer.sight().traced() + tracer.sight().traced_samples();
  counts.kept += tracer.sight().kept() + tracer.sight().kept_samples();
}

/// Clusters go in batches of about so many elements where rows are cut, so that full ones need not be held
/// together.
inline constexpr std::size_t kBatchElements = 16384;

/// An element most of whose rays meet back faces lies inside other geometry: it does not count towards its
/// cluster's row, unless all of them do.
inline constexpr float kInvalidShare = 0.5f;

/// What tracing needs of a system.
struct TracedSystem {
  const std::vector<Chart>& charts;
  const ClusteredSurface& surface;
  const std::vector<bool>& own_elements;  ///< per element: whether it is a lumel's own

  /// Of the scene, that an element lies on.
  std::uint32_t node(std::uint32_t element) const {
    return charts[surface.surface.elements[element].chart].node;
  }
};

/// Elements of each cluster, ascending.
std::vector<std::vector<std::uint32_t>> members_of_clusters(const ClusteredSurface& system);

/// Of some elements of a system.
std::vector<Receiver> receivers_of(const RowScene& scene, const TracedSystem& system,
                                   std::span<const std::uint32_t> members);

/// The elements of all clusters below `last` have their rows: whoever wants them may take them away.
using RowsTaker = std::function<void(std::uint32_t last, SystemRows& rows)>;

/// Rows of every cluster and lumel of a system, in the calling task arena. With a taker, it is called now and
/// then and at the end, and gets the clusters in their order. Cancelled when the observer says so.
/// `node_quality`: per node of the scene, rays of its rows; 0: as `limits` say.
Result<SystemRows> trace_system(const RowScene& scene, const TracedSystem& system, const RayLimits& limits,
                                std::span<const std::uint32_t> node_quality, RowCounts& counts,
                                const ProgressObserver& observer, const RowsTaker& taker = {},
                                const StoreChoice& store = {});

/// Rows of clusters alone, of few rays: enough to see what lights what.
struct SurveyRows {
  std::vector<FormFactorRow> first, second;  ///< of half of the rays each
};
Result<SurveyRows> trace_survey(const RowScene& scene, const std::vector<Chart>& charts,
                                const std::vector<ClusteredSurface>& systems, RowCounts& counts,
                                const ProgressObserver& observer);

/// Means of the rows of both.
std::vector<FormFactorRow> mean_rows(const SurveyRows& halves, std::size_t senders);

struct SensorRows {
  std::vector<FormFactorRow> rows;
  std::vector<RowRays> rays;
};

/// Rows of points; `points` lie on no surface (lifted already).
Result<SensorRows> trace_sensors(const RowScene& scene, std::span<const SurfacePoint> points,
                                 const RayLimits& limits, RowCounts& counts,
                                 const ProgressObserver& observer);

}  // namespace relume
