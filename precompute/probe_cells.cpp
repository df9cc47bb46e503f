// SPDX-License-Identifier: MIT
#include "precompute/probe_cells.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "precompute/probe_lattice.h"
#include "precompute/sphere_tracer.h"

namespace relume {
namespace {

/// Samples along each axis: near both ends, where walls may lie, and between.
constexpr std::array<float, 5> kSamplesAlong{0.01f, 0.25f, 0.5f, 0.75f, 0.99f};
constexpr std::size_t kSamples = kSamplesAlong.size() * kSamplesAlong.size() * kSamplesAlong.size();
/// Of the edge that each of them stands for.
constexpr std::array<double, 5> kSharesAlong{0.125, 0.25, 0.25, 0.25, 0.125};
/// Rays end so much before a sample, so that those on a surface are seen.
constexpr float kShort = 0.999f;
/// Planes nearer than this to each other, in shortest edges of the cell, are one.
constexpr float kSamePlane = 1e-3f;
/// A seen sample that is cut off counts so much against hidden ones.
constexpr double kLoss = 0.5;

using SampleSet = std::bitset<kSamples>;

/// Of the volume of the cell.
double sample_share(std::size_t sample) {
  constexpr std::size_t kAlong = kSamplesAlong.size();
  return kSharesAlong[sample % kAlong] * kSharesAlong[sample / kAlong % kAlong] *
         kSharesAlong[sample / (kAlong * kAlong)];
}

class CellCutter {
 public:
  CellCutter(const Geometry& geometry, const RayCaster& caster, const glm::vec3& lower,
             const glm::vec3& edges)
      : geometry_(geometry), caster_(caster), same_(kSamePlane * std::min({edges.x, edges.y, edges.z})) {
    for (const float z : kSamplesAlong) {
      for (const float y : kSamplesAlong) {
        for (const float x : kSamplesAlong) samples_.push_back(lower + edges * glm::vec3(x, y, z));
      }
    }
  }

  /// False when planes run out. `covered` gets the samples that the probe speaks for.
  bool cut_corner(const glm::vec3& probe, std::uint32_t corner, ProbeCell& cell, SampleSet& covered) {
    const std::size_t kept_planes = planes_.size();
    SampleSet hidden = look(probe), kept = ~hidden;
    std::uint16_t sides = 0;
    while (hidden.any()) {
      const std::optional<Choice> choice = best(probe, hidden, kept, sides);
      if (!choice) {
        planes_.resize(kept_planes), behind_.resize(kept_planes);
        return false;
      }
      const std::size_t p = use(*choice);
      sides = std::uint16_t(sides | (1u << (choice->positive ? p : 8 + p)));
      hidden &= ~choice->off;
      kept &= ~choice->off;
    }
    cell.sides[corner] = sides;
    covered = kept;
    return true;
  }

  const std::vector<glm::vec4>& planes() const { return planes_; }
  const std::vector<glm::vec3>& samples() const { return samples_; }

 private:
  struct Choice {
    glm::vec4 plane{0.0f};
    std::size_t index = kSamples;  ///< among planes_; kSamples: a new one
    bool positive = false;         ///< the side that is kept
    SampleSet off;
  };

  /// The samples that are hidden from a probe, and the planes that hide them.
  SampleSet look(const glm::vec3& probe) {
    SampleSet hidden;
    candidates_.clear();
    for (std::size_t first = 0; first < kSamples; first += kPacketSize) {
      RayPacket packet;
      for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
        const bool any = first + lane < kSamples;
        set_ray(packet, lane, probe, any ? samples_[first + lane] - probe : glm::vec3(1.0f),
                any ? kShort : -1.0f);
      }
      caster_.closest_hits(packet, RaySpread::wide, AlphaTest::solid);
      for (std::size_t lane = 0; lane < kPacketSize && first + lane < kSamples; ++lane) {
        if (packet.triangle[lane] == kNoTriangle) continue;
        hidden.set(first + lane);
        add_candidate(packet.triangle[lane]);
      }
    }
    return hidden;
  }

  bool same(const glm::vec4& a, const glm::vec4& b) const {
    const float along = glm::dot(glm::vec3(a), glm::vec3(b));
    return std::abs(along) > 0.9999f && std::abs(a.w - std::copysign(b.w, along * b.w)) < same_;
  }

  void add_candidate(std::uint32_t triangle) {
    const glm::vec3 normal = geometry_.normals[triangle];
    const glm::vec4 plane(normal, -glm::dot(normal, geometry_.positions[geometry_.triangles[triangle][0]]));
    for (const std::vector<glm::vec4>* known : {&planes_, &candidates_}) {
      for (const glm::vec4& other : *known) {
        if (same(plane, other)) return;
      }
    }
    candidates_.push_back(plane);
  }

  SampleSet samples_behind(const glm::vec4& plane) const {
    SampleSet behind;
    for (std::size_t s = 0; s < kSamples; ++s)
      behind[s] = glm::dot(glm::vec3(plane), samples_[s]) + plane.w <= 0.0f;
    return behind;
  }

  /// The plane that cuts off most of what is hidden for what is lost.
  std::optional<Choice> best(const glm::vec3& probe, const SampleSet& hidden, const SampleSet& kept,
                             std::uint16_t used) const {
    std::optional<Choice> best;
    double best_gain = 0.0;
    const auto consider = [&](const glm::vec4& plane, std::size_t index, const SampleSet& behind) {
      Choice choice{plane, index, glm::dot(glm::vec3(plane), probe) + plane.w > 0.0f, behind};
      if (!choice.positive) choice.off = ~behind;
      const std::size_t cut = (hidden & choice.off).count();
      if (cut == 0) return;
      const double lost = kLoss * double((kept & choice.off).count());
      const double gain = double(cut) / (1.0 + lost);
      if (best && gain <= best_gain) return;
      best = choice, best_gain = gain;
    };
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      if ((used >> p & 1u) == 0 && (used >> (8 + p) & 1u) == 0) consider(planes_[p], p, behind_[p]);
    }
    if (planes_.size() == kMaxCellPlanes) return best;
    for (const glm::vec4& plane : candidates_) consider(plane, kSamples, samples_behind(plane));
    return best;
  }

  std::size_t use(const Choice& choice) {
    if (choice.index != kSamples) return choice.index;
    planes_.push_back(choice.plane);
    behind_.push_back(samples_behind(choice.plane));
    std::erase_if(candidates_, [&](const glm::vec4& other) { return other == choice.plane; });
    return planes_.size() - 1;
  }

  const Geometry& geometry_;
  const RayCaster& caster_;
  float same_;  ///< m
  std::vector<glm::vec3> samples_;
  std::vector<glm::vec4> planes_;      ///< in use
  std::vector<SampleSet> behind_;      ///< per plane in use: samples that are not in front
  std::vector<glm::vec4> candidates_;  ///< of the corner at hand
};

}  // namespace

CutCell cut_cell(const Geometry& geometry, const RayCaster& caster,
                 const std::array<std::uint32_t, 8>& probes, std::span<const glm::vec3> positions,
                 const glm::vec3& lower, const glm::vec3& edges) {
  CellCutter cutter(geometry, caster, lower, edges);
  CutCell result;
  SampleSet all;
  for (std::uint32_t c = 0; c < 8; ++c) {
    result.cell.probes[c] = kNoProbe;
    SampleSet covered;
    if (probes[c] == kNoProbe || !cutter.cut_corner(positions[probes[c]], c, result.cell, covered)) continue;
    if (covered.none()) {
      result.cell.sides[c] = 0;
      continue;
    }
    result.cell.probes[c] = probes[c];
    all |= covered;
  }
  result.planes = cutter.planes();
  result.cell.plane_count = std::uint32_t(result.planes.size());
  for (std::size_t s = 0; s < kSamples; ++s) {
    if (!inside_box(geometry, cutter.samples()[s])) continue;
    if (all[s]) {
      result.covered += sample_share(s);
    } else if (in_free_space(geometry, caster, cutter.samples()[s], 0.0f)) {
      result.uncovered += sample_share(s);
    }
  }
  return result;
}

}  // namespace relume
