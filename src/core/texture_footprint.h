// SPDX-License-Identifier: MIT
//
// Where clusters lie in an image that their material shows.
#pragma once

#include <cstdint>
#include <vector>

#include "core/model.h"

namespace relume {

/// A point of the image and what it counts for. A mean over a cluster is the sum of weight x texel.
struct FootprintSample {
  float u = 0.0f;  ///< 1 = the whole image, row 0 first; outside of 0..1 as the image is wrapped
  float v = 0.0f;
  float weight = 0.0f;  ///< of one cluster, they add up to 1
};

struct ClusterFootprint {
  std::uint32_t cluster = 0;  ///< of the system
  std::uint32_t first_sample = 0;
  std::uint32_t sample_count = 0;
};

struct TextureFootprint {
  std::vector<ClusterFootprint> clusters;
  std::vector<FootprintSample> samples;
};

/// Of the clusters of `system` with this material, those that have texture coordinates (Occluders::texture):
/// points spread over their solid area, as dense as an image of `width` x `height` needs
/// (core/piece_samples.h).
TextureFootprint texture_footprint(const Model& model, std::uint32_t system, std::uint32_t material,
                                   std::uint32_t width, std::uint32_t height);

}  // namespace relume
