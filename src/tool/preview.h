// SPDX-License-Identifier: MIT
#pragma once

#include "core/model.h"
#include "core/sky.h"
#include "precompute/ray_caster.h"
#include "tool/image.h"
#include "tool/surface_shading.h"
#include "tool/tone_curve.h"
#include "tool/view_rays.h"

namespace relume {

/// All that a picture of a solved model needs; holds references.
struct SolvedScene {
  const Model& model;
  const RayCaster& caster;
  const SurfaceShading& shading;
  const Sky& sky;
};

struct Picture {
  ByteImage image;
  ToneCurve curve;
};

/// Radiance (cd/m2) of what a ray meets: a surface or the sky.
Rgb seen_radiance(const SolvedScene& scene, const ViewRay& ray, const ViewHit& hit);

/// Ray cast, 2 x 2 samples a pixel, automatic exposure.
Picture render_preview(const SolvedScene& scene, const Camera& camera, std::uint32_t width = 960,
                       std::uint32_t height = 540);

}  // namespace relume
