// SPDX-License-Identifier: MIT
#include "tool/auto_camera.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>

namespace relume {
namespace {

constexpr int kEyesTried = 256;
constexpr int kEyesKept = 40;
constexpr int kProbeRays = 64;
constexpr int kYaws = 16;
constexpr std::uint32_t kThumbWidth = 32;
constexpr std::uint32_t kThumbHeight = 18;
constexpr double kLeastDepth = 1e-3;  // of the diagonal
constexpr double kFieldOfView = 1.0;  // radians, vertical; 88 degrees across a 16:9 picture

/// Radical inverse of i in a prime base: evenly spread numbers in 0..1 (J. Halton, 1960).
double halton(std::uint32_t i, std::uint32_t base) {
  double value = 0.0;
  for (double digit = 1.0 / base; i > 0; i /= base, digit /= base) value += digit * (i % base);
  return value;
}

glm::vec3 sphere_direction(int i, int count) {
  const double y = 1.0 - (2.0 * i + 1.0) / count;
  const double angle = i * kPi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(1.0 - y * y);
  return {float(r * std::cos(angle)), float(y), float(r * std::sin(angle))};
}

struct Bounds {
  glm::dvec3 low{0.0};
  glm::dvec3 high{0.0};
  double diagonal() const { return glm::distance(low, high); }
};

/// Where the triangles are, along each axis, when the outer `share` of them on each end does not count.
Bounds bounds_without(const Occluders& occluders, double share) {
  Bounds bounds;
  std::vector<double> places(occluders.triangles.size());
  const auto left_out = static_cast<std::size_t>(share * double(places.size()));
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](std::uint32_t t, int k) {
      return double(occluder_corner(occluders, t, k)[axis]);
    };
    for (std::uint32_t t = 0; t < places.size(); ++t) {
      places[t] = std::min({coordinate(t, 0), coordinate(t, 1), coordinate(t, 2)});
    }
    std::sort(places.begin(), places.end());
    bounds.low[axis] = places[left_out];
    for (std::uint32_t t = 0; t < places.size(); ++t) {
      places[t] = std::max({coordinate(t, 0), coordinate(t, 1), coordinate(t, 2)});
    }
    std::sort(places.begin(), places.end());
    bounds.high[axis] = places[places.size() - 1 - left_out];
  }
  return bounds;
}

/// All of the scene, or the busy part of one that lies in a wide plane.
Bounds interesting_bounds(const Occluders& occluders) {
  const Bounds all = bounds_without(occluders, 0.0);
  const Bounds busy = bounds_without(occluders, 0.05);
  return all.diagonal() > 2.0 * busy.diagonal() ? busy : all;
}

/// Cast rays without passing any backs: what is really there.
struct Surroundings {
  double front = 0.0;     ///< shares of the rays
  double back = 0.0;      ///< of single-sided surfaces
  double nearest = 0.0;   ///< distances; misses count as the diagonal
  double openness = 0.0;  ///< geometric mean distance of what is met
};

Surroundings look_around(const ViewedScene& scene, const glm::vec3& eye, double diagonal) {
  Surroundings around;
  around.nearest = diagonal;
  double log_sum = 0.0;
  for (int first = 0; first < kProbeRays; first += kPacketSize) {
    RayPacket packet;
    std::array<glm::vec3, kPacketSize> directions;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      directions[lane] = sphere_direction(first + lane, kProbeRays);
      packet.origin_x[lane] = eye.x, packet.origin_y[lane] = eye.y, packet.origin_z[lane] = eye.z;
      packet.direction_x[lane] = directions[lane].x;
      packet.direction_y[lane] = directions[lane].y;
      packet.direction_z[lane] = directions[lane].z;
      packet.near[lane] = 0.0f;
      packet.far[lane] = std::numeric_limits<float>::max();
    }
    scene.caster.closest_hits(packet);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const bool met = packet.triangle[lane] != kNoTriangle;
      const double distance = met ? std::min(double(packet.far[lane]), diagonal) : diagonal;
      around.nearest = std::min(around.nearest, distance);
      if (!met) continue;
      log_sum += std::log(std::max(distance, 1e-6 * diagonal));
      const SeenPoint point = seen_point(scene.model, packet.triangle[lane], {}, directions[lane]);
      (hidden_back(scene.model, point) ? around.back : around.front) += 1.0 / kProbeRays;
    }
  }
  const double share = around.front + around.back;
  around.openness = share > 0.0 ? std::exp(log_sum / (share * kProbeRays)) : 0.0;
  return around;
}

struct Eye {
  glm::dvec3 position{0.0};
  double worth = 0.0;     ///< 0: not usable
  double enclosed = 0.0;  ///< share of directions that meet a front
};

/// A place in the free space in front of a triangle: part of the way to whatever is opposite.
glm::vec3 place_before(const ViewedScene& scene, std::uint32_t i, double diagonal) {
  const Occluders& occluders = scene.model.occluders;
  const auto count = static_cast<std::uint32_t>(occluders.triangles.size());
  const auto triangle = std::min(static_cast<std::uint32_t>(halton(i, 2) * count), count - 1);
  const glm::vec3& a = occluder_corner(occluders, triangle, 0);
  const glm::vec3& b = occluder_corner(occluders, triangle, 1);
  const glm::vec3& c = occluder_corner(occluders, triangle, 2);
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const float root = std::sqrt(float(halton(i, 3)));
  const float along = float(halton(i, 5));
  const glm::vec3 start =
      (1.0f - root) * a + root * (1.0f - along) * b + root * along * c + float(1e-4 * diagonal) * normal;
  ViewRays rays;
  rays.fill({start, normal});
  const ViewHit hit = trace(scene.model, scene.caster, rays)[0];
  const double reach = hit.met ? std::min(double(hit.distance), 0.5 * diagonal) : 0.3 * diagonal;
  return start + float(reach * (0.15 + 0.7 * halton(i, 7))) * normal;
}

/// Eyes in free space, the most open among the enclosed first.
std::vector<Eye> inner_eyes(const ViewedScene& scene, double diagonal) {
  std::vector<Eye> eyes(kEyesTried);
  tbb::parallel_for(0, kEyesTried, [&](int i) {
    const glm::vec3 place = place_before(scene, static_cast<std::uint32_t>(i) + 1, diagonal);
    const Surroundings around = look_around(scene, place, diagonal);
    const bool usable = around.back < 0.4 && around.front > 0.3 && around.nearest > 0.01 * diagonal;
    eyes[i] = {glm::dvec3(place), usable ? around.openness * around.front : 0.0, around.front};
  });
  std::stable_sort(eyes.begin(), eyes.end(), [](const Eye& a, const Eye& b) { return a.worth > b.worth; });
  std::erase_if(eyes, [](const Eye& eye) { return eye.worth <= 0.0; });
  if (eyes.size() > kEyesKept) eyes.resize(kEyesKept);
  return eyes;
}

Camera camera_at(const ViewedScene& scene, const glm::dvec3& eye, const glm::dvec3& forward) {
  Camera camera;
  camera.position = scene.model.origin + eye;
  camera.forward = glm::normalize(forward);
  camera.vertical_field_of_view = kFieldOfView;
  return camera;
}

struct Candidate {
  Camera camera;
  double bonus = 0.0;
};

void add_inner_views(const ViewedScene& scene, const std::vector<Eye>& eyes,
                     std::vector<Candidate>& candidates) {
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
                     std::vector<Candidate>& candidates) {
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
std::vector<Candidate> cameras_tried(const ViewedScene& scene, const Bounds& bounds) {
  const std::vector<Eye> eyes = inner_eyes(scene, bounds.diagonal());
  const auto open =
      std::count_if(eyes.begin(), eyes.end(), [](const Eye& eye) { return eye.enclosed < 0.7; });
  std::vector<Candidate> candidates;
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
      const int pixel = first + lane;
      rays[lane] =
          frame.ray({(pixel % kThumbWidth + 0.5) / kThumbWidth, (pixel / kThumbWidth + 0.5) / kThumbHeight});
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
  const std::vector<Candidate> candidates = cameras_tried(scene, bounds);
  std::vector<double> scores(candidates.size());
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
    scores[i] = interest(look_through(scene, candidates[i].camera, diagonal, dark)) + candidates[i].bonus;
  });
  return candidates[std::max_element(scores.begin(), scores.end()) - scores.begin()].camera;
}

}  // namespace relume
