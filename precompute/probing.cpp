// SPDX-License-Identifier: MIT
#include "precompute/probing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <numeric>

#include "core/quantities.h"
#include "core/sky.h"
#include "precompute/clearance.h"
#include "precompute/probed_rooms.h"
#include "precompute/probing_dice.h"
#include "precompute/probing_means.h"
#include "precompute/rows.h"
#include "precompute/sampling.h"
#include "precompute/weighted_sums.h"

namespace relume {
namespace {

constexpr int kBounces = 12;
constexpr float kLeastAlbedo = 0.2f, kMostAlbedo = 0.8f;
/// By how much albedo may differ inside a material.
constexpr float kTexture = 0.2f;
/// Shares of the surface of a room: square of the distance that lamps keep, and area of what glows, at least.
constexpr float kLampStandOff = 1e-3f, kLeastPatch = 2e-3f;
/// Places tried for a lamp and for a spot light, which would light next to nothing from near.
constexpr int kLampTries = 4, kSpotTries = 8;
/// Half the angle of the cone of a spot light, at least and at most; it is as bright as can be to half of
/// that.
constexpr float kNarrowCone = 0.4f, kWideCone = 0.7f;
/// By how much light may differ across a room, in waves from about as long as the room is to so many times
/// shorter: other lights shine in other places.
constexpr float kWave = 0.5f, kShortestWave = 12.0f;
/// Rooms beyond so many, and those of less than this share of all surface, glow instead of being lit: shadow
/// rays are for the large ones.
constexpr std::uint32_t kLitRooms = 24;
constexpr float kLeastLitShare = 0.01f;
/// Rooms count as at least so bright, of the brightest: the large ones, and those that are too small to
/// matter.
constexpr float kDimmest = 1e-2f, kDimmestNook = 0.3f;

/// Cluster sizes follow the probings of a room that err most, where a beam ends on large clusters; lights
/// that nobody knew err by about this much of it at worst.
constexpr std::size_t kWorst = kProbings / 4;
constexpr double kOfWorst = 0.65;

/// Makes the lightings and follows their light.
class Prober {
 public:
  Prober(const ProbedScene& scene, const SurveyRows& rows, const ElementRooms& rooms,
         std::vector<std::uint32_t> of_cluster)
      : scene_(scene),
        halves_(rows),
        rows_(mean_rows(rows, scene.senders.weights.size())),
        clusters_(probed_clusters(scene.surfaces)),
        rooms_(probed_rooms(scene.surfaces, rooms, of_cluster)) {
    result_.rooms = std::move(of_cluster);
    result_.senders.assign(scene.senders.weights.size(), ProbingValues{});
    std::vector<float> areas;
    for (const ProbedRoom& room : rooms_) areas.push_back(room.area());
    std::sort(areas.begin(), areas.end(), std::greater<>());
    least_lit_area_ = kLeastLitShare * std::accumulate(areas.begin(), areas.end(), 0.0f);
    if (areas.size() > kLitRooms) least_lit_area_ = std::max(least_lit_area_, areas[kLitRooms]);
  }

  Probing run() {
    light();
    bounce();
    weigh();
    vary();
    result_.nodes = node_means(scene_.senders, result_.senders);
    find_surfaces();
    return std::move(result_);
  }

 private:
  void light();
  void light_room(std::uint32_t room, std::size_t probing);
  glm::vec3 free_place(const ProbedRoom& room, const Choices& choices, Dice& dice, int tries) const;
  void point_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing);
  void spot_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing);
  /// `intensity(direction)`: to a surface.
  template <class Intensity>
  void shine(const ProbedRoom& room, const glm::vec3& position, std::size_t probing, Intensity&& intensity);
  void glowing_patch(const ProbedRoom& room, const Choices& choices, std::size_t probing);
  /// Those of one material, by turns; false when there are none.
  bool emitters_of_room(std::uint32_t room, float strength, std::size_t probing);
  void sky(std::size_t probing);
  float albedo(std::uint32_t material, std::size_t probing) const {
    return kLeastAlbedo + (kMostAlbedo - kLeastAlbedo) * Dice(scene_.seed, 0x616c + material, probing).next();
  }
  void find_surfaces();
  void bounce();
  /// Makes radiosities differ as textures and lights in other places would.
  void vary();
  void weigh();
  static std::vector<ProbingValues> irradiance(const std::vector<FormFactorRow>& rows,
                                               const std::vector<ProbingValues>& senders);
  double cluster_error() const;
  /// Of what two halves of the rays say of a room, the mean square over the probings that err most, weighted,
  /// times its area.
  double worst_square(std::size_t room, const std::vector<ProbingValues>& first,
                      const std::vector<ProbingValues>& second) const;
  /// Root mean square over each room, by area.
  std::vector<ProbingValues> room_means(const std::vector<ProbingValues>& clusters) const;

  const ProbedScene& scene_;
  const SurveyRows& halves_;
  std::vector<FormFactorRow> rows_;
  std::vector<ProbedCluster> clusters_;
  std::vector<ProbedRoom> rooms_;
  float least_lit_area_ = 0.0f;
  std::vector<ProbingValues> emitted_;   ///< per cluster: exitance
  std::vector<ProbingValues> arriving_;  ///< per cluster: direct irradiance
  Probing result_;
};

void Prober::light() {
  emitted_.assign(clusters_.size(), ProbingValues{});
  arriving_.assign(clusters_.size(), ProbingValues{});
  for (std::size_t p = 0; p < kProbings; ++p) {
    if (p % 4 == 0) sky(p);
    for (std::uint32_t room = 0; room < rooms_.size(); ++room) light_room(room, p);
  }
}

void Prober::light_room(std::uint32_t index, std::size_t probing) {
  const ProbedRoom& room = rooms_[index];
  Dice dice(scene_.seed, 0x726f + index, probing);
  const Choices choices(scene_.seed, index, probing);
  const float kind = choices.kind;
  const float strength = 0.2f + 0.8f * dice.next();
  if (room.area() < least_lit_area_) {
    for (const auto c : room.clusters) emitted_[c][probing] = strength * dice.next();
  } else if ((kind < 0.2f && rooms_.size() > 1) ||  // dark, but for what comes from its neighbours
             (by_emitters(probing) && emitters_of_room(index, strength, probing))) {
    return;
  } else if (kind > 0.9f) {
    glowing_patch(room, choices, probing);
  } else if (kind > 0.65f) {
    spot_light(room, choices, dice, probing);
  } else {
    point_light(room, choices, dice, probing);
  }
}

/// Where a lamp may hang: of some places the one that is farthest from all surfaces.
glm::vec3 Prober::free_place(const ProbedRoom& room, const Choices& choices, Dice& dice, int tries) const {
  glm::vec3 best(0.0f);
  float radius = -1.0f;
  for (int attempt = 0; attempt < tries; ++attempt) {
    const SurfacePoint& under = room.choose(attempt == 0 ? choices.place : dice.next());
    const glm::vec3 start = under.position + scene_.geometry.offset * under.normal;
    RayPacket up{};
    up.far.fill(-1.0f);
    up.origin_x[0] = start.x, up.origin_y[0] = start.y, up.origin_z[0] = start.z;
    up.direction_x[0] = under.normal.x, up.direction_y[0] = under.normal.y,
    up.direction_z[0] = under.normal.z;
    const float most = std::sqrt(room.area());
    up.far[0] = most;
    scene_.caster.closest_hits(up);
    const glm::vec3 place = start + std::min(up.far[0], most) * (0.1f + 0.8f * dice.next()) * under.normal;
    const float free = std::min(free_radius(scene_.caster, place), most);
    if (free > radius) best = place, radius = free;
  }
  return best;
}

template <class Intensity>
void Prober::shine(const ProbedRoom& room, const glm::vec3& position, std::size_t probing,
                   Intensity&& intensity) {
  tbb::parallel_for(std::size_t{0}, clusters_.size(), [&](std::size_t c) {
    const SurfacePoint& at = clusters_[c].at;
    const glm::vec3 to = position - at.position;
    const float squared = glm::dot(to, to), cosine = glm::dot(to, at.normal);
    if (cosine <= 0.0f || squared <= 0.0f) return;
    const float distance = std::sqrt(squared), candela = intensity(to / -distance);
    if (candela <= 0.0f) return;
    if (scene_.caster.occluded(at.position + scene_.geometry.offset * at.normal, position)) return;
    arriving_[c][probing] += candela * (cosine / distance) / std::max(squared, kLampStandOff * room.area());
  });
}

void Prober::point_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing) {
  // As much flux as would give the room one lux.
  const float candela = room.area() / float(4.0 * kPi);
  shine(room, free_place(room, choices, dice, kLampTries), probing,
        [candela](const glm::vec3&) { return candela; });
}

/// At any surface of the room.
void Prober::spot_light(const ProbedRoom& room, const Choices& choices, Dice& dice, std::size_t probing) {
  const glm::vec3 position = free_place(room, choices, dice, kSpotTries);
  const glm::vec3 way = room.choose(choices.target).position - position;
  const float angle = kNarrowCone + (kWideCone - kNarrowCone) * dice.next();
  if (glm::length(way) <= 0.0f) return;
  const glm::vec3 axis = glm::normalize(way);
  const float outer = std::cos(angle), inner = std::cos(0.5f * angle);
  const float candela = room.area() / (float(2.0 * kPi) * (1.0f - 0.5f * (inner + outer)));
  shine(room, position, probing, [=](const glm::vec3& direction) {
    const float share = std::clamp((glm::dot(direction, axis) - outer) / (inner - outer), 0.0f, 1.0f);
    return candela * share * share;
  });
}

void Prober::glowing_patch(const ProbedRoom& room, const Choices& choices, std::size_t probing) {
  const SurfacePoint& middle = room.choose(choices.target);
  const float radius = 0.1f * std::sqrt(room.area());
  std::vector<std::uint32_t> patch;
  float area = 0.0f;
  for (const auto c : room.clusters) {
    const SurfacePoint& at = clusters_[c].at;
    if (glm::length(at.position - middle.position) > radius || glm::dot(at.normal, middle.normal) < 0.5f)
      continue;
    patch.push_back(c);
    area += clusters_[c].area;
  }
  for (const auto c : patch) emitted_[c][probing] += room.area() / std::max(area, kLeastPatch * room.area());
}

bool Prober::emitters_of_room(std::uint32_t index, float strength, std::size_t probing) {
  std::map<std::uint32_t, float> areas;  // per material
  for (const Emitter& emitter : scene_.emitters.list) {
    if (result_.rooms[emitter.cluster] == index) areas[emitter.material] += float(emitter.area);
  }
  if (areas.empty()) return false;
  const auto [material, area] = *std::next(areas.begin(), std::ptrdiff_t(probing / 8 % areas.size()));
  for (const Emitter& emitter : scene_.emitters.list) {
    if (result_.rooms[emitter.cluster] == index && emitter.material == material)
      emitted_[emitter.cluster][probing] +=
          strength * rooms_[index].area() / std::max(area, kLeastPatch * rooms_[index].area());
  }
  return true;
}

void Prober::sky(std::size_t probing) {
  Dice dice(scene_.seed, 0x736b, probing);
  const glm::vec3 bright = glm::normalize(glm::vec3(dice.next() - 0.5f, dice.next(), dice.next() - 0.5f));
  for (std::size_t i = 0; i < scene_.senders.sky_cells.size(); ++i) {
    const glm::vec3 direction(sky_cell_direction(scene_.senders.sky_cells[i], scene_.senders.sky_resolution));
    result_.senders[clusters_.size() + i][probing] =
        probing == 0 ? 1.0f : 1.0f + 0.9f * glm::dot(direction, bright);
  }
}

std::vector<ProbingValues> Prober::irradiance(const std::vector<FormFactorRow>& rows,
                                              const std::vector<ProbingValues>& senders) {
  std::vector<ProbingValues> sums(rows.size(), ProbingValues{});
  tbb::parallel_for(std::size_t{0}, rows.size(),
                    [&](std::size_t r) { add_weighted(rows[r].senders, rows[r].values, senders, sums[r]); });
  return sums;
}

void Prober::vary() {
  for (std::size_t p = 0; p < kProbings; ++p) {
    Dice dice(scene_.seed, 0x7761, p);
    const glm::vec3 way =
        glm::normalize(glm::vec3(dice.next() - 0.5f, dice.next() - 0.5f, dice.next() - 0.5f));
    const float phase = dice.next(), across = 1.0f + kShortestWave * float(p) / float(kProbings);
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      const ProbedRoom& room = rooms_[result_.rooms[i]];
      const float at = glm::dot(clusters_[i].at.position, way) * across / std::sqrt(room.area()) + phase;
      const float wave = 4.0f * std::abs(at - std::floor(at) - 0.5f) - 1.0f;
      const float texture = 2.0f * Dice(scene_.seed, 0x7465 + i, p).next() - 1.0f;
      result_.senders[i][p] *= 1.0f + kTexture * texture + kWave * wave;
    }
  }
}

void Prober::bounce() {
  for (int k = 0; k <= kBounces; ++k) {
    const std::vector<ProbingValues> indirect =
        k == 0 ? std::vector<ProbingValues>(rows_.size(), ProbingValues{})
               : irradiance(rows_, result_.senders);
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      for (std::size_t p = 0; p < kProbings; ++p) {
        result_.senders[c][p] =
            emitted_[c][p] + albedo(clusters_[c].material, p) * (arriving_[c][p] + indirect[c][p]);
      }
    }
  }
}

std::vector<ProbingValues> Prober::room_means(const std::vector<ProbingValues>& clusters) const {
  std::vector<ProbingValues> means(rooms_.size(), ProbingValues{});
  for (std::size_t room = 0; room < rooms_.size(); ++room) {
    for (const auto c : rooms_[room].clusters) {
      for (std::size_t p = 0; p < kProbings; ++p)
        means[room][p] += clusters_[c].area / rooms_[room].area() * clusters[c][p] * clusters[c][p];
    }
    for (float& mean : means[room]) mean = std::sqrt(mean);
  }
  return means;
}

void Prober::find_surfaces() {
  const std::vector<TreeNodeRange>& nodes = scene_.senders.tree.nodes;
  result_.surfaces.resize(nodes.size());
  // Children stand after their parents.
  for (std::size_t n = nodes.size(); n-- > 0;) {
    NodeSurface& own = result_.surfaces[n];
    if (nodes[n].first >= clusters_.size()) continue;
    own.room_area = rooms_[result_.rooms[nodes[n].first]].area();
    if (nodes[n].count == 1) {
      const ProbedCluster& cluster = clusters_[nodes[n].first];
      own.area = cluster.area, own.centroid = cluster.at.position, own.normal = cluster.at.normal;
      continue;
    }
    const NodeSurface &left = result_.surfaces[nodes[n].left], &right = result_.surfaces[nodes[n].left + 1];
    own.area = left.area + right.area;
    own.centroid = (left.area * left.centroid + right.area * right.centroid) / own.area;
    own.normal = (left.area * left.normal + right.area * right.normal) / own.area;
  }
}

void Prober::weigh() {
  const std::vector<ProbingValues> means = room_means(irradiance(rows_, result_.senders));
  ProbingValues brightest{};
  for (const ProbingValues& mean : means) {
    for (std::size_t p = 0; p < kProbings; ++p) brightest[p] = std::max(brightest[p], mean[p]);
  }
  result_.weights.assign(rooms_.size(), ProbingValues{});
  for (std::size_t room = 0; room < rooms_.size(); ++room) {
    for (std::size_t p = 0; p < kProbings; ++p) {
      const float least = (rooms_[room].area() < least_lit_area_ ? kDimmestNook : kDimmest) * brightest[p];
      if (least > 0.0f) result_.weights[room][p] = 1.0f / std::max(means[room][p], least);
    }
  }
  result_.cluster_error = cluster_error();
}

double Prober::cluster_error() const {
  // What emits is known by its cluster; only reflected light is smeared.
  std::vector<ProbingValues> reflected(result_.senders.size(), ProbingValues{});
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    for (std::size_t p = 0; p < kProbings; ++p) reflected[c][p] = result_.senders[c][p] - emitted_[c][p];
  }
  std::vector<ProbingValues> change = coarser(scene_.senders, clusters_.size(), reflected);
  for (std::size_t i = 0; i < change.size(); ++i) {
    for (std::size_t p = 0; p < kProbings; ++p) change[i][p] -= reflected[i][p];
  }
  const std::vector<ProbingValues> first = irradiance(halves_.first, change),
                                   second = irradiance(halves_.second, change);
  double sum = 0.0, area = 0.0;
  for (std::size_t room = 0; room < rooms_.size(); ++room) {
    if (rooms_[room].area() < least_lit_area_) continue;
    sum += worst_square(room, first, second);
    area += rooms_[room].area();
  }
  // From twice the size down to this one: of first to second order in the size, half of the change is left.
  return area > 0.0 ? kOfWorst * std::sqrt(std::max(sum, 0.0) / area) / 2.0 : 0.0;
}

double Prober::worst_square(std::size_t room, const std::vector<ProbingValues>& first,
                            const std::vector<ProbingValues>& second) const {
  std::array<double, kProbings> squares{};
  for (const auto c : rooms_[room].clusters) {
    for (std::size_t p = 0; p < kProbings; ++p) {
      const double weight = double(result_.weights[room][p]);
      const double square = weight * weight * double(first[c][p]) * double(second[c][p]);
      squares[p] += double(clusters_[c].area) * std::min(square, kWhollyWrong);
    }
  }
  std::sort(squares.begin(), squares.end(), std::greater<>());
  return std::accumulate(squares.begin(), squares.begin() + kWorst, 0.0) / kWorst;
}

}  // namespace

Probing probe(const ProbedScene& scene, const SurveyRows& rows, const ElementRooms& rooms,
              std::vector<std::uint32_t> of_cluster) {
  return Prober(scene, rows, rooms, std::move(of_cluster)).run();
}

}  // namespace relume
