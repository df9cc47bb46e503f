// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "precompute/box_tree.h"
#include "precompute/ray_caster.h"
#include "precompute/rows_file.h"
#include "precompute/sender_lookup.h"
#include "precompute/surfaces.h"

namespace relume {

/// What an earlier precompute knew of one receiver.
struct OldRays {
  const std::byte* codes = nullptr;
  std::uint32_t rays = 0;
  const std::byte* samples = nullptr;
  std::uint32_t sample_count = 0;
  std::span<const EmitterHit> emitter_hits;
};

/// The rays of an earlier precompute in a scene that has changed since. A ray still meets what it met when
/// that is still there, unchanged, and nothing new stands before it. Thread-safe.
class KeptRays {
 public:
  /// Borrows the old rows. Fails (bad_input) when the rows were traced with
  /// other settings, or in a scene that has nothing in common with this one; `name` is used in messages.
  static Result<KeptRays> compare(const RowsFile& old, const std::string& name, const Scene& scene,
                                  std::uint64_t seed, double texel_size, const Surfaces& surfaces,
                                  const RayCaster& caster, const SenderLookup& lookup,
                                  std::span<const std::uint64_t> triangle_keys,
                                  std::span<const std::uint64_t> element_keys);

  /// Paths of the nodes, of either scene, that have triangles which the other has not.
  const std::vector<std::string>& changed_nodes() const { return changed_nodes_; }
  /// Key of the emitters that the samples were drawn from.
  std::uint64_t emitters() const { return old_.settings.emitters; }
  /// Whether something was added that rays may meet.
  bool adds() const { return added_.has_value(); }
  /// Of what was added; there must be something.
  const Box& added_bounds() const { return added_bounds_; }

  /// Of a receiver with this identity.
  std::optional<OldRays> find(std::uint64_t identity) const;
  /// What the ray met, in the codes of this scene; kUnknown when that is gone or changed.
  std::uint32_t code(const OldRays& rays, std::uint32_t ray) const;
  SampleState sample(const OldRays& rays, std::uint32_t sample) const;

  /// Whether anything changed within `reach` metres.
  bool disturbed(const glm::vec3& position, float reach) const;
  /// Whether nothing that was added lies between the points within `reach` of a place and those of an
  /// element.
  bool stands_clear(const glm::vec3& from, float reach, std::uint32_t element) const;
  /// Of the lanes of a packet that `lanes` says, and that met what `codes` say: those that something new may
  /// stand before.
  std::uint32_t blocked(const RayPacket& packet, std::uint32_t lanes,
                        const std::array<std::uint32_t, kPacketSize>& codes) const;
  /// Of the lanes of a packet of segments (near 0, far 1): those that something new stands in.
  std::uint32_t newly_hidden(const RayPacket& packet, std::uint32_t lanes) const;
  /// Those that something stood in that is gone.
  std::uint32_t freed(const RayPacket& packet, std::uint32_t lanes) const;

 private:
  struct Ball {
    glm::vec3 middle{0.0f};
    float radius = 0.0f;
  };

  explicit KeptRays(const RowsFile& old) : old_(old) {}
  void match_triangles(const Geometry& geometry, const Scene& scene, std::span<const std::uint64_t> keys);
  Result<void> cast_changes(const Geometry& geometry);
  void find_balls(const Surfaces& surfaces);
  void translate(const Surfaces& surfaces, const RayCaster& caster, const SenderLookup& lookup,
                 std::span<const std::uint64_t> keys);
  void index_receivers();

  const RowsFile& old_;
  RayCodes old_codes_, codes_;
  std::vector<std::uint32_t> new_triangle_;       ///< per old one, or kNone
  std::vector<std::uint32_t> added_triangles_;    ///< of this scene
  std::vector<std::uint32_t> removed_triangles_;  ///< of the old one
  std::vector<std::string> changed_nodes_;
  std::optional<RayCaster> added_, removed_;
  Box added_bounds_;
  Ball added_ball_;
  BoxTree changes_;
  std::vector<Ball> balls_;               ///< per element of this scene: they hold it
  std::vector<std::uint32_t> new_codes_;  ///< per old code; empty: nothing can be kept
  std::vector<std::uint64_t> first_code_, first_sample_, first_hit_;  ///< per receiver
  float margin_ = 0.0f;  ///< m: no two places closer than that are told apart
};

}  // namespace relume
