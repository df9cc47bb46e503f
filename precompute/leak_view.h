// SPDX-License-Identifier: MIT
//
// What the leak meter asks of surfaces: points that stand for them, and which of those a receiver sees.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/model.h"
#include "precompute/geometry.h"
#include "precompute/leak_meter.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"

namespace relume {

/// One point in each of as many equal parts of a surface's area, lifted off it.
using LeakPoints = std::array<SurfacePoint, kLeakPoints>;

/// Bits of all of them.
inline constexpr std::uint32_t kAllLeakPoints = (1u << kLeakPoints) - 1u;

struct WeightPart {
  std::uint32_t index = 0;
  double share = 0.0;  ///< of the sum of the weights that it stands for
};

/// One index in each of `count` equal parts of the sum of the weights; none where that is 0.
std::vector<WeightPart> spread(std::span<const double> weights, std::uint32_t count);

/// Points of surfaces of a model.
class PointSpreader {
 public:
  /// Borrows both.
  PointSpreader(const Model& model, const RayCaster& caster);

  /// Of lifted points, m.
  float offset() const { return geometry_.offset; }

  /// On the elements [first, first + count). A point that the middle of its element does not see (a piece
  /// that a wall runs through may reach beyond it) gives way to that middle.
  LeakPoints points(const System& system, std::uint32_t first, std::uint32_t count) const;

 private:
  glm::vec3 at(std::uint32_t triangle, const glm::vec2& uv) const;
  double area(const SurfacePiece& piece) const;
  SurfacePoint point_of(const System& system, const SurfaceElement& element, const SurfacePiece& piece,
                        std::uint32_t k) const;
  SurfacePoint owned(const SurfaceElement& element, const SurfacePoint& point) const;

  const Occluders& occluders_;
  const RayCaster& caster_;
  Geometry geometry_;  ///< its offset only
};

/// How one receiver sees the scene.
class LeakView {
 public:
  /// Borrows the caster and the points, of the receiver. A ray that escapes ends after `far` metres; those
  /// that meet something, `offset` before it.
  LeakView(const RayCaster& caster, const LeakPoints& points, float offset, float far);

  /// Bit k: some point of the receiver and the front of point k see each other.
  std::uint32_t sees(const LeakPoints& to) const;

  /// Bit k of those in `asked`: some place in view sees the front of point k.
  std::uint32_t joined(const LeakPoints& to, std::uint32_t asked) const;

 private:
  void look_around(std::uint32_t first, float offset, float far);

  const RayCaster& caster_;
  const LeakPoints& points_;
  std::vector<glm::vec3> places_;
};

}  // namespace relume
