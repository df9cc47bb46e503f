// SPDX-License-Identifier: MIT
//
// Which lights reach which surfaces, what of it is known already, and what to trace next: the processor's
// part of direct light, without Vulkan.
//
// Surfaces are taken in blocks of up to kernels::kBlockElements elements. A pair is a light and a block that
// it may reach (range, cone, facing); the device keeps for each pair a slot with what the light gives each
// element for an intensity of 1. H is the sum over the pairs of a block in the order of the lights, so that
//   - a light that moves costs the rays of its own pairs, old and new, and of no other light;
//   - a light that changes colour costs no rays;
//   - the result is the same to the bit as if all had been traced anew.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/light.h"
#include "core/result.h"

namespace relume {

/// A run of elements, as far as the processor must know them. Metres about the origin of the model.
struct LightBlock {
  std::uint32_t first_element = 0;
  std::uint32_t element_count = 0;
  std::uint32_t patch_count = 0;
  std::uint32_t first_cluster = 0;  ///< of its elements ...
  std::uint32_t end_cluster = 0;    ///< ... and one after the last; equal: only sensors
  glm::dvec3 centre{0.0};
  double radius = 0.0;  ///< of a ball around it
  glm::dvec3 axis{0.0, 0.0, 1.0};
  double spread = 0.0;   ///< all normals are this near to the axis, as points of the unit sphere
  double lowest = 0.0;   ///< least dot(axis, point) of its points ...
  double highest = 0.0;  ///< ... and the largest
};

/// Whether a light (position about the origin of the model) may give the block anything.
bool may_reach(const Light& light, const LightBlock& block);

struct LightPair {
  std::uint32_t light = 0;
  std::uint32_t slot = 0;
  bool pending = true;  ///< to be traced
};

/// What a part of a frame does; numbers as in kernels/shared/direct_light.h.
struct LightWork {
  struct Trace {
    std::uint32_t block, light, slot;
    std::uint64_t rays;  ///< about
  };
  struct Sum {
    std::uint32_t block, first_pair, pair_count;
  };
  std::vector<Trace> traces;
  std::vector<Sum> sums;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< slot, light
  std::uint64_t rays = 0;
  std::uint32_t first_cluster = 0;  ///< of those whose H changes ...
  std::uint32_t end_cluster = 0;    ///< ... and one after the last
};

/// Largest size of a LightWork.
struct LightWorkLimits {
  std::uint64_t rays = ~std::uint64_t{0};   ///< but at least one block
  std::uint64_t words = ~std::uint64_t{0};  ///< of the work buffer: 4 a trace or sum, 2 a pair
};

/// A value of the host's. take() books its work as done: a host that drops the command buffer goes on with
/// the copy from before, or calls retrace().
class LightSchedule {
 public:
  /// Without lights: everything is to be summed (to 0) once.
  LightSchedule(std::shared_ptr<const std::vector<LightBlock>> blocks, const glm::dvec3& origin,
                std::uint32_t max_lights, std::uint32_t max_pairs);

  /// The lights of the frame (world space), finite and with unit directions. A light is known by its place in
  /// the list: switch one off by its intensity to keep those after it in place. Fails with usage, and changes
  /// nothing, when there are more lights or pairs than the limits.
  Result<void> set_lights(std::span<const Light> lights);

  /// Blocks that a light of the frame may reach: what it counts against the limit of pairs.
  std::size_t pairs_of(const Light& light) const;

  /// Everything is traced again: masks or matrices of the host's have changed, or work was lost.
  void retrace();

  /// A `change` for note_change (compute/schedule.h): how much H of a cluster may still change, in lm/m2 of
  /// the worst channel, until the schedule is complete; 0 when it is. No light gives a block more than its
  /// intensity over the square of the least distance. `largest` bounds it where lights are too near for that,
  /// and after retrace(): Schedule::largest_radiosity, as no source is larger. To be noted before each plan.
  double pending_change(double largest) const;

  /// Nothing is left to do.
  bool complete() const { return next_dirty_ == dirty_.size(); }

  /// The next blocks, in order.
  LightWork take(const LightWorkLimits& limits);

  const std::vector<Light>& lights() const { return lights_; }  ///< about the origin of the model
  std::uint32_t max_lights() const { return max_lights_; }
  std::uint32_t max_pairs() const { return max_pairs_; }
  std::uint64_t pair_count() const { return pair_count_; }

  /// Set by set_lights(), cleared by whoever has written the lights to the device.
  bool lights_changed = false;

 private:
  std::vector<std::uint32_t> reached_blocks(const Light& light) const;
  void replace_pairs(std::uint32_t light, std::vector<std::uint32_t> blocks);
  void mark_dirty(std::uint32_t block);
  void add_change(const Light& light, std::span<const std::uint32_t> blocks);

  std::shared_ptr<const std::vector<LightBlock>> blocks_;
  std::vector<LightBlock> groups_;  ///< balls around runs of blocks
  glm::dvec3 origin_;
  std::uint32_t max_lights_;
  std::uint32_t max_pairs_;
  std::vector<Light> lights_;
  std::vector<std::vector<std::uint32_t>> reach_;  ///< per light: blocks, ascending
  std::vector<std::vector<LightPair>> pairs_;      ///< per block: by light, ascending
  std::vector<std::uint32_t> free_slots_;
  std::uint64_t pair_count_ = 0;
  std::vector<bool> dirty_;     ///< per block
  std::vector<double> change_;  ///< per block: of H, at most, when it is summed
  std::size_t next_dirty_ = 0;
};

}  // namespace relume
