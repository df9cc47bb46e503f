// SPDX-License-Identifier: MIT
#include "precompute/area_sampler.h"

namespace relume {

void AreaSampler::add(const std::array<glm::vec3, 3>& corners, const glm::vec3& normal, float area) {
  const float below = this->area();
  flat_ = patches_.empty() || (flat_ && patches_[0].frame.normal == normal);
  patches_.push_back({corners[0], corners[1] - corners[0], corners[2] - corners[0], frame_about(normal),
                      below, area > 0.0f ? 1.0f / area : 0.0f});
  area_above_.push_back(below + area);
  if (patches_.size() > kVeryFewPatches) return;
  const auto own = fields(patches_.back());
  for (std::size_t f = 0; f < kFields; ++f) few_[f][patches_.size() - 1] = own[f];
}

SurfacePoint AreaSampler::sample(float u, float v) const {
  const float target = u * area();
  const Patch& patch = patches_[find(target)];
  const glm::vec2 at = triangle_point(share(patch.area_below, patch.inverse_area, target), v);
  return {patch.corner + at.x * patch.edge1 + at.y * patch.edge2, patch.frame.normal};
}

}  // namespace relume
