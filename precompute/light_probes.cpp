// SPDX-License-Identifier: MIT
#include "precompute/light_probes.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "precompute/progress.h"
#include "precompute/sphere_tracer.h"

namespace relume {
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
  for (const SphereTracer& tracer : tracers) {
    add_rays(tracer, counts);
    counts.probe_rays += tracer.rays() + tracer.occlusion_rays();
  }
  return rows;
}

}  // namespace relume
