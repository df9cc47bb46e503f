// SPDX-License-Identifier: MIT
#include "precompute/probing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>

#include "precompute/probed_rooms.h"
#include "precompute/probing_dice.h"
#include "precompute/probing_lights.h"
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
/// Less than this of the brightest: lit by others alone.
constexpr float kDim = 0.1f;

/// No room counts as getting less than this of the light of another: these would take the most form factors
/// and matter least.
constexpr float kLeastShare = 0.1f;

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
    find_lit_rooms();
  }

  Probing run() {
    find_shares();
    ProbingLights lights = probing_lights({scene_, clusters_, rooms_, result_.rooms, result_.lit});
    std::copy(lights.sky.begin(), lights.sky.end(),
              result_.senders.begin() + std::ptrdiff_t(clusters_.size()));
    emitted_ = std::move(lights.emitted), arriving_ = std::move(lights.arriving);
    bounce();
    weigh();
    vary();
    result_.nodes = node_means(scene_.senders, result_.senders);
    find_surfaces();
    return std::move(result_);
  }

 private:
  float albedo(std::uint32_t material, std::size_t probing) const {
    return kLeastAlbedo + (kMostAlbedo - kLeastAlbedo) * Dice(scene_.seed, 0x616c + material, probing).next();
  }
  void find_surfaces();
  void bounce();
  /// Makes radiosities differ as textures and lights in other places would.
  void vary();
  void weigh();
  void find_lit_rooms();
  /// What lit rooms get of the light of others.
  void find_shares();
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
  std::vector<std::uint32_t> lit_rooms_;
  std::vector<ProbingValues> emitted_;   ///< per cluster: exitance
  std::vector<ProbingValues> arriving_;  ///< per cluster: direct irradiance
  Probing result_;
};

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

void Prober::find_lit_rooms() {
  std::vector<float> areas;
  for (const ProbedRoom& room : rooms_) areas.push_back(room.area());
  std::sort(areas.begin(), areas.end(), std::greater<>());
  float least = kLeastLitShare * std::accumulate(areas.begin(), areas.end(), 0.0f);
  if (areas.size() > kLitRooms) least = std::max(least, areas[kLitRooms]);
  result_.lit.number.assign(rooms_.size(), kNone);
  for (std::uint32_t room = 0; room < rooms_.size(); ++room) {
    if (rooms_[room].area() < least) continue;
    result_.lit.number[room] = std::uint32_t(lit_rooms_.size());
    lit_rooms_.push_back(room);
  }
}

void Prober::find_shares() {
  result_.lit.weights.assign(lit_rooms_.size(), ProbingValues{});
  result_.lit.shares.assign(lit_rooms_.size() * lit_rooms_.size(), 0.0f);
  for (std::size_t first = 0; first < lit_rooms_.size(); first += kProbings) {
    const auto glowing = std::span(lit_rooms_).subspan(first, std::min(lit_rooms_.size() - first, kProbings));
    emitted_.assign(clusters_.size(), ProbingValues{});
    arriving_.assign(clusters_.size(), ProbingValues{});
    for (std::size_t p = 0; p < glowing.size(); ++p) {
      for (const auto c : rooms_[glowing[p]].clusters) emitted_[c][p] = 1.0f;
    }
    bounce();
    const std::vector<ProbingValues> means = room_means(irradiance(rows_, result_.senders));
    for (std::size_t i = 0; i < lit_rooms_.size(); ++i) {
      for (std::size_t p = 0; p < glowing.size(); ++p) {
        const float there = means[glowing[p]][p];
        result_.lit.shares[i * lit_rooms_.size() + first + p] =
            there > 0.0f ? means[lit_rooms_[i]][p] / there : 0.0f;
      }
    }
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
      const float least = (result_.lit.number[room] == kNone ? kDimmestNook : kDimmest) * brightest[p];
      if (least > 0.0f) result_.weights[room][p] = 1.0f / std::max(means[room][p], least);
      if (result_.lit.number[room] != kNone && means[room][p] > kDim * brightest[p])
        result_.lit.weights[result_.lit.number[room]][p] = result_.weights[room][p];
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
    if (result_.lit.number[room] == kNone) continue;
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

const ProbingValues& weights_of_room(const Probing& probing, std::uint32_t room) {
  static constexpr ProbingValues kNothing{};
  return room == kNoRoom ? kNothing : probing.weights[room];
}

std::uint32_t lit_room(const Probing& probing, std::uint32_t sender) {
  return sender < probing.rooms.size() ? probing.lit.number_of(probing.rooms[sender]) : kNone;
}

float lit_share(const Probing& probing, std::uint32_t room, std::uint32_t lit) {
  const std::uint32_t own = room == kNoRoom ? kNone : probing.lit.number_of(room);
  if (own == kNone || lit == kNone || own == lit) return 1.0f;
  return std::clamp(probing.lit.share(own, lit), kLeastShare, 1.0f);
}

ProbingValues weights_of_light(const Probing& probing, std::uint32_t room, std::uint32_t lit) {
  ProbingValues weights = weights_of_room(probing, room);
  if (const float share = lit_share(probing, room, lit); share < 1.0f) {
    for (std::size_t p = 0; p < kProbings; ++p)
      weights[p] = std::max(weights[p], probing.lit.weights[lit][p] / share);
  }
  return weights;
}

Probing probe(const ProbedScene& scene, const SurveyRows& rows, const ElementRooms& rooms,
              std::vector<std::uint32_t> of_cluster) {
  return Prober(scene, rows, rooms, std::move(of_cluster)).run();
}

}  // namespace relume
