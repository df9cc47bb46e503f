// SPDX-License-Identifier: MIT
//
// Makes the steps of one frame and keeps the books on what they achieve: how plan_frame and plan_together
// walk through a pass. Internal.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "compute/schedule.h"

namespace relume {

/// How much a bounce of a system lowers the bound on its error.
double bounce_gain(std::span<const SystemTraits> traits, const Schedule& schedule, std::uint32_t system);

/// The same of a gather and its outputs.
double gather_gain(std::span<const SystemTraits> traits, const Schedule& schedule, std::uint32_t system);

class Planner {
 public:
  Planner(std::span<const SystemTraits> traits, const Schedule& schedule, std::uint64_t max_cost,
          double display_step);

  Schedule& state() { return plan_.next; }
  bool has_room() const { return plan_.steps.empty() || plan_.cost < max_cost_; }
  std::uint64_t room() const { return max_cost_ - std::min(max_cost_, plan_.cost); }

  /// Systems that are new, whatever it costs: others see them from this frame on.
  void start_new();

  /// The pass of the schedule, as far as it fits.
  void run();

  FramePlan finish();

  FramePlan& plan() { return plan_; }

 private:
  void choose_outputs(PassProgress& pass) const;
  /// False when the frame is full.
  bool run_member(PassProgress& pass);
  void add(FrameStep step);
  void finish_stage(PassProgress& pass);
  void flip(std::uint32_t system);
  void publish(std::uint32_t system);

  std::span<const SystemTraits> traits_;
  std::uint64_t max_cost_;
  double display_step_;
  bool barrier_due_ = false;
  FramePlan plan_;
};

}  // namespace relume
