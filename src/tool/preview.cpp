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

/// One radiance per sample, pixel by pixel.
std::vector<Rgb> cast_samples(const SolvedScene& scene, const ViewFrame& frame, std::uint32_t width,
                              std::uint32_t height) {
  std::vector<Rgb> samples(std::size_t{width} * height * kSamples);
  const auto place_of = [&](std::size_t sample) {
    const std::size_t pixel = sample / kSamples;
    const std::size_t corner_of_pixel = sample % kSamples;
    const double x = double(pixel % width) + (double(corner_of_pixel % kGrid) + 0.5) / kGrid;
    const double y = double(pixel / width) + (double(corner_of_pixel / kGrid) + 0.5) / kGrid;
    return glm::dvec2(x / width, y / height);
  };
  const std::size_t packets = (samples.size() + kPacketSize - 1) / kPacketSize;
  tbb::parallel_for(std::size_t{0}, packets, [&](std::size_t packet) {
    const std::size_t first = packet * kPacketSize;
    ViewRays rays;
    for (int lane = 0; lane < kPacketSize; ++lane)
      rays[lane] = frame.ray(place_of(std::min(first + lane, samples.size() - 1)));
    const ViewHits hits = trace(scene.model, scene.caster, rays);
    for (std::size_t lane = 0; lane < kPacketSize && first + lane < samples.size(); ++lane) {
      samples[first + lane] = seen_radiance(scene, rays[lane], hits[lane]);
    }
  });
  return samples;
}

}  // namespace

Rgb seen_radiance(const SolvedScene& scene, const ViewRay& ray, const ViewHit& hit) {
  return hit.met ? scene.shading.radiance(hit.point) : sky_radiance(scene.sky, ray.direction);
}

Picture render_preview(const SolvedScene& scene, const Camera& camera, std::uint32_t width,
                       std::uint32_t height) {
  const ViewFrame frame(scene.model, camera, double(width) / height);
  const std::vector<Rgb> samples = cast_samples(scene, frame, width, height);
  Picture picture{ByteImage(width, height), fit_tone_curve(samples)};
  for (std::size_t pixel = 0; pixel < picture.image.pixels.size(); ++pixel) {
    // Each sample goes through the curve on its own: edges of lamps stay smooth.
    Rgb sum(0.0);
    for (std::uint32_t k = 0; k < kSamples; ++k)
      sum += tone_mapped(picture.curve, samples[pixel * kSamples + k]);
    picture.image.pixels[pixel] = srgb_bytes(sum / double(kSamples));
  }
  return picture;
}

}  // namespace relume
