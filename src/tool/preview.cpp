// SPDX-License-Identifier: MIT
#include "tool/preview.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

/// Samples along each edge of a pixel.
constexpr std::uint32_t kGrid = 2;
constexpr std::uint32_t kSamples = kGrid * kGrid;
static_assert(kPacketSize % kSamples == 0);

Rgb sky_radiance(const Sky& sky, const glm::vec3& direction) {
  if (const Rgb* constant = std::get_if<Rgb>(&sky)) return *constant;
  const auto& image = std::get<EquirectangularSky>(sky);
  const double u = 0.5 + std::atan2(double(direction.x), -double(direction.z)) / (2.0 * kPi);
  const double v = std::acos(std::clamp(double(direction.y), -1.0, 1.0)) / kPi;
  const auto x = std::min(static_cast<std::uint32_t>(u * image.width), image.width - 1);
  const auto y = std::min(static_cast<std::uint32_t>(v * image.height), image.height - 1);
  return Rgb(image.radiance[std::size_t{y} * image.width + x]);
}

Rgb seen_radiance(const ViewedScene& scene, const ViewRay& ray, const ViewHit& hit) {
  return hit.met ? scene.radiance(hit.point) : sky_radiance(scene.sky, ray.direction);
}

/// Where in the picture, 0..1, sample `sample` lies.
glm::dvec2 place_of(std::size_t sample, const PictureSize& size) {
  const std::size_t pixel = sample / kSamples;
  const std::size_t inside = sample % kSamples;
  const std::size_t row = pixel / size.width, row_inside = inside / kGrid;
  const double x = double(pixel % size.width) + (double(inside % kGrid) + 0.5) / kGrid;
  const double y = double(row) + (double(row_inside) + 0.5) / kGrid;
  return {x / size.width, y / size.height};
}

/// Each sample is developed on its own: edges of lamps stay smooth.
template <class Shown>
ByteImage mean_of_samples(const std::vector<Rgb>& samples, const PictureSize& size, Shown shown) {
  ByteImage image(size.width, size.height);
  for (std::size_t pixel = 0; pixel < image.pixels.size(); ++pixel) {
    Rgb sum(0.0);
    for (std::uint32_t k = 0; k < kSamples; ++k) sum += shown(samples[pixel * kSamples + k]);
    image.pixels[pixel] = srgb_bytes(sum / double(kSamples));
  }
  return image;
}

}  // namespace

std::vector<Rgb> cast_picture(const ViewedScene& scene, const Camera& camera, const PictureSize& size) {
  const ViewFrame frame(scene.model, camera, double(size.width) / size.height);
  std::vector<Rgb> samples(std::size_t{size.width} * size.height * kSamples);
  const std::size_t packets = (samples.size() + kPacketSize - 1) / kPacketSize;
  tbb::parallel_for(std::size_t{0}, packets, [&](std::size_t packet) {
    const std::size_t first = packet * kPacketSize;
    ViewRays rays;
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      rays[lane] = frame.ray(place_of(std::min(first + lane, samples.size() - 1), size));
    }
    const ViewHits hits = trace(scene.model, scene.caster, rays);
    for (std::size_t lane = 0; lane < kPacketSize && first + lane < samples.size(); ++lane) {
      samples[first + lane] = seen_radiance(scene, rays[lane], hits[lane]);
    }
  });
  return samples;
}

ByteImage develop(const std::vector<Rgb>& samples, const ToneCurve& curve, const PictureSize& size) {
  return mean_of_samples(samples, size, [&](const Rgb& radiance) { return tone_mapped(curve, radiance); });
}

ByteImage develop_flat(const std::vector<Rgb>& samples, const PictureSize& size) {
  return mean_of_samples(samples, size, [](const Rgb& color) { return color; });
}

}  // namespace relume
