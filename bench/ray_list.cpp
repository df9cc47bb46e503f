// SPDX-License-Identifier: MIT
#include "ray_list.h"

#include <algorithm>
#include <numeric>

#include "precompute/atlas.h"
#include "precompute/charts.h"
#include "precompute/clusters.h"
#include "precompute/elements.h"
#include "precompute/hemisphere_rays.h"
#include "precompute/receiver.h"
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

}  // namespace

Result<RayList> rays_of_precompute(const Scene& scene, const Geometry& geometry,
                                   const PrecomputeOptions& options, RayOrder order_of_rays) {
  const auto caster = make_caster(geometry);
  if (!caster) return tl::unexpected(caster.error());
  std::vector<std::string> warnings;
  const auto charts = make_charts(scene, geometry, options.texel_size, warnings);
  const auto layouts = lay_out_systems(scene, geometry, charts, *caster, {}, warnings);
  if (!layouts) return tl::unexpected(layouts.error());
  const auto texels = texel_sizes(scene, options.texel_size);
  const SobolPoints points(options.quality, order_of_rays == RayOrder::grouped ? options.quality : 0);
  RayList rays;
  rays.per_receiver = options.quality;
  for (const AtlasLayout& layout : *layouts) {
    Views views(geometry, *caster);
    const SystemSurface surface = make_elements(geometry, charts, layout, views);
    const auto clusters =
        make_clusters(geometry, charts, layout, surface, *caster, texels, {options.cluster_size, 0.0, {}});
    std::vector<std::uint32_t> order(clusters.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return clusters[a] < clusters[b]; });
    for (const auto e : order) {
      const Element& element = surface.elements[e];
      const Receiver receiver = Receiver::element(geometry, surface, element, charts[element.chart].side);
      const std::uint64_t key = mix(receiver.key(), options.seed);
      HemispherePacket packet;
      for (std::uint32_t first = 0; first < points.count(); first += kPacketSize) {
        fill_packet(geometry, *caster, receiver, points, key, first, packet);
        append(packet, rays);
      }
    }
  }
  return rays;
}

}  // namespace relume::bench
