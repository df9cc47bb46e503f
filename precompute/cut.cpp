// SPDX-License-Identifier: MIT
#include "precompute/cut.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <queue>

namespace relume {
namespace {

/// Of the noise of independent rays; those of a sequence that fills the hemisphere evenly have less.
constexpr float kNoiseShare = 0.5f;
/// Of what a node seems to hide, counts at least: where rays are few, noise hides what finer nodes would
/// show.
constexpr float kAtLeast = 0.1f;
/// What a light in an unknown place counts for: square of the share of a room's indirect light that comes
/// from its spot at first hand. Spots are no smaller than this share of the room's surface.
constexpr float kSpots = 0.02f, kLeastSpot = 0.003f;
/// What halves of a node differ in for a row counts where it is more than this much of what noise makes of
/// it.
constexpr float kNoiseOfHalves = 2.0f;

/// Of one leaf after the other: adds what rows receive from it to the sums before it.
struct LeafSums {
  std::span<const float> factors;  ///< [row]
  const ProbingValues& radiosity;
  std::span<const ProbingValues> weights;  ///< [row]
  std::span<const CutRow> rows;
};

/// `light` holds the sums before a leaf [row], and has room for those after it behind them. The same numbers
/// from either version, for neither contracts nor reorders.
[[gnu::target_clones("avx2", "default")]] void add_leaf(const LeafSums& leaf, ProbingValues* light,
                                                        ProbingValues& noise_sum) {
  const ProbingValues radiosity = leaf.radiosity;
  ProbingValues noise = noise_sum;
  const std::size_t rows = leaf.rows.size();
  for (std::size_t r = 0; r < rows; ++r) {
    const float factor = leaf.factors[r], share = factor / leaf.rows[r].rays;
    ProbingValues sum = light[r];
    for (std::size_t p = 0; p < kProbings; ++p) sum[p] += factor * radiosity[p];
    light[rows + r] = sum;
    const ProbingValues weights = leaf.weights[r];
    for (std::size_t p = 0; p < kProbings; ++p) {
      const float weighted = weights[p] * radiosity[p];
      noise[p] += share * weighted * weighted;
    }
  }
  noise_sum = noise;
}

/// Form factor over area, but for what stands between. A place without a normal, a light probe, is a plane
/// that half faces the other.
float density(const SurfacePoint& from, const NodeSurface& to) {
  const glm::vec3 way = to.centroid - from.position;
  const float squared = std::max(glm::dot(way, way), 0.25f * to.area);
  const bool all_sides = from.normal == glm::vec3(0.0f);
  const float here = all_sides ? 0.5f * glm::length(way) : glm::dot(way, from.normal);
  const float there = -glm::dot(way, to.normal);
  return here <= 0.0f || there <= 0.0f ? 0.0f : here * there / (squared * squared);
}

}  // namespace

/// A node that may be refined, or a leaf.
struct TileCutter::Candidate {
  float squared_error = 0.0f;  ///< mean over rows and probes
  std::uint32_t node = 0;
  std::size_t first = 0, last = 0;  ///< its leaves among those of the tile
  float spot_error = 0.0f;          ///< squared, part of squared_error
  friend bool operator<(const Candidate& a, const Candidate& b) {
    return a.squared_error != b.squared_error ? a.squared_error < b.squared_error : a.node > b.node;
  }
};

std::uint32_t room_of(const Probing& probing, const FormFactorRow& row) {
  std::map<std::uint32_t, float> sums;
  auto last = sums.end();  // neighbours mostly lie in one room
  for (std::size_t i = 0; i < row.senders.size() && row.senders[i] < probing.rooms.size(); ++i) {
    const std::uint32_t room = probing.rooms[row.senders[i]];
    if (last == sums.end() || last->first != room) last = sums.try_emplace(room, 0.0f).first;
    last->second += row.values[i];
  }
  const auto most = std::max_element(sums.begin(), sums.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == sums.end() ? kNoRoom : most->first;
}

TileCutter::TileCutter(const CutSenders& senders)
    : tree_(senders.tree),
      probing_(senders.probing),
      flux_(senders.flux),
      places_(senders.places),
      each_room_alone_(senders.each_room_alone),
      seen_(senders.probing.senders.size()),
      place_(senders.probing.senders.size()) {}

std::uint32_t TileCutter::lit_room_of(std::uint32_t sender) const {
  return each_room_alone_ ? lit_room(probing_, sender) : kNone;
}

const std::vector<ProbingValues>& TileCutter::weights_of(std::uint32_t lit) {
  if (lit == kNone) return weights_;
  std::vector<ProbingValues>& weights = lit_weights_[lit];
  if (weights.empty()) {
    for (const std::uint32_t room : row_rooms_) weights.push_back(weights_of_light(probing_, room, lit));
  }
  return weights;
}

void TileCutter::unite(std::span<const CutRow> tile) {
  tile_.assign(tile.begin(), tile.end());
  for (const CutRow& row : tile_) {
    for (const auto sender : row.row->senders) seen_.insert(sender);
  }
  leaves_.clear();
  seen_.drain([&](std::uint32_t sender) {
    place_[sender] = std::uint32_t(leaves_.size());
    leaves_.push_back(sender);
  });
  factors_.assign(leaves_.size() * tile_.size(), 0.0f);
  const bool directional =
      std::any_of(tile_.begin(), tile_.end(), [](const CutRow& row) { return !row.row->moments.empty(); });
  moments_.assign(directional ? factors_.size() : 0, glm::vec3(0.0f));
  for (std::size_t r = 0; r < tile_.size(); ++r) {
    const FormFactorRow& row = *tile_[r].row;
    for (std::size_t i = 0; i < row.senders.size(); ++i)
      factors_[place_[row.senders[i]] * tile_.size() + r] = row.values[i];
    for (std::size_t i = 0; i < row.moments.size(); ++i)
      moments_[place_[row.senders[i]] * tile_.size() + r] = row.moments[i];
  }
}

void TileCutter::sum_up() {
  weights_.clear();
  row_rooms_.clear();
  for (const CutRow& row : tile_) {
    row_rooms_.push_back(room_of(probing_, *row.row));
    weights_.push_back(weights_of_room(probing_, row_rooms_.back()));
  }
  lit_weights_.assign(probing_.lit.weights.size(), {});
  factor_sums_.assign(tile_.size(), 0.0f);
  factor_sums_.resize((leaves_.size() + 1) * tile_.size());
  light_sums_.assign(tile_.size(), ProbingValues{});
  light_sums_.resize((leaves_.size() + 1) * tile_.size());
  noise_sums_.assign(1, ProbingValues{});
  for (std::size_t i = 0; i < leaves_.size(); ++i) {
    const std::size_t at = i * tile_.size();
    const std::span factors = std::span<const float>(factors_).subspan(at, tile_.size());
    for (std::size_t r = 0; r < factors.size(); ++r)
      factor_sums_[at + tile_.size() + r] = factor_sums_[at + r] + factors[r];
    noise_sums_.push_back(noise_sums_.back());
    add_leaf({factors, probing_.senders[leaves_[i]], weights_of(lit_room_of(leaves_[i])), tile_},
             &light_sums_[at], noise_sums_.back());
  }
  added_errors_.assign(tile_.size(), ProbingValues{});
  squared_errors_ = spot_errors_ = 0.0;
}

std::size_t TileCutter::leaves_before(std::uint32_t sender, std::size_t first, std::size_t last) const {
  const auto begin = leaves_.begin() + std::ptrdiff_t(first), end = leaves_.begin() + std::ptrdiff_t(last);
  return std::size_t(std::lower_bound(begin, end, sender) - leaves_.begin());
}

float TileCutter::factor_sum(std::size_t first, std::size_t last, std::size_t row) const {
  return factor_sums_[last * tile_.size() + row] - factor_sums_[first * tile_.size() + row];
}

TileCutter::Candidate TileCutter::candidate(std::uint32_t node, std::size_t first, std::size_t last) {
  const TreeNodeRange& range = tree_.nodes[node];
  Candidate result{0.0f, node, leaves_before(range.first, first, last),
                   leaves_before(range.first + range.count, first, last)};
  if (range.count == 1 || result.first == result.last) return result;
  const ProbingValues& mean = probing_.nodes[node];
  const std::vector<ProbingValues>& weights = weights_of(lit_room_of(range.first));
  float squared = 0.0f, noise = 0.0f;
  for (std::size_t p = 0; p < kProbings; ++p)
    noise += noise_sums_[result.last][p] - noise_sums_[result.first][p];
  for (std::size_t r = 0; r < tile_.size(); ++r) {
    const std::size_t before = result.first * tile_.size() + r, after = result.last * tile_.size() + r;
    const float factor = factor_sum(result.first, result.last, r);
    for (std::size_t p = 0; p < kProbings; ++p) {
      const float light = light_sums_[after][p] - light_sums_[before][p];
      const float error = (light - factor * mean[p]) * weights[r][p];
      squared += error * error;
      noise += mean[p] * (factor * mean[p] - 2.0f * light) * weights[r][p] * weights[r][p] / tile_[r].rays;
    }
  }
  noise = std::clamp(noise, 0.0f, squared);
  result.squared_error =
      std::max(squared - kNoiseShare * noise, kAtLeast * squared) / float(tile_.size() * kProbings);
  result.spot_error = spot_error(result);
  result.squared_error += result.spot_error;
  return result;
}

float TileCutter::spot_error(const Candidate& c) const {
  const TreeNodeRange& range = tree_.nodes[c.node];
  const NodeSurface& own = probing_.surfaces[c.node];
  if (own.area <= 0.0f) return 0.0f;
  const NodeSurface &left = probing_.surfaces[range.left], &right = probing_.surfaces[range.left + 1];
  const std::uint32_t lit = lit_room_of(range.first);
  const std::size_t middle = leaves_before(tree_.nodes[range.left + 1].first, c.first, c.last);
  float expected = 0.0f, seen = 0.0f;
  for (std::size_t r = 0; r < tile_.size(); ++r) {
    if (row_rooms_[r] == kNoRoom || (lit == kNone && row_rooms_[r] != probing_.rooms[range.first])) continue;
    const float here = density(tile_[r].place, left), there = density(tile_[r].place, right);
    const float mean = (left.area * here + right.area * there) / own.area;
    const float first = factor_sum(c.first, middle, r) / left.area,
                second = factor_sum(middle, c.last, r) / right.area,
                both = factor_sum(c.first, c.last, r) / own.area;
    const float difference = mean > 0.0f ? both * (here - there) / mean : both;
    const float noise = (first / left.area + second / right.area) / tile_[r].rays;
    const float part = lit_share(probing_, row_rooms_[r], lit), weight = 1.0f / (part * part);
    expected += weight * difference * difference;
    seen += weight * ((first - second) * (first - second) - kNoiseOfHalves * noise);
  }
  const float spots = own.room_area / std::max(own.area, kLeastSpot * own.room_area);
  return kSpots * spots * left.area * right.area * std::max(expected, seen) / float(tile_.size());
}

void TileCutter::book(const Candidate& c, float sign) {
  squared_errors_ += double(sign * c.squared_error);
  spot_errors_ += double(sign * c.spot_error);
  if (tree_.nodes[c.node].count == 1) return;
  const ProbingValues& mean = probing_.nodes[c.node];
  const std::vector<ProbingValues>& weights = weights_of(lit_room_of(tree_.nodes[c.node].first));
  for (std::size_t r = 0; r < tile_.size(); ++r) {
    const std::size_t before = c.first * tile_.size() + r, after = c.last * tile_.size() + r;
    const float factor = factor_sum(c.first, c.last, r);
    for (std::size_t p = 0; p < kProbings; ++p) {
      added_errors_[r][p] +=
          sign * (light_sums_[after][p] - light_sums_[before][p] - factor * mean[p]) * weights[r][p];
    }
  }
}

float TileCutter::tile_error() const {
  float added = 0.0f;
  for (const ProbingValues& row : added_errors_) {
    for (const float error : row) added += error * error;
  }
  return std::max(float(squared_errors_), added / float(tile_.size() * kProbings) + float(spot_errors_));
}

template <class Stop>
std::vector<TileCutter::Candidate> TileCutter::refine(Stop&& stop) {
  std::priority_queue<Candidate> open;
  std::vector<Candidate> kept;
  const auto push = [&](std::uint32_t node, std::size_t first, std::size_t last) {
    const Candidate c = candidate(node, first, last);
    if (c.first == c.last) return;
    book(c, 1.0f);
    if (tree_.nodes[node].count == 1) kept.push_back(c);
    if (tree_.nodes[node].count > 1) open.push(c);
  };
  for (const auto root : tree_.roots) push(root, 0, leaves_.size());
  while (!open.empty() && open.top().squared_error > 0.0f) {
    const Candidate worst = open.top();
    if (stop(worst.squared_error, open.size() + kept.size())) break;
    open.pop();
    book(worst, -1.0f);
    const std::uint32_t left = tree_.nodes[worst.node].left;
    push(left, worst.first, worst.last);
    push(left + 1, worst.first, worst.last);
  }
  for (; !open.empty(); open.pop()) kept.push_back(open.top());
  return kept;
}

CutTile TileCutter::cut(std::span<const CutRow> tile, const CutLimits& limits) {
  unite(tile);
  sum_up();
  const auto enough = float(limits.node_error * limits.node_error);
  return finish(refine([&](float worst, std::size_t nodes) {
    return limits.budget > 0 ? nodes >= limits.budget : worst <= enough;
  }));
}

std::vector<CutStep> TileCutter::steps(std::span<const CutRow> tile) {
  unite(tile);
  sum_up();
  std::vector<CutStep> steps;
  refine([&](float worst, std::size_t) {
    steps.push_back({worst, tile_error()});
    return false;
  });
  return steps;
}

void TileCutter::add_flux(const Candidate& kept) const {
  if (tree_.nodes[kept.node].count == 1) return;
  for (std::size_t i = kept.first; i < kept.last; ++i) {
    double flux = 0.0;
    for (std::size_t r = 0; r < tile_.size(); ++r)
      flux += double(tile_[r].area) * double(factors_[i * tile_.size() + r]);
    if (flux > 0.0) flux_->add(kept.node, leaves_[i], flux);
  }
}

void TileCutter::append_halvings_of(const Candidate& c, std::size_t row, HalvingList& list) const {
  const TreeNodeRange& range = tree_.nodes[c.node];
  if ((*places_)[range.first].system != (*places_)[range.first + range.count - 1].system) return;
  const auto begin = leaves_.begin() + std::ptrdiff_t(c.first),
             end = leaves_.begin() + std::ptrdiff_t(c.last);
  append_halvings(
      range.count,
      [&](std::uint32_t first, std::uint32_t last) {
        double sum = 0.0;
        for (auto leaf = std::lower_bound(begin, end, range.first + first);
             leaf != end && *leaf < range.first + last; ++leaf)
          sum += double(factors_[std::size_t(leaf - leaves_.begin()) * tile_.size() + row]);
        return sum;
      },
      list);
}

std::vector<glm::vec3> TileCutter::moments_of(const std::vector<Candidate>& kept, std::size_t row) const {
  std::vector<glm::vec3> moments;
  for (const Candidate& c : kept) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = c.first; i < c.last; ++i) sum += glm::dvec3(moments_[i * tile_.size() + row]);
    moments.emplace_back(sum);
  }
  return moments;
}

CutTile TileCutter::finish(std::vector<Candidate> kept) const {
  std::sort(kept.begin(), kept.end(),
            [](const Candidate& a, const Candidate& b) { return a.first < b.first; });
  CutTile tile;
  for (const Candidate& c : kept) {
    tile.nodes.push_back(c.node);
    if (flux_ != nullptr) add_flux(c);
  }
  tile.values.resize(tile_.size());
  for (std::size_t r = 0; r < tile_.size(); ++r) {
    for (const Candidate& c : kept) {
      double sum = 0.0;
      for (std::size_t i = c.first; i < c.last; ++i) sum += double(factors_[i * tile_.size() + r]);
      const bool counts = sum >= double(std::numeric_limits<float>::min());  // what codes keep
      tile.values[r].push_back(counts ? float(sum) : 0.0f);
      if (places_ != nullptr && counts) append_halvings_of(c, r, tile.halvings);
    }
    if (!moments_.empty()) tile.moments.push_back(moments_of(kept, r));
    float squares = 0.0f;
    for (const float error : added_errors_[r]) squares += error * error;
    tile.error.push_back(std::sqrt(squares / float(kProbings) + float(std::max(spot_errors_, 0.0))));
  }
  return tile;
}

}  // namespace relume
