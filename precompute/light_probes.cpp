// SPDX-License-Identifier: MIT
#include "precompute/light_probes.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "precompute/progress.h"
#include "precompute/sphere_tracer.h"

namespace relume {
namespace {

constexpr double kMostProbes = 1e6;

}  // namespace

Result<std::vector<ProbePoint>> probe_grid(const Geometry& geometry, double spacing) {
  glm::dvec3 lower(geometry.positions.front()), upper = lower;
  for (const glm::vec3& position : geometry.positions) {
    lower = glm::min(lower, glm::dvec3(position));
    upper = glm::max(upper, glm::dvec3(position));
  }
  const glm::dvec3 size = upper - lower;
  const glm::dvec3 count = glm::max(glm::dvec3(1.0), glm::floor(size / spacing + 1e-6));
  if (!(count.x * count.y * count.z <= kMostProbes)) {
    return fail(
        ErrorCode::usage,
        fmt::format("probe spacing {} m: expected at most {:.0f} probes in a scene of {:.4g} x {:.4g} x "
                    "{:.4g} m, found {:.3g}",
                    spacing, kMostProbes, size.x, size.y, size.z, count.x * count.y * count.z));
  }
  const glm::dvec3 first = geometry.origin + lower + 0.5 * (size - spacing * (count - 1.0));
  std::vector<ProbePoint> points;
  for (double z = 0.0; z < count.z; ++z) {
    for (double y = 0.0; y < count.y; ++y) {
      for (double x = 0.0; x < count.x; ++x)
        points.push_back({fmt::format("{}", points.size()), first + spacing * glm::dvec3(x, y, z)});
    }
  }
  return points;
}

Result<std::vector<ProbeRow>> trace_probes(const RowScene& scene, std::span<const ProbePoint> points,
                                           std::uint32_t rays, RowCounts& counts,
                                           const ProgressObserver& observer) {
  std::vector<ProbeRow> rows(points.size());
  if (points.empty()) return rows;
  const std::uint32_t whole_packets = (rays + kPacketSize - 1) / kPacketSize * kPacketSize;
  const SobolPoints samples(whole_packets, whole_packets);
  tbb::enumerable_thread_specific<SphereTracer> tracers([&] { return SphereTracer(scene); });
  Progress progress(observer, "probes", points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (progress.cancelled()) return;
    rows[i] = tracers.local().trace(glm::vec3(points[i].position - scene.geometry.origin), samples);
    progress.one_done();
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped while tracing the rays of probes");
  for (const SphereTracer& tracer : tracers)
    counts.rays += tracer.rays(), counts.occlusion_rays += tracer.occlusion_rays();
  return rows;
}

}  // namespace relume
