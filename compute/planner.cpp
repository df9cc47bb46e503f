// SPDX-License-Identifier: MIT
#include "compute/planner.h"

#include <limits>
#include <utility>

namespace relume {
namespace {

StepKernel kernel_of(PassStage stage) {
  switch (stage) {
    case PassStage::start:
      return StepKernel::start;
    case PassStage::start_small_nodes:
    case PassStage::small_nodes:
    case PassStage::corrected_small_nodes:
      return StepKernel::small_nodes;
    case PassStage::start_nodes:
    case PassStage::nodes:
    case PassStage::corrected_nodes:
      return StepKernel::nodes;
    case PassStage::restrict_rooms:
      return StepKernel::restrict_rooms;
    case PassStage::solve_rooms:
      return StepKernel::solve_rooms;
    case PassStage::correct_rooms:
      return StepKernel::correct_rooms;
    case PassStage::bounce:
      return StepKernel::bounce;
    case PassStage::residual:
      return StepKernel::residual;
    case PassStage::gather:
      return StepKernel::gather;
    case PassStage::directions:
      return StepKernel::directions;
    case PassStage::probes:
      return StepKernel::probes;
    case PassStage::import:
    case PassStage::gather_import:
    case PassStage::done:
      break;
  }
  return StepKernel::import_radiosity;
}

/// Bounces write the half that does not count yet.
bool writes_other_half(PassStage stage) {
  return stage == PassStage::bounce || stage == PassStage::small_nodes || stage == PassStage::nodes;
}

/// Nodes that are about to change again.
bool corrected_later(const PassProgress& pass) {
  if (!pass.correct) return false;
  const bool at_start = pass.stage == PassStage::start_small_nodes || pass.stage == PassStage::start_nodes;
  const bool after_bounce = pass.stage == PassStage::small_nodes || pass.stage == PassStage::nodes;
  return (at_start && pass.bounces > 0) || (after_bounce && pass.bounces > 1);
}

void begin_gather(PassProgress& pass) {
  if (pass.gather == GatherRule::never) {
    pass = {};
  } else {
    pass.stage = PassStage::gather_import;
  }
}

void next_bounce(PassProgress& pass) {
  if (pass.bounces > 0) {
    pass.stage = pass.correct ? PassStage::restrict_rooms : PassStage::import;
  } else if (pass.residual) {
    pass.stage = PassStage::residual;
  } else {
    begin_gather(pass);
  }
}

}  // namespace

double bounce_gain(std::span<const SystemTraits> traits, const Schedule& schedule, std::uint32_t s) {
  const double after = arriving(traits[s].bounce, radiosity_errors(schedule));
  return std::max(schedule.systems[s].error - after, 0.0);
}

double gather_gain(std::span<const SystemTraits> traits, const Schedule& schedule, std::uint32_t s) {
  const double after = arriving(traits[s].gather, radiosity_errors(schedule));
  return std::max(schedule.systems[s].output_error - after, 0.0);
}

Planner::Planner(std::span<const SystemTraits> traits, const Schedule& schedule, std::uint64_t max_cost,
                 double display_step)
    : traits_(traits), max_cost_(max_cost), display_step_(display_step) {
  plan_.next = schedule;
  for (const SystemProgress& system : schedule.systems)
    plan_.halves.push_back(system.active ? system.half : kInactive);
}

void Planner::start_new() {
  PassProgress start{{}, PassStage::start};
  for (std::uint32_t s = 0; s < state().systems.size(); ++s) {
    if (state().systems[s].active && !state().systems[s].started) start.systems.push_back(s);
  }
  if (start.systems.empty()) return;
  const PassProgress kept = std::exchange(state().pass, start);
  const std::uint64_t limit = std::exchange(max_cost_, std::numeric_limits<std::uint64_t>::max());
  run();
  max_cost_ = limit;
  state().pass = kept;
  barrier_due_ = true;
}

void Planner::run() {
  PassProgress& pass = state().pass;
  while (pass.stage != PassStage::done) {
    if (pass.stage == PassStage::gather_import && pass.member == 0 && pass.dispatch == 0) {
      choose_outputs(pass);
    }
    for (; pass.member < pass.systems.size(); ++pass.member, pass.dispatch = 0) {
      if (!run_member(pass)) return;
    }
    finish_stage(pass);
    pass.member = 0;
    pass.dispatch = 0;
    barrier_due_ = true;
  }
}

FramePlan Planner::finish() {
  plan_.pass_complete = state().pass.stage == PassStage::done;
  for (const SystemProgress& system : state().systems) {
    if (!system.active) continue;
    plan_.radiosity_error = std::max(plan_.radiosity_error, system.error);
    plan_.output_error = std::max(plan_.output_error, system.output_error);
  }
  plan_.skipped = std::min(plan_.skipped, plan_.output_error);
  return std::move(plan_);
}

void Planner::choose_outputs(PassProgress& pass) const {
  if (pass.gather == GatherRule::always || display_step_ <= 0.0) return;
  std::erase_if(pass.systems, [&](std::uint32_t system) {
    return gather_gain(traits_, plan_.next, system) <= 0.5 * display_step_;
  });
}

bool Planner::run_member(PassProgress& pass) {
  if (corrected_later(pass)) return true;
  const std::uint32_t s = pass.systems[pass.member];
  SystemProgress& system = state().systems[s];
  const StepKernel kernel = kernel_of(pass.stage);
  const std::vector<std::uint64_t>& costs = traits_[s].costs[static_cast<std::size_t>(kernel)];
  for (; pass.dispatch < costs.size(); ++pass.dispatch) {
    const std::uint64_t cost = costs[pass.dispatch];
    if (plan_.cost + cost > max_cost_ && !plan_.steps.empty()) return false;
    plan_.cost += cost;
    const std::uint32_t half = writes_other_half(pass.stage) ? 1 - system.half : system.half;
    add({FrameStep::Kind::dispatch, kernel, s, pass.dispatch, half});
  }
  if (pass.stage == PassStage::import) {
    system.next_error = arriving(traits_[s].bounce, radiosity_errors(state()));
  }
  if (pass.stage == PassStage::gather_import) {
    system.next_output_error = arriving(traits_[s].gather, radiosity_errors(state()));
  }
  return true;
}

void Planner::add(FrameStep step) {
  step.barrier_before = std::exchange(barrier_due_, false) && !plan_.steps.empty();
  plan_.steps.push_back(step);
}

void Planner::finish_stage(PassProgress& pass) {
  switch (pass.stage) {
    case PassStage::start:
      pass.stage = PassStage::start_small_nodes;
      return;
    case PassStage::start_small_nodes:
      pass.stage = PassStage::start_nodes;
      return;
    case PassStage::start_nodes:
      for (const std::uint32_t s : pass.systems) state().systems[s].started = true;
      return next_bounce(pass);
    case PassStage::restrict_rooms:
      pass.stage = PassStage::solve_rooms;
      return;
    case PassStage::solve_rooms:
      pass.stage = PassStage::correct_rooms;
      return;
    case PassStage::correct_rooms:
      for (const std::uint32_t s : pass.systems) state().systems[s].error = state().largest_radiosity;
      pass.stage = PassStage::corrected_small_nodes;
      return;
    case PassStage::corrected_small_nodes:
      pass.stage = PassStage::corrected_nodes;
      return;
    case PassStage::corrected_nodes:
      pass.stage = PassStage::import;
      return;
    case PassStage::import:
      pass.stage = PassStage::bounce;
      return;
    case PassStage::bounce:
      pass.stage = PassStage::small_nodes;
      return;
    case PassStage::small_nodes:
      pass.stage = PassStage::nodes;
      return;
    case PassStage::nodes:
      barrier_due_ = true;
      for (const std::uint32_t s : pass.systems) flip(s);
      --pass.bounces;
      return next_bounce(pass);
    case PassStage::residual:
      return begin_gather(pass);
    case PassStage::gather_import:
      pass.stage = PassStage::gather;
      return;
    case PassStage::gather:
      pass.stage = PassStage::directions;
      return;
    case PassStage::directions:
      pass.stage = PassStage::probes;
      return;
    case PassStage::probes:
      barrier_due_ = true;
      for (const std::uint32_t s : pass.systems) publish(s);
      [[fallthrough]];
    case PassStage::done:
      pass = {};
  }
}

void Planner::flip(std::uint32_t s) {
  SystemProgress& system = state().systems[s];
  system.half = 1 - system.half;
  add({FrameStep::Kind::flip, StepKernel::nodes, s, 0, system.half});
  system.error = system.next_error;
}

void Planner::publish(std::uint32_t s) {
  state().systems[s].output_error = state().systems[s].next_output_error;
  add({FrameStep::Kind::publish, StepKernel::gather, s, 0, state().systems[s].half});
}

}  // namespace relume
