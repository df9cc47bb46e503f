// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <vector>

#include "core/model.h"
#include "core/sky.h"
#include "precompute/ray_caster.h"
#include "tool/image.h"
#include "tool/seen_point.h"
#include "tool/tone_curve.h"
#include "tool/view_rays.h"

namespace relume {

/// All that a picture needs; holds references.
struct ViewedScene {
  const Model& model;
  const RayCaster& caster;
  std::function<Rgb(const SeenPoint&)> radiance;  ///< cd/m2, of surfaces; called from several threads
  const Sky& sky;
};

struct PictureSize {
  std::uint32_t width = 960;
  std::uint32_t height = 540;
};

/// What a camera sees, 2 x 2 samples a pixel: radiance of samples, pixel by pixel.
std::vector<Rgb> cast_picture(const ViewedScene& scene, const Camera& camera, const PictureSize& size = {});

/// The picture of those samples through a tone curve.
ByteImage develop(const std::vector<Rgb>& samples, const ToneCurve& curve, const PictureSize& size = {});

/// The picture of samples that are display-linear colours already, 0..1.
ByteImage develop_flat(const std::vector<Rgb>& samples, const PictureSize& size = {});

}  // namespace relume
