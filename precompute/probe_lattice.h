// SPDX-License-Identifier: MIT
//
// Where light probes may stand: corners of cells, moved a little where a corner lies in or on geometry.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <span>
#include <vector>

#include "core/probe_volume.h"
#include "precompute/geometry.h"

namespace relume {

/// In steps of the finest cells, from the lower end of the volume.
using LatticePoint = std::array<std::int32_t, 3>;

/// Whether a point can see: few of the rays around it meet back faces, and none meets anything nearer than
/// `clearance` (m).
bool in_free_space(const Geometry& geometry, const RayCaster& caster, const glm::vec3& point,
                   float clearance);

/// Whether a point lies in the box of the geometry, beyond which nobody asks for light.
inline bool inside_box(const Geometry& geometry, const glm::vec3& point) {
  return glm::all(glm::lessThanEqual(geometry.lower, point)) &&
         glm::all(glm::lessThanEqual(point, geometry.upper));
}

class ProbeLattice {
 public:
  /// Borrows `geometry` and `caster`. `step`: m, along each axis.
  ProbeLattice(const Geometry& geometry, const RayCaster& caster, const glm::vec3& lower,
               const glm::vec3& step)
      : geometry_(geometry), caster_(caster), lower_(lower), step_(step) {}

  glm::vec3 place(const LatticePoint& at) const { return lower_ + size(at); }
  /// m along each axis of a box of so many steps.
  glm::vec3 size(const LatticePoint& edges) const {
    return step_ * glm::vec3(float(edges[0]), float(edges[1]), float(edges[2]));
  }

  /// Finds room for a probe at each of `points` that is new: there, or up to a third of `edges` (m) away. In
  /// the calling task arena; the same for any number of threads.
  void add(std::vector<LatticePoint> points, const glm::vec3& edges);

  /// Number of the probe of a point that was added; kNoProbe where there is no room.
  std::uint32_t probe(const LatticePoint& at) const { return probes_.at(at); }

  /// Of all probes.
  const std::vector<glm::vec3>& positions() const { return positions_; }

 private:
  const Geometry& geometry_;
  const RayCaster& caster_;
  glm::vec3 lower_;
  glm::vec3 step_;
  std::map<LatticePoint, std::uint32_t> probes_;
  std::vector<glm::vec3> positions_;
};

}  // namespace relume
