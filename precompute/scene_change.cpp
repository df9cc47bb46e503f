// SPDX-License-Identifier: MIT
#include "precompute/scene_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/ray_offset.h"

namespace relume {
namespace {

/// Rounding of hits, and the slack with which ties are settled (ray_caster.cpp), are far below this share of
/// the largest coordinate.
constexpr float kMargin = 0x1p-15f;

/// More boxes are joined to one.
constexpr std::size_t kMostBoxes = 8;

/// Of `old_of`, the longest part that ascends (M. Fredman, On Computing the Length of Longest Increasing
/// Subsequences, 1975): true where an entry belongs to it. kNone never does.
std::vector<bool> ascending(const std::vector<std::uint32_t>& old_of) {
  std::vector<std::uint32_t> ends, before(old_of.size(), kNone);  // indices into old_of
  for (std::uint32_t i = 0; i < old_of.size(); ++i) {
    if (old_of[i] == kNone) continue;
    const auto at =
        std::lower_bound(ends.begin(), ends.end(), old_of[i],
                         [&](std::uint32_t end, std::uint32_t value) { return old_of[end] < value; });
    if (at != ends.begin()) before[i] = *(at - 1);
    if (at == ends.end()) {
      ends.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<bool> chosen(old_of.size(), false);
  for (std::uint32_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i]) chosen[i] = true;
  return chosen;
}

template <class Positions, class Triangles>
Box box_of(const Positions& positions, const Triangles& triangle) {
  Box box{positions[triangle[0]], positions[triangle[0]]};
  for (const auto corner : triangle) box = join(box, {positions[corner], positions[corner]});
  return box;
}

Result<std::optional<RayCaster>> caster_of(std::span<const glm::vec3> positions,
                                           std::span<const std::array<std::uint32_t, 3>> triangles,
                                           const std::vector<std::uint32_t>& some) {
  if (some.empty()) return std::optional<RayCaster>();
  std::vector<std::array<std::uint32_t, 3>> own;
  for (const auto t : some) own.push_back(triangles[t]);
  // It is asked whether rays meet anything, not which triangle: ties need not be settled.
  const std::vector<std::uint8_t> no_ties(own.size(), 0);
  auto caster = RayCaster::create(positions, own, {}, no_ties);
  if (!caster) return tl::unexpected(caster.error());
  return std::optional<RayCaster>(std::move(*caster));
}

}  // namespace

Result<SceneChange> SceneChange::find(const RowsFile& old, const std::string& name, const Scene& scene,
                                      const Geometry& geometry, std::uint64_t seed,
                                      std::span<const std::uint64_t> keys) {
  if (old.settings.seed != seed) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected rows of --seed {}, found those of {}; precompute without --update",
                            name, seed, old.settings.seed));
  }
  SceneChange change(old);
  change.margin_ = kMargin * largest_coordinate(geometry.positions);
  change.match(geometry, scene, keys);
  if (change.removed_triangles_.size() == old.triangles.size()) {
    return fail(
        ErrorCode::bad_input,
        fmt::format("{}: expected rows of an earlier {}, found those of {}, which has no triangle in common "
                    "with it; precompute without --update",
                    name, scene.file_name, old.scene_file));
  }
  change.comparable_ = old.settings.origin == geometry.origin && old.settings.offset == geometry.offset;
  if (!change.comparable_) return change;
  change.old_elements_ = KeyIndex(old.element_keys);
  if (auto cast = change.cast(geometry); !cast) return tl::unexpected(cast.error());
  return change;
}

void SceneChange::match(const Geometry& geometry, const Scene& scene, std::span<const std::uint64_t> keys) {
  const KeyIndex old_keys(old_.triangle_keys);
  std::vector<std::uint32_t> old_of(keys.size());
  std::transform(keys.begin(), keys.end(), old_of.begin(),
                 [&](std::uint64_t key) { return old_keys.find(key); });
  // Hits at equal distance go to the lowest triangle: those that changed places are new ones.
  const std::vector<bool> unchanged = ascending(old_of);
  std::set<std::string> nodes;
  new_triangles_.assign(old_.triangles.size(), kNone);
  triangles_ = keys.size();
  for (std::uint32_t t = 0; t < keys.size(); ++t) {
    if (unchanged[t]) {
      new_triangles_[old_of[t]] = t;
      continue;
    }
    added_triangles_.push_back(t);
    nodes.insert(scene.nodes[geometry.node[t]].path);
  }
  for (std::uint32_t t = 0; t < new_triangles_.size(); ++t) {
    if (new_triangles_[t] != kNone) continue;
    removed_triangles_.push_back(t);
    nodes.insert(old_.nodes[old_.triangle_nodes[t]]);
  }
  nodes_.assign(nodes.begin(), nodes.end());
}

Result<void> SceneChange::cast(const Geometry& geometry) {
  auto added = caster_of(geometry.positions, geometry.triangles, added_triangles_);
  if (!added) return tl::unexpected(added.error());
  auto removed = caster_of(old_.positions, old_.triangles, removed_triangles_);
  if (!removed) return tl::unexpected(removed.error());
  added_ = std::move(*added), removed_ = std::move(*removed);
  std::vector<Box> boxes;
  for (const auto t : added_triangles_) boxes.push_back(box_of(geometry.positions, geometry.triangles[t]));
  if (!boxes.empty()) added_bounds_ = join(boxes);
  const std::size_t added_boxes = boxes.size();
  for (const auto t : removed_triangles_) boxes.push_back(box_of(old_.positions, old_.triangles[t]));
  if (boxes.size() > added_boxes) removed_bounds_ = join(std::span<const Box>(boxes).subspan(added_boxes));
  boxes_ = BoxTree(std::move(boxes));
  return {};
}

std::vector<std::uint8_t> SceneChange::known_ties(const Geometry& geometry) const {
  // What is near or thin is told by the largest coordinate.
  if (!comparable_ || largest_coordinate(geometry.positions) != largest_coordinate(old_.positions)) return {};
  std::vector<Box> boxes;
  for (const auto t : removed_triangles_) boxes.push_back(box_of(old_.positions, old_.triangles[t]));
  const BoxTree removed(std::move(boxes));
  std::vector<std::uint8_t> known(triangles_, kUnknownTies);
  for (std::uint32_t t = 0; t < new_triangles_.size(); ++t) {
    if (new_triangles_[t] == kNone) continue;
    const std::uint8_t flags = old_.ties.empty() ? 0 : old_.ties[t];
    Box box = box_of(old_.positions, old_.triangles[t]);
    box.lower -= margin_, box.upper += margin_;
    // What it lay on may be gone.
    if (flags == 0 || !removed.meets(box)) known[new_triangles_[t]] = flags;
  }
  return known;
}

std::vector<bool> SceneChange::settled(const Geometry& geometry, const RayCaster& caster) const {
  const auto flags = [](const std::vector<std::uint8_t>& ties, std::uint32_t t) {
    return !ties.empty() && ties[t] != 0;
  };
  std::vector<bool> settled(triangles_, false);
  for (std::uint32_t t = 0; t < new_triangles_.size(); ++t) {
    const std::uint32_t own = new_triangles_[t];
    if (own == kNone) continue;
    const bool was_hollow = !old_.hollow.empty() && old_.hollow[t] != 0,
               is_hollow = !geometry.hollow.empty() && geometry.hollow[own];
    settled[own] = was_hollow == is_hollow && flags(old_.ties, t) == flags(caster.ties(), own);
  }
  return settled;
}

std::vector<Box> SceneChange::changed_boxes(const Geometry& geometry, const RayCaster& caster) const {
  std::vector<Box> boxes;
  const std::vector<bool> same = settled(geometry, caster);
  for (const std::uint32_t t : new_triangles_) {
    if (t != kNone && !same[t]) boxes.push_back(box_of(geometry.positions, geometry.triangles[t]));
  }
  if (boxes.size() > kMostBoxes) boxes = {join(boxes)};
  if (added_) boxes.push_back(added_bounds_);
  if (removed_) boxes.push_back(removed_bounds_);
  for (Box& box : boxes) box.lower -= margin_, box.upper += margin_;
  return boxes;
}

bool SceneChange::disturbed(const glm::vec3& position, float reach) const {
  const glm::vec3 far(reach + margin_);
  return boxes_.meets({position - far, position + far});
}

}  // namespace relume
