// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "compute/schedule.h"

namespace relume {
namespace {

using Traits = std::span<const SystemTraits>;

std::uint64_t cost_of(const SystemTraits& traits, StepKernel kernel) {
  const std::vector<std::uint64_t>& costs = traits.costs[static_cast<std::size_t>(kernel)];
  return std::accumulate(costs.begin(), costs.end(), std::uint64_t{0});
}

std::uint64_t pass_cost(const SystemTraits& traits, std::uint32_t bounces) {
  const std::uint64_t import = cost_of(traits, StepKernel::import_radiosity);
  return bounces * (import + cost_of(traits, StepKernel::bounce) + cost_of(traits, StepKernel::nodes)) +
         import + cost_of(traits, StepKernel::gather) + cost_of(traits, StepKernel::directions) +
         cost_of(traits, StepKernel::probes);
}

StepKernel kernel_of(PassStage stage) {
  switch (stage) {
    case PassStage::start:
      return StepKernel::start;
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
  return stage == PassStage::bounce || stage == PassStage::nodes;
}

/// Nodes that are about to change again.
bool corrected_later(const PassProgress& pass) {
  if (!pass.correct) return false;
  return (pass.stage == PassStage::start_nodes && pass.bounces > 0) ||
         (pass.stage == PassStage::nodes && pass.bounces > 1);
}

/// How much a bounce of a system lowers the bound on its error.
double bounce_gain(Traits traits, const Schedule& schedule, std::uint32_t s) {
  const double after = arriving(traits[s].bounce, radiosity_errors(schedule));
  return std::max(schedule.systems[s].error - after, 0.0);
}

/// The same of a gather and its outputs.
double gather_gain(Traits traits, const Schedule& schedule, std::uint32_t s) {
  const double after = arriving(traits[s].gather, radiosity_errors(schedule));
  return std::max(schedule.systems[s].output_error - after, 0.0);
}

/// Makes the steps of one frame and keeps the books on what they achieve.
class Planner {
 public:
  Planner(Traits traits, const Schedule& schedule, std::uint64_t max_cost, double display_step)
      : traits_(traits), max_cost_(max_cost), display_step_(display_step) {
    plan_.next = schedule;
    for (const SystemProgress& system : schedule.systems)
      plan_.halves.push_back(system.active ? system.half : kInactive);
  }

  Schedule& state() { return plan_.next; }
  bool has_room() const { return plan_.steps.empty() || plan_.cost < max_cost_; }
  std::uint64_t room() const { return max_cost_ - std::min(max_cost_, plan_.cost); }

  /// Systems that are new, whatever it costs: others see them from this frame on.
  void start_new() {
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

  /// The pass of the schedule, as far as it fits.
  void run() {
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

  FramePlan finish() {
    plan_.pass_complete = state().pass.stage == PassStage::done;
    for (const SystemProgress& system : state().systems) {
      if (!system.active) continue;
      plan_.radiosity_error = std::max(plan_.radiosity_error, system.error);
      plan_.output_error = std::max(plan_.output_error, system.output_error);
    }
    plan_.skipped = std::min(plan_.skipped, plan_.output_error);
    return std::move(plan_);
  }

  FramePlan& plan() { return plan_; }

 private:
  void choose_outputs(PassProgress& pass) const {
    if (pass.gather == GatherRule::always || display_step_ <= 0.0) return;
    std::erase_if(pass.systems, [&](std::uint32_t system) {
      return gather_gain(traits_, plan_.next, system) <= 0.5 * display_step_;
    });
  }

  /// False when the frame is full.
  bool run_member(PassProgress& pass) {
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

  void add(FrameStep step) {
    step.barrier_before = std::exchange(barrier_due_, false) && !plan_.steps.empty();
    plan_.steps.push_back(step);
  }

  void finish_stage(PassProgress& pass) {
    switch (pass.stage) {
      case PassStage::start:
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
        pass.stage = PassStage::corrected_nodes;
        return;
      case PassStage::corrected_nodes:
        pass.stage = PassStage::import;
        return;
      case PassStage::import:
        pass.stage = PassStage::bounce;
        return;
      case PassStage::bounce:
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

  void next_bounce(PassProgress& pass) {
    if (pass.bounces > 0) {
      pass.stage = pass.correct ? PassStage::restrict_rooms : PassStage::import;
    } else if (pass.residual) {
      pass.stage = PassStage::residual;
    } else {
      begin_gather(pass);
    }
  }

  static void begin_gather(PassProgress& pass) {
    if (pass.gather == GatherRule::never) {
      pass = {};
    } else {
      pass.stage = PassStage::gather_import;
    }
  }

  void flip(std::uint32_t s) {
    SystemProgress& system = state().systems[s];
    system.half = 1 - system.half;
    add({FrameStep::Kind::flip, StepKernel::nodes, s, 0, system.half});
    system.error = system.next_error;
  }

  void publish(std::uint32_t s) {
    state().systems[s].output_error = state().systems[s].next_output_error;
    add({FrameStep::Kind::publish, StepKernel::gather, s, 0, state().systems[s].half});
  }

  Traits traits_;
  std::uint64_t max_cost_;
  double display_step_;
  bool barrier_due_ = false;
  FramePlan plan_;
};

/// Which systems have something to do, and in which order.
class Chooser {
 public:
  Chooser(Traits traits, const Schedule& schedule, const FrameWishes& wishes)
      : traits_(traits), wishes_(wishes), served_(schedule.systems.size(), false) {
    gap_ = std::max(1.0 - contraction_quotient(traits, schedule), 0.0);
  }

  /// Half of the display step is for what bounces would change, half for outputs that wait for a gather.
  bool bounce_due(const Schedule& schedule, std::uint32_t s) const {
    return wishes_.display_step <= 0.0 || gap_ <= 0.0 ||
           bounce_gain(traits_, schedule, s) > 0.5 * gap_ * wishes_.display_step;
  }

  bool gather_due(const Schedule& schedule, std::uint32_t s) const {
    return wishes_.display_step <= 0.0 || gather_gain(traits_, schedule, s) > 0.5 * wishes_.display_step;
  }

  /// What outputs may be off by because of what is not due: the errors of bounces left out feed back.
  double skipped(const Schedule& schedule) const {
    double bounces = 0.0, gathers = 0.0;
    for (std::uint32_t s = 0; s < schedule.systems.size(); ++s) {
      if (!schedule.systems[s].active) continue;
      if (!bounce_due(schedule, s)) bounces = std::max(bounces, bounce_gain(traits_, schedule, s));
      if (!gather_due(schedule, s)) gathers = std::max(gathers, gather_gain(traits_, schedule, s));
    }
    return (bounces > 0.0 ? bounces / gap_ : 0.0) + gathers;
  }

  /// Begins a pass; false when there is nothing to do in this frame. No system begins two.
  bool begin_pass(Schedule& schedule, std::uint64_t room) {
    std::vector<std::uint32_t> candidates;
    std::uint64_t cost = 0;
    bool bounce = false;
    for (std::uint32_t s = 0; s < served_.size(); ++s) {
      if (served_[s] || !schedule.systems[s].active) continue;
      const bool bounces = bounce_due(schedule, s);
      if (!bounces && !gather_due(schedule, s)) continue;
      candidates.push_back(s);
      bounce = bounce || bounces;
      cost += pass_cost(traits_[s], wishes_.bounces);
    }
    if (candidates.empty()) return false;
    if (cost > room) {
      const std::uint32_t first = most_changed(schedule, candidates);
      candidates = {first};
      bounce = bounce_due(schedule, first);
    }
    for (const std::uint32_t s : candidates) served_[s] = true;
    PassProgress& pass = schedule.pass;
    pass = {std::move(candidates), bounce ? PassStage::import : PassStage::gather_import};
    pass.bounces = bounce ? wishes_.bounces : 0;
    pass.gather = GatherRule::when_stale;
    if (pass.bounces == 0) pass.stage = PassStage::gather_import;
    return true;
  }

 private:
  std::uint32_t most_changed(const Schedule& schedule, const std::vector<std::uint32_t>& candidates) const {
    const auto change = [&](std::uint32_t s) {
      return std::max(bounce_gain(traits_, schedule, s), gap_ * gather_gain(traits_, schedule, s));
    };
    return *std::max_element(candidates.begin(), candidates.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return change(a) < change(b); });
  }

  Traits traits_;
  FrameWishes wishes_;
  std::vector<bool> served_;
  double gap_ = 0.0;
};

}  // namespace

bool publishes(const FramePlan& plan, std::uint32_t system) {
  return std::any_of(plan.steps.begin(), plan.steps.end(), [system](const FrameStep& step) {
    return step.kind == FrameStep::Kind::publish && step.system == system;
  });
}

FramePlan plan_frame(Traits traits, const Schedule& schedule, const FrameWishes& wishes) {
  Planner planner(traits, schedule, wishes.max_form_factors, wishes.display_step);
  Chooser chooser(traits, schedule, wishes);
  planner.start_new();
  planner.run();
  while (planner.state().pass.stage == PassStage::done && planner.has_room() &&
         chooser.begin_pass(planner.state(), planner.room())) {
    planner.run();
  }
  planner.plan().skipped = chooser.skipped(planner.state());
  return planner.finish();
}

namespace {

/// One that is missing would not take part in the equations of the rooms.
bool all_active(Traits traits, const Schedule& schedule) {
  for (std::size_t s = 0; s < traits.size(); ++s) {
    if (traits[s].loaded && !schedule.systems[s].active) return false;
  }
  return true;
}

}  // namespace

FramePlan plan_together(Traits traits, const Schedule& schedule, const PassWishes& wishes) {
  Planner planner(traits, schedule, wishes.max_form_factors, 0.0);
  planner.start_new();
  PassProgress& pass = planner.state().pass;
  if (pass.stage == PassStage::done) {
    for (std::uint32_t s = 0; s < schedule.systems.size(); ++s) {
      SystemProgress& system = planner.state().systems[s];
      if (!system.active) continue;
      pass.systems.push_back(s);
      if (wishes.restart) system.error = schedule.largest_radiosity;
    }
    pass.stage = wishes.restart ? PassStage::start : PassStage::start_nodes;
    pass.bounces = wishes.bounces;
    pass.correct = wishes.correct && all_active(traits, schedule);
    pass.residual = wishes.residual;
    pass.gather = wishes.gather ? GatherRule::always : GatherRule::never;
  }
  planner.run();
  return planner.finish();
}

}  // namespace relume
