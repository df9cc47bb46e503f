// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "precompute/emitters.h"
#include "precompute/ray_caster.h"
#include "precompute/rows_file.h"
#include "precompute/scene_change.h"
#include "precompute/sender_lookup.h"
#include "precompute/shadow.h"
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

/// Where rays begin, and what may be hidden from there by what was added.
struct Vantage {
  Ball origins;
  Shadow shadow;
};

/// What rays of an earlier precompute see among senders of this one.
struct KeptSenders {
  struct Met {
    std::uint32_t code = RayCodes::kUnknown;  ///< in this scene
    std::uint32_t seen = 0;                   ///< as a number to count by
  };
  /// Per code of the old scene; unknown when it is gone or changed, or belongs to a possible emitter. Then
  /// one more, for whatever is no code, that is unknown.
  std::vector<Met> met;
  Balls balls;                       ///< per sender that is a cluster: they hold all of it
  float usual_radius = 0.0f;         ///< m, that most of them have
  std::vector<std::uint32_t> codes;  ///< per sender that is a cell of the sky; others: kUnknown
};

/// The rays of an earlier precompute in a scene that has changed since. A ray still meets what it met when
/// that is still there, unchanged, and nothing new stands before it. Thread-safe.
class KeptRays {
 public:
  /// Borrows the change. Fails (bad_input) when the rows are those of another texel size or ray tracer;
  /// `name` is used in messages.
  static Result<KeptRays> compare(const SceneChange& change, const std::string& name, double texel_size,
                                  const Surfaces& surfaces, const RayCaster& caster,
                                  const SenderLookup& lookup, std::span<const std::uint64_t> element_keys);

  /// Key of the emitters that the samples were drawn from.
  std::uint64_t emitters() const { return old_.settings.emitters; }
  const SceneChange& change() const { return change_; }

  /// Receivers with these identities will be asked for next.
  void fetch(std::span<const std::uint64_t> identities) const;
  /// Of a receiver with this identity.
  std::optional<OldRays> find(std::uint64_t identity) const;
  /// What the ray met, in the codes of the old scene; kUnknown when nobody traced it.
  std::uint32_t old_code(const OldRays& rays, std::uint32_t ray) const {
    return ray < rays.rays ? load_code(rays.codes, old_width_, ray) : RayCodes::kUnknown;
  }
  std::uint32_t old_width() const { return old_width_; }
  /// The same in the codes of this scene; kUnknown when it is gone or changed.
  std::uint32_t translated(std::uint32_t old_code) const {
    return old_code < new_codes_.size() ? new_codes_[old_code] : RayCodes::kUnknown;
  }
  std::uint32_t code(const OldRays& rays, std::uint32_t ray) const { return translated(old_code(rays, ray)); }
  SampleState sample(const OldRays& rays, std::uint32_t sample) const;
  /// `seen`: per code of this scene, a number to count by; `open` of those that are to be asked for.
  KeptSenders senders(const SenderLookup& lookup, std::span<const std::uint32_t> seen,
                      std::uint32_t open) const;

  /// Whether all light patches of an element of this scene belonged to it, and nothing there has changed.
  bool was_whole(std::uint32_t element) const;
  /// Something must have been added. Most of what is asked for from there is no larger than `usual`.
  Vantage vantage(const Ball& origins, float usual) const;
  Vantage vantage(const Ball& origins) const { return vantage(origins, usual_radius_); }
  /// Whether nothing that was added lies between there and what rays met whose code, of this scene, this is.
  bool stands_clear(const Vantage& from, std::uint32_t code) const;
  /// The same of all that a ball holds.
  bool stands_clear(const Vantage& from, const Ball& ball) const;
  /// Of the lanes of a packet that `lanes` says, and that met what `codes` say: those that something new may
  /// stand before.
  std::uint32_t blocked(const RayPacket& packet, std::uint32_t lanes,
                        const std::array<std::uint32_t, kPacketSize>& codes) const;
  /// Of the lanes of a packet of segments (near 0, far 1): those that something new stands in.
  std::uint32_t newly_hidden(const RayPacket& packet, std::uint32_t lanes) const;
  /// Those that something stood in that is gone.
  std::uint32_t freed(const RayPacket& packet, std::uint32_t lanes) const;

 private:
  explicit KeptRays(const SceneChange& change) : change_(change), old_(change.old()) {}
  bool clear_of_sky(const Vantage& from, std::uint32_t cell) const;
  void find_balls(const Surfaces& surfaces);
  void translate(const Surfaces& surfaces, const RayCaster& caster, const SenderLookup& lookup,
                 std::span<const std::uint64_t> keys);
  void index_receivers();

  const SceneChange& change_;
  const RowsFile& old_;
  RayCodes old_codes_, codes_;
  std::uint32_t old_width_ = 0;              ///< of old_codes_
  Box added_;                                ///< holds all that was added, and a margin
  float usual_radius_ = 0.0f;                ///< m, that most of balls_ have
  std::vector<std::uint32_t> old_elements_;  ///< per element of this scene: which it was, or kNone
  std::vector<Ball> balls_;                  ///< per element of this scene: they hold it
  std::vector<Ball> triangle_balls_;         ///< per triangle of this scene
  std::vector<glm::vec3> cells_;             ///< directions of the sky
  std::vector<std::uint32_t> new_codes_;     ///< per old code; empty: nothing can be kept
  /// A receiver of the old scene, and where what is known of it begins.
  struct Place {
    std::uint64_t identity, first_code, first_sample, first_hit;
    std::uint32_t rays, samples, hits;
  };
  std::vector<Place> places_;
  std::vector<std::uint32_t> first_place_;  ///< by the first bits of their identities
};

}  // namespace relume
