// SPDX-License-Identifier: MIT
//
// Rays through the pixels of a camera, as a glTF renderer sees them: the backs of single-sided materials are
// not drawn.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/model.h"
#include "precompute/ray_caster.h"
#include "tool/seen_point.h"

namespace relume {

struct ViewRay {
  glm::vec3 origin{0.0f};  ///< relative to Model::origin
  glm::vec3 direction{0.0f, 0.0f, -1.0f};
};

struct ViewHit {
  bool met = false;
  float distance = 0.0f;  ///< in lengths of the direction
  SeenPoint point;
};

using ViewRays = std::array<ViewRay, kPacketSize>;
using ViewHits = std::array<ViewHit, kPacketSize>;

/// Rays without end, for RayCaster.
RayPacket packet_of(const ViewRays& rays);

/// The first surface that is drawn along each ray.
ViewHits trace(const Model& model, const RayCaster& caster, const ViewRays& rays);

/// Turns pictures into rays: `place` runs from (0,0) at the top left to (1,1) at the bottom right.
class ViewFrame {
 public:
  ViewFrame(const Model& model, const Camera& camera, double aspect);
  ViewRay ray(const glm::dvec2& place) const;

 private:
  glm::dvec3 origin_;
  glm::dvec3 forward_;
  glm::dvec3 right_;  ///< half the width of the picture at distance 1
  glm::dvec3 up_;
};

}  // namespace relume
