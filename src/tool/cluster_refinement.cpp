// SPDX-License-Identifier: MIT
#include "tool/cluster_refinement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/mix.h"
#include "core/ray_offset.h"
#include "precompute/ray_caster.h"
#include "precompute/sampling.h"
#include "tool/seen_point.h"

namespace relume {
namespace {

constexpr std::uint32_t kReceivers = 512, kRays = 512;

/// By how much each lumel differs from its cluster, lm/m2.
class LumelDetail {
 public:
  LumelDetail(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome) : model_(model) {
    const auto first_cluster = cluster_offsets(model), first_row = gather_offsets(model);
    for (std::size_t s = 0; s < model.systems.size(); ++s) {
      const System& system = model.systems[s];
      OfSystem of{
          std::vector<std::uint32_t>(std::size_t{system.lightmap_width} * system.lightmap_height, kNone), {}};
      for (std::uint32_t l = 0; l < system.lumels.size(); ++l) {
        const Lumel& lumel = system.lumels[l];
        of.lumel_at[std::size_t{lumel.y} * system.lightmap_width + lumel.x] = l;
        const std::size_t i = first_cluster[s] + system.elements[lumel.element].cluster,
                          row = first_row[s] + l;
        const Rgb radiosity = setup.lighting.exitance[i] +
                              setup.lighting.albedo[i] * (setup.gather_direct[row] + outcome.gathered[row]);
        const bool valid = (lumel.flags & kLumelInvalid) == 0;
        of.difference.push_back(valid ? radiosity - outcome.solution.radiosity[i] : Rgb(0.0));
      }
      systems_.push_back(std::move(of));
    }
  }

  /// 0 where nothing is known.
  Rgb at(const SeenPoint& point) const {
    const auto place = lightmap_place(model_, point);
    if (!place) return Rgb(0.0);
    const System& system = model_.systems[place->system];
    const auto x = std::int64_t(std::floor(place->texel.x)), y = std::int64_t(std::floor(place->texel.y));
    if (x < 0 || y < 0 || x >= system.lightmap_width || y >= system.lightmap_height) return Rgb(0.0);
    const OfSystem& of = systems_[place->system];
    const std::uint32_t lumel = of.lumel_at[std::size_t(y * system.lightmap_width + x)];
    return lumel == kNone ? Rgb(0.0) : of.difference[lumel];
  }

 private:
  struct OfSystem {
    std::vector<std::uint32_t> lumel_at;  ///< per texel, kNone: none
    std::vector<Rgb> difference;
  };
  const Model& model_;
  std::vector<OfSystem> systems_;
};

/// A lumel, and the row that gathers for it.
struct SampledLumel {
  const SurfaceElement* element;
  std::size_t row;
};

std::vector<SampledLumel> some_lumels(const Model& model) {
  std::vector<SampledLumel> all, some;
  const auto first_row = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t l = 0; l < system.lumels.size(); ++l) {
      if ((system.lumels[l].flags & kLumelInvalid) == 0)
        all.push_back({&system.elements[system.lumels[l].element], first_row[s] + l});
    }
  }
  const std::size_t count = std::min<std::size_t>(all.size(), kReceivers);
  for (std::size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return some;
}

/// What refinement changes at one lumel, by rays of their own for each seed.
Rgb change_at(const Model& model, const RayCaster& caster, const LumelDetail& detail, float offset,
              const SobolPoints& points, const SurfaceElement& element, std::uint64_t seed) {
  const Frame frame = frame_about(element.normal);
  const glm::vec3 from = element.position + offset * element.normal;
  Rgb sum(0.0);
  for (std::uint32_t first = 0; first < points.count(); first += kPacketSize) {
    RayPacket packet{};
    std::array<glm::vec3, kPacketSize> ways;
    for (std::uint32_t lane = 0; lane < kPacketSize; ++lane) {
      const SamplePoint point = points.scrambled(first + lane, seed);
      const glm::vec3 way = ways[lane] = frame.to_world(cosine_direction(point[0], point[1]));
      packet.origin_x[lane] = from.x, packet.origin_y[lane] = from.y, packet.origin_z[lane] = from.z;
      packet.direction_x[lane] = way.x, packet.direction_y[lane] = way.y, packet.direction_z[lane] = way.z;
      packet.near[lane] = 0.0f, packet.far[lane] = std::numeric_limits<float>::max();
    }
    caster.closest_hits(packet);
    for (std::uint32_t lane = 0; lane < kPacketSize; ++lane) {
      if (packet.triangle[lane] == kNoTriangle) continue;
      sum +=
          detail.at(seen_point(model, packet.triangle[lane], {packet.u[lane], packet.v[lane]}, ways[lane]));
    }
  }
  return sum / double(points.count());
}

}  // namespace

Result<std::optional<double>> cluster_size_error(const Model& model, const LightingSetup& setup,
                                                 const SolveOutcome& outcome) {
  const auto caster =
      RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
  if (!caster) return fail(caster.error());
  const LumelDetail detail(model, setup, outcome);
  const std::vector<SampledLumel> lumels = some_lumels(model);
  const SobolPoints points(kRays / 2);
  const float offset = ray_offset(model.occluders.positions);
  std::vector<double> agreed_by_both(lumels.size());
  tbb::parallel_for(std::size_t{0}, lumels.size(), [&](std::size_t k) {
    const auto change = [&](std::uint64_t half) {
      return change_at(model, *caster, detail, offset, points, *lumels[k].element, mix(half, lumels[k].row));
    };
    agreed_by_both[k] = glm::dot(change(1), change(2));
  });
  double agreed = 0.0, total = 0.0;
  for (std::size_t k = 0; k < lumels.size(); ++k) {
    const Rgb& value = outcome.gathered[lumels[k].row];
    agreed += agreed_by_both[k], total += glm::dot(value, value);
  }
  if (total <= 0.0) return std::optional<double>();
  return std::optional(std::sqrt(std::max(0.0, agreed / total)));
}

}  // namespace relume
