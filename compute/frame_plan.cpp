// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "compute/planner.h"
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
  return bounces * (import + cost_of(traits, StepKernel::bounce) + cost_of(traits, StepKernel::small_nodes) +
                    cost_of(traits, StepKernel::nodes)) +
         import + cost_of(traits, StepKernel::gather) + cost_of(traits, StepKernel::directions) +
         cost_of(traits, StepKernel::probes);
}

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

/// Whether the tolerance is met as it is.
bool reached(const Schedule& schedule, const PassWishes& wishes) {
  if (wishes.tolerance <= 0.0) return false;
  return std::all_of(schedule.systems.begin(), schedule.systems.end(), [&](const SystemProgress& system) {
    return !system.active || (wishes.gather ? system.output_error : system.error) <= wishes.tolerance;
  });
}

/// Of systems whose errors are `error`, the bounces after which all are within the tolerance; at most those
/// wished for.
std::uint32_t bounces_to(Traits traits, std::vector<double> error, const Schedule& schedule,
                         const PassWishes& wishes) {
  const auto off = [&](std::uint32_t s) {
    return wishes.gather ? arriving(traits[s].gather, error) : error[s];
  };
  for (std::uint32_t bounces = 0; bounces < wishes.bounces; ++bounces) {
    bool within = true;
    std::vector<double> next = error;
    for (std::uint32_t s = 0; s < error.size(); ++s) {
      if (!schedule.systems[s].active) continue;
      within = within && off(s) <= wishes.tolerance;
      next[s] = arriving(traits[s].bounce, error);
    }
    if (within) return bounces;
    error = std::move(next);
  }
  return wishes.bounces;
}

/// One that is missing would not take part in the equations of the rooms.
bool all_active(Traits traits, const Schedule& schedule) {
  for (std::size_t s = 0; s < traits.size(); ++s) {
    if (traits[s].loaded && !schedule.systems[s].active) return false;
  }
  return true;
}

void begin_together(Traits traits, Schedule& schedule, const PassWishes& wishes) {
  PassProgress& pass = schedule.pass;
  for (std::uint32_t s = 0; s < schedule.systems.size(); ++s) {
    SystemProgress& system = schedule.systems[s];
    if (!system.active) continue;
    pass.systems.push_back(s);
    if (wishes.restart) system.error = schedule.largest_radiosity;
  }
  const bool to_tolerance = wishes.tolerance > 0.0;
  pass.stage = wishes.restart ? PassStage::start : PassStage::start_small_nodes;
  pass.bounces =
      to_tolerance ? bounces_to(traits, radiosity_errors(schedule), schedule, wishes) : wishes.bounces;
  pass.correct = wishes.correct && !to_tolerance && all_active(traits, schedule);
  pass.residual = wishes.residual;
  pass.gather = wishes.gather ? GatherRule::always : GatherRule::never;
}

}  // namespace

FramePlan plan_together(Traits traits, const Schedule& schedule, const PassWishes& wishes) {
  Planner planner(traits, schedule, wishes.max_form_factors, 0.0);
  planner.start_new();
  if (wishes.tolerance > 0.0) planner.run();
  Schedule& state = planner.state();
  if (state.pass.stage == PassStage::done && !reached(state, wishes)) {
    begin_together(traits, state, wishes);
  }
  planner.run();
  return planner.finish();
}

}  // namespace relume
