// SPDX-License-Identifier: MIT
#include "ray_list.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "precompute/atlas.h"
#include "precompute/charts.h"
#include "precompute/clusters.h"
#include "precompute/elements.h"
#include "precompute/hemisphere_rays.h"
#include "precompute/views.h"

namespace relume::bench {
namespace {

void append(const HemispherePacket& packet, RayList& rays) {
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if (!packet.used[lane]) continue;
    rays.origin_x.push_back(packet.rays.origin_x[lane]);
    rays.origin_y.push_back(packet.rays.origin_y[lane]);
    rays.origin_z.push_back(packet.rays.origin_z[lane]);
    rays.direction_x.push_back(packet.rays.direction_x[lane]);
    rays.direction_y.push_back(packet.rays.direction_y[lane]);
    rays.direction_z.push_back(packet.rays.direction_z[lane]);
  }
}

void clear(RayList& rays) {
  for (auto* list : {&rays.origin_x, &rays.origin_y, &rays.origin_z, &rays.direction_x, &rays.direction_y,
                     &rays.direction_z})
    list->clear();
}

}  // namespace

RaysOfPrecompute::RaysOfPrecompute(const Geometry& geometry, const RayCaster& caster,
                                   const PrecomputeOptions& options)
    : geometry_(geometry),
      caster_(caster),
      seed_(options.seed),
      sequence_(options.quality),
      grouped_(options.quality, options.quality) {}

Result<RaysOfPrecompute> RaysOfPrecompute::create(const Scene& scene, const Geometry& geometry,
                                                  const RayCaster& caster, const PrecomputeOptions& options) {
  RaysOfPrecompute rays(geometry, caster, options);
  std::vector<std::string> warnings;
  const auto charts = make_charts(scene, geometry, options.texel_size, warnings);
  const auto layouts = lay_out_systems(scene, geometry, charts, caster, {}, warnings);
  if (!layouts) return tl::unexpected(layouts.error());
  const auto texels = texel_sizes(scene, options.texel_size);
  for (const AtlasLayout& layout : *layouts) {
    Views views(geometry, caster);
    const SystemSurface surface = make_elements(geometry, charts, layout, views);
    const auto clusters =
        make_clusters(geometry, charts, layout, surface, caster, texels, {options.cluster_size, 0.0, {}});
    std::vector<std::uint32_t> order(clusters.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return clusters[a] < clusters[b]; });
    for (const auto e : order) {
      const Element& element = surface.elements[e];
      rays.receivers_.push_back(Receiver::element(geometry, surface, element, charts[element.chart].side));
    }
  }
  return rays;
}

void RaysOfPrecompute::list(std::size_t first, RayOrder order, std::span<RayList> lists) const {
  const SobolPoints& points = order == RayOrder::grouped ? grouped_ : sequence_;
  tbb::parallel_for(std::size_t{0}, lists.size(), [&](std::size_t i) {
    clear(lists[i]);
    const Receiver& receiver = receivers_[first + i];
    const std::uint64_t key = mix(receiver.key(), seed_);
    HemispherePacket packet;
    for (std::uint32_t point = 0; point < points.count(); point += kPacketSize) {
      fill_packet(geometry_, caster_, receiver, points, key, point, packet);
      append(packet, lists[i]);
    }
  });
}

}  // namespace relume::bench
