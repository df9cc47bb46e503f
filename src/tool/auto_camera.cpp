// SPDX-License-Identifier: MIT
#include "tool/auto_camera.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>

#include "tool/free_space.h"

namespace relume {
namespace {

constexpr int kYaws = 16;
constexpr std::uint32_t kThumbWidth = 32;
constexpr std::uint32_t kThumbHeight = 18;
constexpr double kLeastDepth = 1e-3;  // of the diagonal
constexpr double kFieldOfView = 1.0;  // radians, vertical; 88 degrees across a 16:9 picture

Camera camera_at(const ViewedScene& scene, const glm::dvec3& eye, const glm::dvec3& forward) {
  Camera camera;
  camera.position = scene.model.origin + eye;
  camera.forward = glm::normalize(forward);
  camera.vertical_field_of_view = kFieldOfView;
  return camera;
}

struct EyeCandidate {
  Camera camera;
  double bonus = 0.0;
};

void add_inner_views(const ViewedScene& scene, const std::vector<Eye>& eyes,
                     std::vector<EyeCandidate>& candidates) {
  for (const Eye& eye : eyes) {
    for (int yaw = 0; yaw < kYaws; ++yaw) {
      const double angle = 2.0 * kPi * yaw / kYaws;
      for (const double pitch : {-0.05, -0.3}) {
        candidates.push_back(
            {camera_at(scene, eye.position, {std::cos(angle), std::tan(pitch), std::sin(angle)})});
      }
    }
  }
}

void add_outer_views(const ViewedScene& scene, const Bounds& bounds, double bonus,
                     std::vector<EyeCandidate>& candidates) {
  const glm::dvec3 middle = 0.5 * (bounds.low + bounds.high);
  for (int yaw = 0; yaw < kYaws; ++yaw) {
    const double angle = 2.0 * kPi * (yaw + 0.5) / kYaws;
    for (const double rise : {0.3, 0.7}) {
      const glm::dvec3 away = glm::normalize(glm::dvec3(std::cos(angle), rise, std::sin(angle)));
      candidates.push_back({camera_at(scene, middle + 0.85 * bounds.diagonal() * away, -away), bonus});
    }
  }
}

bool shines(const Sky& sky) {
  const Rgb* constant = std::get_if<Rgb>(&sky);
  return !constant || *constant != Rgb(0.0);
}

/// Views from outside are preferred where most eyes see a sky that shines.
std::vector<EyeCandidate> cameras_tried(const ViewedScene& scene, const Bounds& bounds) {
  const std::vector<Eye> eyes = eyes_in_free_space(scene.model, scene.caster, bounds.diagonal());
  const auto open =
      std::count_if(eyes.begin(), eyes.end(), [](const Eye& eye) { return eye.enclosed < 0.7; });
  std::vector<EyeCandidate> candidates;
  add_inner_views(scene, eyes, candidates);
  const bool outdoors = 2 * open > std::ssize(eyes) && shines(scene.sky);
  add_outer_views(scene, bounds, outdoors ? 0.7 : 0.0, candidates);
  return candidates;
}

/// Evenness of a histogram: 0 for one kind, 1 for `full` kinds or more that are equally common.
double variety(const std::map<std::uint64_t, int>& histogram, int total, double full) {
  double entropy = 0.0;
  for (const auto& [kind, count] : histogram) {
    const double share = double(count) / total;
    entropy -= share * std::log(share);
  }
  return std::min(1.0, entropy / std::log(full));
}

/// What a small picture shows.
struct Thumbnail {
  static constexpr int kPixels = kThumbWidth * kThumbHeight;
  std::map<std::uint64_t, int> things;  ///< pixels by node and material
  std::map<std::uint64_t, int> tones;   ///< pixels by luminance, three steps an octave
  int lit = 0;                          ///< the other counts but `near` and `touching` are of lit pixels
  int near = 0;                         ///< things that stand in the way
  int touching = 0;
  double log_depth = 0.0;

  double share(int pixels) const { return double(pixels) / kPixels; }
};

void add_pixel(const ViewedScene& scene, const ViewHit& hit, double diagonal, double dark,
               Thumbnail& thumbnail) {
  const Occluders& occluders = scene.model.occluders;
  const std::uint32_t triangle = hit.point.triangle;
  const double depth = std::min(double(hit.distance) / diagonal, 1.0);
  const double tone = luminance(scene.radiance(hit.point));
  thumbnail.near += depth < 0.12;
  thumbnail.touching += depth < 0.04;
  if (tone < dark) return;
  ++thumbnail.lit;
  thumbnail.log_depth += std::log(depth / kLeastDepth + 1.0) / std::log(1.0 / kLeastDepth + 1.0);
  ++thumbnail.things[std::uint64_t{occluders.node[triangle]} << 32 | occluders.material[triangle]];
  ++thumbnail.tones[static_cast<std::uint64_t>(3.0 * std::log2(tone / dark))];
}

Thumbnail look_through(const ViewedScene& scene, const Camera& camera, double diagonal, double dark) {
  const ViewFrame frame(scene.model, camera, double(kThumbWidth) / kThumbHeight);
  Thumbnail thumbnail;
  for (int first = 0; first < Thumbnail::kPixels; first += kPacketSize) {
    ViewRays rays;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const int column = (first + lane) % kThumbWidth, row = (first + lane) / kThumbWidth;
      rays[lane] = frame.ray({(column + 0.5) / kThumbWidth, (row + 0.5) / kThumbHeight});
    }
    for (const ViewHit& hit : trace(scene.model, scene.caster, rays)) {
      if (hit.met) add_pixel(scene, hit, diagonal, dark, thumbnail);
    }
  }
  return thumbnail;
}

/// The weights are a matter of taste, settled by looking at pictures.
double interest(const Thumbnail& picture) {
  if (picture.lit == 0) return 0.0;
  return 1.5 * picture.share(picture.lit) + 1.2 * variety(picture.things, picture.lit, 16.0) +
         0.8 * variety(picture.tones, picture.lit, 16.0) + picture.log_depth / picture.lit -
         1.5 * picture.share(picture.near) - 2.5 * picture.share(picture.touching);
}

/// A hundredth of the mean luminance of all surfaces: what is darker looks black.
double dark_luminance(const ViewedScene& scene) {
  const Occluders& occluders = scene.model.occluders;
  double sum = 0.0;
  double area = 0.0;
  for (std::uint32_t t = 0; t < occluders.triangles.size(); ++t) {
    const glm::vec3& a = occluder_corner(occluders, t, 0);
    const glm::vec3 normal =
        glm::cross(occluder_corner(occluders, t, 1) - a, occluder_corner(occluders, t, 2) - a);
    const Rgb radiance = scene.radiance({t, Side::front, glm::vec2(1.0f / 3.0f)});
    sum += glm::length(normal) * luminance(radiance);
    area += glm::length(normal);
  }
  return std::max(0.01 * sum / area, 1e-30);
}

bool shows_the_scene(const Thumbnail& picture) {
  return picture.share(picture.lit) > 0.3;
}

}  // namespace

Camera choose_camera(const ViewedScene& scene) {
  if (scene.model.occluders.triangles.empty()) return scene.model.camera.value_or(Camera{});
  const Bounds bounds = interesting_bounds(scene.model.occluders);
  const double diagonal = std::max(bounds.diagonal(), 1e-9);
  const double dark = dark_luminance(scene);
  if (scene.model.camera && shows_the_scene(look_through(scene, *scene.model.camera, diagonal, dark))) {
    return *scene.model.camera;
  }
  const std::vector<EyeCandidate> candidates = cameras_tried(scene, bounds);
  std::vector<double> scores(candidates.size());
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
    scores[i] = interest(look_through(scene, candidates[i].camera, diagonal, dark)) + candidates[i].bonus;
  });
  return candidates[std::max_element(scores.begin(), scores.end()) - scores.begin()].camera;
}

}  // namespace relume
