// SPDX-License-Identifier: MIT
//
// Which dispatches go into the next frame, as values: no Vulkan, no hidden state.
//
// The host holds a Schedule. For each frame it makes a FramePlan from it, records the plan, and, if it really
// submits what was recorded, goes on with FramePlan::next; a command buffer that is dropped is as if its plan
// had never been made.
//
// A *pass* does for some systems together: bounces, then the gather of their outputs. Bounces of systems may
// follow each other in any order (D. Chazan and W. Miranker, Chaotic relaxation, 1969): each reads the latest
// complete radiosity of the others. What is left to do is known without looking at the device, as bounds in
// lm/m2 of the worst channel. For a system T, C_TS is the largest share that one of its clusters reflects of
// system S (max over i in T of the sum over j in S of rho_i K_ij), and q_T the largest of all systems
// together. With d_TS: how much S changed since T last imported it, and m_T: how much M + rho H changed in T
// since then,
//
//   p_T = m_T + min(sum_S C_TS d_TS, q_T max_S d_TS)   bounds what one more bounce would change in T,
//   e   = p + C e, or max p / (1 - max q)              bounds max |B - B_exact|, whichever is less:
//
// the bound of core/solve.h with weights of 1. A bounce of T that took in p_T then adds it to d_ST of all S.
// Slow drifts add up, so none is lost.
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

/// What a plan needs to know of a system that is loaded.
struct SystemTraits {
  bool loaded = false;
  std::vector<std::uint64_t> costs[kStepKernels];  ///< of its dispatches, per StepKernel
  CouplingRow bounce;                              ///< row of C, and q
  CouplingRow gather;                              ///< the same of G: no albedo
};

/// Costs and couplings of a system that is loaded in `model`. `albedo` per cluster: what it will be at most;
/// empty: as stored.
SystemTraits system_traits(const Model& model, std::uint32_t system, const SystemDispatches& dispatches,
                           std::span<const Rgb> albedo = {});

/// What changed of what a system depends on, since it last looked.
struct Exposure {
  double own = 0.0;          ///< of its own M + rho H, and of the sky
  std::vector<double> seen;  ///< of each system: d
};

/// own + the lesser of the two bounds on what of `seen` arrives.
double exposure_bound(const CouplingRow& row, const Exposure& exposure);

/// What is known of a system between two frames. Bounds in lm/m2.
struct SystemProgress {
  bool active = false;
  bool started = false;    ///< its radiosity holds something
  std::uint32_t half = 0;  ///< of its radiosity: the one that counts
  Exposure pending;        ///< since it last imported for a bounce
  double taken = 0.0;      ///< p, by a bounce that is not complete
  Exposure stale;          ///< since its outputs began to be gathered
  double gathering = 0.0;  ///< of that, by a gather that is not complete
};

enum class PassStage : std::uint32_t {
  start,
  start_nodes,
  import,
  bounce,
  nodes,
  residual,
  gather_import,
  gather,
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
  bool residual = false;
  GatherRule gather = GatherRule::never;  ///< when_stale: by more than half of the display step
};

struct Schedule {
  std::vector<SystemProgress> systems;
  PassProgress pass;
};

/// All systems inactive.
Schedule make_schedule(std::size_t systems);

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
  std::uint64_t cost = 0;      ///< form factors
  bool pass_complete = false;  ///< no pass is left half done
  double radiosity_error =
      0.0;  ///< bound after this frame, lm/m2, the worst system; infinite when q is not below 1
  double output_error = 0.0;  ///< the same of what is published
  double skipped = 0.0;       ///< of output_error, at most, by leaving out what is below the display step
};

inline constexpr std::uint32_t kInactive = 2;

/// The next frame.
FramePlan plan_frame(std::span<const SystemTraits> traits, const Schedule& schedule,
                     const FrameWishes& wishes);

/// What plan_together does.
struct PassWishes {
  bool restart = false;            ///< first B = M + rho H
  double largest_radiosity = 0.0;  ///< of any surface: what a restart changes at most
  std::uint32_t bounces = 0;
  bool residual = false;  ///< what the last bounce changed
  bool gather = false;
  std::uint64_t max_form_factors = ~std::uint64_t{0};
};

/// Exactly this for all active systems in step: the k-th bounce of each reads what the (k-1)-th of all wrote.
/// When it does not fit (FramePlan::pass_complete is false), planning on from `next` with any wishes but a
/// new limit continues it.
FramePlan plan_together(std::span<const SystemTraits> traits, const Schedule& schedule,
                        const PassWishes& wishes);

/// From now on the system takes part; its data is on the device. Others see it. `largest_radiosity`, of any
/// surface (lm/m2), bounds what that changes.
void activate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
              double largest_radiosity);

/// From now on it is black to others. A pass that it takes part in is given up.
void deactivate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                double largest_radiosity);

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

/// The radiosity of a system that counts changed by at most `change`: what a flip brings to those that see
/// it.
void note_radiosity_change(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                           double change);

/// e of every system: bounds on its distance to the solution, infinite when q is not below 1.
std::vector<double> radiosity_errors(std::span<const SystemTraits> traits, const Schedule& schedule);

/// The same of the irradiance that was published last.
std::vector<double> output_errors(std::span<const SystemTraits> traits, const Schedule& schedule);

}  // namespace relume
