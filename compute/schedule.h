// SPDX-License-Identifier: MIT
//
// Which dispatches go into the next frame, as values: no Vulkan, no hidden state.
//
// The host holds a Schedule. For each frame it makes a FramePlan from it, records the plan, and, if it really
// submits what was recorded, goes on with FramePlan::next; a command buffer that is dropped is as if its plan
// had never been made.
//
// A *pass* does for some systems together: bounces, then the gather of their outputs. Bounces of systems may
// follow each other in any order: each reads the latest complete radiosity of the others, and what is off
// shrinks (D. Chazan and W. Miranker, Chaotic relaxation, 1969). How much, is known without looking at the
// device, in lm/m2 of the worst channel. Of a system T, C_TS is the largest share that one of its clusters
// reflects of system S (max over i in T of the sum over j in S of rho_i K_ij), q_T that of all systems
// together. With E_S >= max over S of |B - B_exact|,
//
//   F_T(E) = min(sum_S C_TS E_S, q_T max_S E_S)
//   a bounce of T                       E_T becomes F_T(E), of the E when it imported
//   M + rho H changes by at most d      E grows by delta = d + F(delta): what B_exact moves
//   what a bounce of T gains            E_T - F_T(E)
//
// and the same with G for the error of what was gathered; of a probe counts what a plane through it can
// receive at most (shares: solid angle / pi). It is the bound of core/solve.h with weights of 1. Slow drifts
// add up in E, so none is lost.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "compute/pass_plan.h"
#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// A share of the light that the clusters, or gather rows, of a system see of another (or of the sky, whose
/// number is the number of systems).
struct Coupling {
  std::uint32_t system = 0;
  double share = 0.0;
};

struct CouplingRow {
  std::vector<Coupling> shares;  ///< ascending by system
  double total = 0.0;            ///< the largest of all systems together, without the sky
};

/// F of one row: what arrives of `of_system`. The sky has no part in it.
double arriving(const CouplingRow& row, std::span<const double> of_system);

/// What a plan needs to know of a system that is loaded.
struct SystemTraits {
  bool loaded = false;
  std::vector<std::uint64_t> costs[kStepKernels];  ///< of its dispatches, per StepKernel
  CouplingRow bounce;                              ///< row of C, and q
  CouplingRow gather;                              ///< the same of G, and of probes: no albedo
};

/// Costs and couplings of a system that is loaded in `model`. `albedo` per cluster: what it will be at most;
/// empty: as stored.
SystemTraits system_traits(const Model& model, std::uint32_t system, const SystemDispatches& dispatches,
                           std::span<const Rgb> albedo = {});

/// What is known of a system between two frames. Bounds in lm/m2.
struct SystemProgress {
  bool active = false;
  bool started = false;            ///< its radiosity holds something
  std::uint32_t half = 0;          ///< of its radiosity: the one that counts
  double error = 0.0;              ///< E
  double next_error = 0.0;         ///< E when the bounce that it is in is complete
  double output_error = 0.0;       ///< of the irradiance that was published last
  double next_output_error = 0.0;  ///< when the gather that it is in is complete
};

enum class PassStage : std::uint32_t {
  start,
  start_small_nodes,
  start_nodes,
  restrict_rooms,
  solve_rooms,
  correct_rooms,
  corrected_small_nodes,
  corrected_nodes,
  import,
  bounce,
  small_nodes,
  nodes,
  residual,
  gather_import,
  gather,
  directions,
  probes,
  done
};

enum class GatherRule : std::uint32_t { never, when_stale, always };

/// How far a pass got.
struct PassProgress {
  std::vector<std::uint32_t> systems;
  PassStage stage = PassStage::done;
  std::uint32_t member = 0;    ///< of `systems`
  std::uint32_t dispatch = 0;  ///< of that member in this stage
  std::uint32_t bounces = 0;   ///< still to do
  bool correct = false;        ///< before each of them
  bool residual = false;
  GatherRule gather = GatherRule::never;  ///< when_stale: it gains more than half of the display step
};

struct Schedule {
  std::vector<SystemProgress> systems;
  PassProgress pass;
  double largest_radiosity = 0.0;  ///< lm/m2: no surface or sky patch will have more; the host may raise it
};

/// All systems inactive.
Schedule make_schedule(std::size_t systems, double largest_radiosity);

/// What a host wants of one frame.
struct FrameWishes {
  /// No frame has more, but at least one dispatch when there is something to do. Of systems that do not fit
  /// together, the one whose inputs changed most goes first.
  std::uint64_t max_form_factors = ~std::uint64_t{0};
  std::uint32_t bounces = 1;  ///< per pass
  /// lm/m2. What cannot move any output by more is left out: when nothing is left to do, all outputs are
  /// within this of the solution. 0: every system in every frame.
  double display_step = 0.0;
};

/// One thing that a frame records.
struct FrameStep {
  enum class Kind : std::uint32_t {
    dispatch,
    flip,     ///< from here on the half that counts is `half`
    publish,  ///< the outputs of the system are complete
  };
  Kind kind = Kind::dispatch;
  StepKernel kernel = StepKernel::start;
  std::uint32_t system = 0;
  std::uint32_t dispatch = 0;  ///< number among those of the kernel
  std::uint32_t half = 0;      ///< that is written, or counts
  bool barrier_before = false;
};

struct FramePlan {
  Schedule next;
  std::vector<std::uint32_t> halves;  ///< per system, at the start; kInactive
  std::vector<FrameStep> steps;
  std::uint64_t cost = 0;        ///< form factors
  bool pass_complete = false;    ///< no pass is left half done
  double radiosity_error = 0.0;  ///< after this frame, the worst E
  double output_error = 0.0;     ///< the worst of what is published after this frame
  double skipped = 0.0;          ///< of output_error, at most, for what is left out below the display step
};

inline constexpr std::uint32_t kInactive = 2;

/// Whether the frame completes the outputs of a system.
bool publishes(const FramePlan& plan, std::uint32_t system);

/// The next frame.
FramePlan plan_frame(std::span<const SystemTraits> traits, const Schedule& schedule,
                     const FrameWishes& wishes);

/// What plan_together does.
struct PassWishes {
  bool restart = false;  ///< first B = M + rho H
  std::uint32_t bounces = 0;
  /// lm/m2. Above 0, for captures: of `bounces` only as many as bring the worst output, or without `gather`
  /// the worst radiosity, to this; what was cut before is finished first, and when no more is to be gained
  /// nothing is done. FramePlan says whether they were enough: 1 + ln(E / tolerance) / -ln q always are
  /// (contraction_quotient). Rounding of single precision is not in it. Nothing is corrected.
  double tolerance = 0.0;
  /// Before each bounce, what the last one left is corrected room by room (GpuSolver::bind_rooms): from the
  /// difference of the two halves, so that all systems must have been bounced together, or restarted. What E
  /// was is lost. Left out while a system that is loaded is inactive.
  bool correct = false;
  bool residual = false;  ///< what the last bounce changed
  bool gather = false;
  std::uint64_t max_form_factors = ~std::uint64_t{0};
};

/// Exactly this for all active systems in step: the k-th bounce of each reads what the (k-1)-th of all wrote.
/// When it does not fit (FramePlan::pass_complete is false), planning on from `next` with any wishes but a
/// new limit continues it. To a tolerance, now: plan until output_error is not above it, which without a
/// limit is once.
FramePlan plan_together(std::span<const SystemTraits> traits, const Schedule& schedule,
                        const PassWishes& wishes);

/// From now on the system takes part; its data is on the device. Others see it.
void activate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system);

/// From now on it is black to others. A pass that it takes part in is given up.
void deactivate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system);

/// M + rho H of some clusters of a system changed by at most `change` (lm/m2); for the sky (its number is the
/// number of systems), the radiosity of its patches. 0 is no change.
void note_change(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                 double change);

/// A `change` for note_change: between two lightings of the clusters [first, first + count), when no
/// irradiance through form factors exceeds `largest_irradiance` (never more than the largest radiosity).
double lighting_change(const Lighting& before, const Lighting& after, std::size_t first, std::size_t count,
                       double largest_irradiance);

/// The largest q of active systems: not less than the spectral radius of rho K_c P.
double contraction_quotient(std::span<const SystemTraits> traits, const Schedule& schedule);

/// E of every system, 0 of those that are not active.
std::vector<double> radiosity_errors(const Schedule& schedule);

}  // namespace relume
