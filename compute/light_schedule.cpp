// SPDX-License-Identifier: MIT
#include "compute/light_schedule.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <string>

#include "core/light_patches.h"

namespace relume {
namespace {

constexpr std::size_t kGroupBlocks = 32;
/// Beyond what single precision on the device can differ by.
constexpr double kSlack = 1e-5;

/// Range and cone of a point or spot light against a ball.
bool reaches_ball(const Light& light, const glm::dvec3& centre, double radius) {
  const glm::dvec3 way = centre - light.position;
  const double distance = glm::length(way);
  const double reach = radius + kSlack * (radius + distance);
  if (light.range > 0.0 && distance - reach >= light.range) return false;
  if (light.type == LightType::point) return true;
  const double along = glm::dot(way, light.direction);
  const double across = std::sqrt(std::max(0.0, distance * distance - along * along));
  return across * std::cos(light.outer_cone_angle) - along * std::sin(light.outer_cone_angle) <= reach;
}

bool faces(const Light& light, const LightBlock& block) {
  if (light.type == LightType::directional)
    return -glm::dot(light.direction, block.axis) + block.spread + kSlack > 0.0;
  const double distance = glm::length(light.position - block.centre) + block.radius;
  return glm::dot(block.axis, light.position) - block.lowest + (block.spread + kSlack) * distance > 0.0;
}

bool same_place(const Light& a, const Light& b) {
  return a.type == b.type && a.position == b.position && a.direction == b.direction && a.range == b.range &&
         a.inner_cone_angle == b.inner_cone_angle && a.outer_cone_angle == b.outer_cone_angle;
}

/// No point of the block gets more, lm/m2 of the worst channel.
double most_irradiance(const Light& light, const LightBlock& block) {
  const double intensity = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
  if (light.type == LightType::directional) return intensity;
  const double height = glm::dot(block.axis, light.position) - block.highest;
  const double away = glm::length(light.position - block.centre) - block.radius;
  const double distance = std::max({0.0, height, away}) * (1.0 - kSlack);
  return intensity / (distance * distance);
}

/// About how many rays a pair takes.
std::uint64_t rays_of(const Light& light, const LightBlock& block) {
  if (light.type == LightType::directional) return block.patch_count;
  // Patches that look large are cut: about two for each largest solid angle that they cover, were the block a
  // disc.
  const double height = std::max(0.0, glm::dot(block.axis, light.position) - block.highest);
  const double solid_angle = max_patch_solid_angle(light), squared = block.radius * block.radius;
  const bool cut = kPi * squared / std::max(1u, block.patch_count) > solid_angle * height * height;
  const double away = std::max(height, glm::length(light.position - block.centre) - block.radius);
  if (!cut || squared == 0.0) return block.patch_count;
  const double covered = 2.0 * kPi * (1.0 - away / std::sqrt(away * away + squared));
  return block.patch_count + static_cast<std::uint64_t>(2.0 * covered / solid_angle);
}

/// Balls around runs of blocks.
std::vector<LightBlock> group(const std::vector<LightBlock>& blocks) {
  std::vector<LightBlock> groups;
  for (std::size_t first = 0; first < blocks.size(); first += kGroupBlocks) {
    const std::span<const LightBlock> run(&blocks[first], std::min(kGroupBlocks, blocks.size() - first));
    LightBlock whole;
    for (const LightBlock& block : run) whole.centre += block.centre / double(run.size());
    for (const LightBlock& block : run)
      whole.radius = std::max(whole.radius, glm::length(block.centre - whole.centre) + block.radius);
    groups.push_back(whole);
  }
  return groups;
}

}  // namespace

bool may_reach(const Light& light, const LightBlock& block) {
  if (!faces(light, block)) return false;
  if (light.type == LightType::directional) return true;
  const double height = glm::dot(block.axis, light.position) - block.highest;
  const bool above = light.range > 0.0 && height * (1.0 - kSlack) >= light.range;
  return !above && reaches_ball(light, block.centre, block.radius);
}

LightSchedule::LightSchedule(std::shared_ptr<const std::vector<LightBlock>> blocks, const glm::dvec3& origin,
                             std::uint32_t max_lights, std::uint32_t max_pairs)
    : blocks_(std::move(blocks)),
      groups_(group(*blocks_)),
      origin_(origin),
      max_lights_(max_lights),
      max_pairs_(max_pairs),
      pairs_(blocks_->size()),
      free_slots_(max_pairs),
      dirty_(blocks_->size(), true),
      change_(blocks_->size(), std::numeric_limits<double>::infinity()) {
  std::iota(free_slots_.rbegin(), free_slots_.rend(), 0u);
}

std::vector<std::uint32_t> LightSchedule::reached_blocks(const Light& light) const {
  std::vector<std::uint32_t> reached;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (light.type != LightType::directional && !reaches_ball(light, groups_[g].centre, groups_[g].radius))
      continue;
    const std::size_t end = std::min(blocks_->size(), (g + 1) * kGroupBlocks);
    for (std::size_t block = g * kGroupBlocks; block < end; ++block) {
      if (may_reach(light, (*blocks_)[block])) reached.push_back(static_cast<std::uint32_t>(block));
    }
  }
  return reached;
}

std::size_t LightSchedule::pairs_of(const Light& light) const {
  Light local = light;
  local.position -= origin_;
  return reached_blocks(local).size();
}

Result<void> LightSchedule::set_lights(std::span<const Light> lights) {
  if (lights.size() > max_lights_) {
    return fail(ErrorCode::usage, "direct light: expected at most " + std::to_string(max_lights_) +
                                      " lights, found " + std::to_string(lights.size()));
  }
  std::vector<Light> wanted(lights.begin(), lights.end());
  for (Light& light : wanted) light.position -= origin_;
  std::vector<std::pair<std::uint32_t, std::vector<std::uint32_t>>> moved;
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < wanted.size(); ++i) {
    if (i < lights_.size() && same_place(wanted[i], lights_[i])) {
      count += reach_[i].size();
      continue;
    }
    moved.emplace_back(i, reached_blocks(wanted[i]));
    count += moved.back().second.size();
  }
  if (count > max_pairs_) {
    return fail(ErrorCode::usage, "direct light: expected at most " + std::to_string(max_pairs_) +
                                      " pairs of a light and a block that it reaches, found " +
                                      std::to_string(count) + ": raise max_pairs, or give lights a range");
  }
  for (std::size_t i = wanted.size(); i < lights_.size(); ++i) {
    add_change(lights_[i], reach_[i]);
    replace_pairs(static_cast<std::uint32_t>(i), {});
  }
  reach_.resize(wanted.size());
  for (std::size_t i = 0; i < std::min(wanted.size(), lights_.size()); ++i) {
    if (wanted[i].intensity == lights_[i].intensity) continue;
    for (const std::uint32_t block : reach_[i]) mark_dirty(block);
    if (!same_place(wanted[i], lights_[i])) continue;
    Light difference = wanted[i];
    difference.intensity = glm::abs(wanted[i].intensity - lights_[i].intensity);
    add_change(difference, reach_[i]);
  }
  for (const auto& [light, blocks] : moved) {
    if (light < lights_.size()) add_change(lights_[light], reach_[light]);
    add_change(wanted[light], blocks);
  }
  // What is freed first can be used by others.
  for (const auto& [light, blocks] : moved) replace_pairs(light, {});
  for (auto& [light, blocks] : moved) replace_pairs(light, std::move(blocks));
  lights_ = std::move(wanted);
  lights_changed = true;
  return {};
}

void LightSchedule::replace_pairs(std::uint32_t light, std::vector<std::uint32_t> blocks) {
  const auto place = [this, light](std::uint32_t block) {
    return std::lower_bound(pairs_[block].begin(), pairs_[block].end(), light,
                            [](const LightPair& pair, std::uint32_t l) { return pair.light < l; });
  };
  for (const std::uint32_t block : reach_[light]) {
    const auto old = place(block);
    free_slots_.push_back(old->slot);
    pairs_[block].erase(old);
    mark_dirty(block);
  }
  pair_count_ -= reach_[light].size();
  for (const std::uint32_t block : blocks) {
    pairs_[block].insert(place(block), {light, free_slots_.back(), true});
    free_slots_.pop_back();
    mark_dirty(block);
  }
  pair_count_ += blocks.size();
  reach_[light] = std::move(blocks);
}

void LightSchedule::mark_dirty(std::uint32_t block) {
  dirty_[block] = true;
  next_dirty_ = std::min<std::size_t>(next_dirty_, block);
}

void LightSchedule::add_change(const Light& light, std::span<const std::uint32_t> blocks) {
  // 0 over 0 is a light without intensity.
  if (light.intensity == Rgb(0.0)) return;
  for (const std::uint32_t block : blocks) change_[block] += most_irradiance(light, (*blocks_)[block]);
}

double LightSchedule::pending_change(double largest) const {
  double change = 0.0;
  for (std::size_t block = next_dirty_; block < dirty_.size(); ++block) {
    if (dirty_[block]) change = std::max(change, change_[block]);
  }
  return std::min(change, largest);
}

void LightSchedule::retrace() {
  for (std::vector<LightPair>& pairs : pairs_) {
    for (LightPair& pair : pairs) pair.pending = true;
  }
  dirty_.assign(dirty_.size(), true);
  change_.assign(change_.size(), std::numeric_limits<double>::infinity());
  next_dirty_ = 0;
  lights_changed = true;
}

LightWork LightSchedule::take(const LightWorkLimits& limits) {
  LightWork work;
  std::uint64_t words = 0;
  const auto find_next = [this] {
    while (next_dirty_ < dirty_.size() && !dirty_[next_dirty_]) ++next_dirty_;
  };
  for (find_next(); next_dirty_ < dirty_.size(); find_next()) {
    const auto block = static_cast<std::uint32_t>(next_dirty_);
    const LightBlock& facts = (*blocks_)[block];
    std::vector<LightPair>& pairs = pairs_[block];
    std::uint64_t rays = 0, more_words = 4 + 2 * pairs.size();
    for (const LightPair& pair : pairs) {
      if (!pair.pending) continue;
      rays += rays_of(lights_[pair.light], facts);
      more_words += 4;
    }
    const bool fits = work.rays + rays <= limits.rays && words + more_words <= limits.words;
    if (!work.sums.empty() && !fits) break;
    work.sums.push_back(
        {block, static_cast<std::uint32_t>(work.pairs.size()), static_cast<std::uint32_t>(pairs.size())});
    for (LightPair& pair : pairs) {
      work.pairs.emplace_back(pair.slot, pair.light);
      if (pair.pending)
        work.traces.push_back({block, pair.light, pair.slot, rays_of(lights_[pair.light], facts)});
      pair.pending = false;
    }
    work.rays += rays;
    words += more_words;
    if (facts.end_cluster > facts.first_cluster) {
      const bool first = work.end_cluster == 0;
      work.first_cluster = first ? facts.first_cluster : std::min(work.first_cluster, facts.first_cluster);
      work.end_cluster = std::max(work.end_cluster, facts.end_cluster);
    }
    dirty_[block] = false;
    change_[block] = 0.0;
  }
  return work;
}

}  // namespace relume
