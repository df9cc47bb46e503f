// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "precompute/box_tree.h"
#include "precompute/geometry.h"
#include "precompute/key_index.h"
#include "precompute/ray_caster.h"
#include "precompute/rows_file.h"

namespace relume {

/// Which triangles a scene has that the scene of earlier rows has not, and the other way round. Thread-safe.
class SceneChange {
 public:
  /// Borrows the old rows. `keys` of the triangles (geometry_keys.h). Fails (bad_input) when the rows were
  /// traced with another seed, or in a scene that has nothing in common with this one; `name` is used in
  /// messages.
  static Result<SceneChange> find(const RowsFile& old, const std::string& name, const Scene& scene,
                                  const Geometry& geometry, std::uint64_t seed,
                                  std::span<const std::uint64_t> keys);

  const RowsFile& old() const { return old_; }
  /// Whether rays start from the same places: if not, nothing can be kept.
  bool comparable() const { return comparable_; }
  /// Paths of the nodes, of either scene, that have triangles which the other has not.
  const std::vector<std::string>& nodes() const { return nodes_; }
  /// Per triangle of the old scene: which it is now, or kNone.
  const std::vector<std::uint32_t>& new_triangles() const { return new_triangles_; }
  /// Rays among what was added, or taken away; none when nothing was.
  const std::optional<RayCaster>& added() const { return added_; }
  const std::optional<RayCaster>& removed() const { return removed_; }
  /// Of the triangles of this scene, as RayCaster::create takes them.
  std::vector<std::uint8_t> known_ties(const Geometry& geometry) const;
  /// Per triangle of this scene: whether it is as it was, bounds a hollow or not as before, and hits as far
  /// away as those on it are settled as before.
  std::vector<bool> settled(const Geometry& geometry, const RayCaster& caster) const;
  /// Outside of these, rays of this scene meet what they met.
  std::vector<Box> changed_boxes(const Geometry& geometry, const RayCaster& caster) const;
  /// Of what was added, when something was.
  const Box& added_bounds() const { return added_bounds_; }
  /// m: no two places closer than that are told apart.
  float margin() const { return margin_; }

  /// Whether anything changed within `reach` metres.
  bool disturbed(const glm::vec3& position, float reach) const;
  /// Whether the old scene had an element of this key.
  bool had_element(std::uint64_t key) const { return old_element(key) != kNone; }
  /// Which it was, or kNone.
  std::uint32_t old_element(std::uint64_t key) const { return key != 0 ? old_elements_.find(key) : kNone; }

 private:
  explicit SceneChange(const RowsFile& old) : old_(old) {}
  void match(const Geometry& geometry, const Scene& scene, std::span<const std::uint64_t> keys);
  Result<void> cast(const Geometry& geometry);

  const RowsFile& old_;
  bool comparable_ = false;
  std::vector<std::string> nodes_;
  std::vector<std::uint32_t> new_triangles_;
  std::vector<std::uint32_t> added_triangles_;    ///< of this scene
  std::vector<std::uint32_t> removed_triangles_;  ///< of the old one
  std::optional<RayCaster> added_, removed_;
  Box added_bounds_, removed_bounds_;
  std::size_t triangles_ = 0;  ///< of this scene
  BoxTree boxes_;              ///< of all that changed
  float margin_ = 0.0f;
  KeyIndex old_elements_;
};

}  // namespace relume
