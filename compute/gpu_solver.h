// SPDX-License-Identifier: MIT
//
// The solve on a device that somebody else owns: B = M + rho (H + K b), I = G b (core/solve.h).
//
// The life of a solver: create; the host provides buffers() and binds them; record_upload of model_data(). Of
// a system: load, record_upload of system_data(), activate() it in the host's schedule. Then, every frame:
//
//   FramePlan plan = solver.plan(schedule, {.max_form_factors = 8'000'000, .bounces = 1});
//   solver.record_frame(commands, {.plan = &plan, .copies = what_changed}, {.publish = draw_lightmap});
//   if (submit(commands)) schedule = std::move(plan.next);
//
// record_frame only appends copies, dispatches and barriers to a command buffer in recording state (outside a
// render pass, for a queue that can compute and knows 32-bit storage buffers). It never blocks, allocates,
// submits or reads back, and the solver remembers nothing of it: all progress is in the schedule. A command
// buffer that is dropped has done nothing, one that is submitted must be submitted once, in the order of the
// plans. What the host asked a dropped one to copy, it copies again.
//
// A frame, in this order: copies of what changed; nodes of the sky; `write_direct`, the host's own direct
// light; the plan's bounces and gathers, those of light probes among them, from the radiosity that the last
// frame left; per system whose outputs are complete, copies of its irradiance, then `publish`; the report.
//
// Frames in flight: any number. Everything on the device is shared by them and ordered by barriers, so they
// must go to one queue (or the host orders queues by semaphores). What belongs to a frame alone is what the
// host gives it: sources of copies, staging memory and the report, not to be touched until its fence.
//
// Ownership by queue families: barriers here are global memory barriers, which move nothing between families.
// Buffers that the host creates with VK_SHARING_MODE_EXCLUSIVE must belong to the family of the command
// buffers; a host that uploads on another family, or reads results there, records release and acquire itself.
//
// Synchronisation: inside a record function, and between record functions that run one after another on one
// queue, the barriers are the solver's. At the border to everything else, begin -> end:
//
//   record_upload    TRANSFER write -> TRANSFER write, of the buffers that the data names
//   record_frame     TRANSFER read of the sources of copies, TRANSFER write of inputs
//                    -> COMPUTE_SHADER write of radiosity, irradiance, probes and residuals, TRANSFER write
//                    of targets and report
//
// Both begin with a barrier after, and end with one before, all COMPUTE_SHADER and TRANSFER work on the
// queue, so that a host that reads results in these stages, or writes inputs in them before, needs none of
// its own; for any other stage it adds one. Left behind: the bound compute pipeline, descriptor sets 0 to 2
// and push constants [0, 16) of the compute bind point.
//
// Threads: plan and the record functions may be called from several threads at once for different command
// buffers; create, bind, load and unload change the solver, and the host keeps them apart from all else.
//
// Failure: recording cannot fail on the device. When load runs out of memory, the solver is as it was. When a
// device is lost, the first error stays: every further call gives it back. The host destroys the solver,
// makes a device, and loads the same file into a new one, which gives equal results.
//
// Several lightings (SolverOptions::lightings) of one model, as unit responses of lights for a LightCache,
// times of the day, before and after an edit: each has exitance, direct light, sky, radiosity, irradiance,
// probes and residuals of its own, which a number below `lightings` names (0 where none is named); albedo and
// weights are of all. A bounce or a gather takes all of them forward, in as many dispatches as for one, and
// reads the matrix once for all; each gets the bits that it would get alone. There is one schedule: its
// bounds hold for the worst of them, so that note_change takes the largest change of any, and
// Schedule::largest_radiosity the largest of all. A form factor counts once for each lighting. MaterialPass,
// ScreenPass, DirectLight and LightmapPass are each bound to one lighting.
//
// What it does not do: own memory, queues or command buffers; compile kernels at run time; choose a device
// (compute/standalone does).
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "compute/host_device.h"
#include "compute/schedule.h"
#include "compute/solver_options.h"
#include "compute/upload.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

class LightmapPass;
class MaterialPass;
class ScreenPass;
struct RoomTables;

/// What the last bounce of a system changed, as maxima over its clusters, per channel.
struct Residual {
  Rgb weighted_change{0.0};     ///< |change| / weight: see ContractionBound
  Rgb change{0.0};              ///< lm/m2
  Rgb weighted_radiosity{0.0};  ///< |B| / weight, B after the bounce
  Rgb radiosity{0.0};           ///< |B|, lm/m2
};

/// Reads the bytes of GpuSolver::residuals(): one per system, loaded or not; of several lightings one after
/// the other.
std::vector<Residual> read_residuals(std::span<const std::byte> bytes);

/// Gives the host's memory for one buffer; the offset must keep its alignment. The host frees it after the
/// solver, or the system that it is for, is gone.
using BufferAllocator = std::function<Result<BufferRange>(const BufferRequirement&)>;

/// What changes at run time, as four floats per element (the last is ignored).
enum class Quantity : std::uint32_t {
  albedo,    ///< per cluster of a system
  exitance,  ///< per cluster, lm/m2
  direct,    ///< H per cluster, lm/m2
  weights,   ///< v of a contraction bound per cluster, > 0 (only the residual reads it)
  sky,       ///< per sky patch, lm/m2 (pi x radiance); its system is the number of systems
};

/// A copy from memory of the host (usage TRANSFER_SRC), or of a kernel of the host.
struct InputCopy {
  Quantity quantity = Quantity::direct;
  std::uint32_t system = 0;
  std::uint32_t first = 0;  ///< cluster or patch
  BufferRange source;       ///< 16 bytes an element; may be input() of another lighting
  std::uint32_t lighting = 0;
};

/// A copy of a system's irradiance (GpuSolver::irradiance) into memory of the host (usage TRANSFER_DST), in
/// frames that complete it.
struct IrradianceTarget {
  std::uint32_t system = 0;
  BufferRange target;  ///< 16 bytes per gather row, from row 0
  std::uint32_t lighting = 0;
};

/// Commands of the host, or of a pass of its own, for one system, in the middle of a frame: compute and
/// transfer, between barriers as at the border of record_frame.
using SystemRecorder = std::function<void(VkCommandBuffer, std::uint32_t system)>;

/// An image that a screen shows from this frame on (compute/screen_pass.h).
struct ScreenFrame {
  const ScreenPass* pass = nullptr;  ///< bound to input(system, albedo) and (system, exitance)
  std::uint32_t image = 0;
  Rgb factor{1.0};
};

/// A lightmap that is written when its system is complete.
struct LightmapOutput {
  std::uint32_t system = 0;
  const LightmapPass* pass = nullptr;  ///< bound to irradiance(system), or to its directions as well
};

struct FrameInputs {
  const FramePlan* plan = nullptr;
  std::span<const InputCopy> copies{};
  std::span<const MaterialPass* const> materials{};  ///< of systems whose states changed
  std::span<const ScreenFrame> screens{};
  /// For each active system: writes what input() gives. So does DirectLight::record (compute/direct_light.h)
  /// of an object of that system alone, whose kClusterLight is input(system, direct); before the plan is made
  /// then goes note_change of LightSchedule::pending_change.
  SystemRecorder write_inputs{};
};

struct FrameOutputs {
  std::span<const LightmapOutput> lightmaps{};
  std::span<const IrradianceTarget> irradiance{};
  SystemRecorder publish{};  ///< for each system whose irradiance is complete: writes images from it
  BufferRange report{};      ///< gets residuals(), when it has a buffer (usage TRANSFER_DST)
};

struct SolverState;

class GpuSolver {
 public:
  /// For models with this one's numbers of systems, sky and nodes above the systems: all models that
  /// read_systems gives of one file. The model must be valid (check_model); it is read, not kept. Fails with
  /// no_device when the device does not meet device_requirements or cannot bind a buffer of this size.
  static Result<GpuSolver> create(const HostDevice& host, const Model& model, const SolverOptions& options);

  GpuSolver(GpuSolver&&) noexcept;
  GpuSolver& operator=(GpuSolver&&) noexcept;
  /// No command buffer of the solver may be running.
  ~GpuSolver();

  /// What the host has to provide for the whole solve. Valid as long as the solver. Device-local memory is
  /// best for all of it.
  std::span<const BufferRequirement> buffers() const;

  /// Hands over one range per entry of buffers(), in that order. To be called once, before all else; the
  /// buffers must outlive the solver.
  Result<void> bind(std::span<const BufferRange> ranges);
  /// The same, asking for one buffer after the other.
  Result<void> bind(const BufferAllocator& allocate);

  /// What system `system`, which is loaded in `model`, needs. Fails as load.
  Result<std::vector<BufferRequirement>> system_buffers(const Model& model, std::uint32_t system) const;

  /// Makes pipelines and descriptor sets of a system with one range per entry of system_buffers(). Frames in
  /// flight do not matter. Fails with usage when it is loaded, with out_of_memory when more senders than
  /// SolverOptions::sender_capacity are. `albedo`: see system_traits.
  Result<void> load(const Model& model, std::uint32_t system, std::span<const BufferRange> ranges,
                    std::span<const Rgb> albedo = {});
  Result<void> load(const Model& model, std::uint32_t system, const BufferAllocator& allocate,
                    std::span<const Rgb> albedo = {});

  /// Lets go of a system and its ranges. It must be inactive in the schedule, and the fences of all frames
  /// whose plans had it active must have signalled; frames of others may be in flight.
  void unload(std::uint32_t system);

  bool loaded(std::uint32_t system) const;

  /// The level above the bounces, for PassWishes::correct (core/methods/room_correction.h): one range per
  /// entry of room_buffers(tables, lightings), the upload of room_data. For all systems that are loaded;
  /// unload lets go of it. Albedo is read when a frame runs, so that a change of it needs nothing. Fails with
  /// usage when `tables` are of other systems.
  Result<void> bind_rooms(const RoomTables& tables, std::span<const BufferRange> ranges);

  /// Once rooms are bound to these tables. Refers to nothing.
  UploadData room_data(const RoomTables& tables) const;

  /// What plans need to know of each system.
  std::span<const SystemTraits> traits() const;

  /// The next frame of the host's schedule: plan_frame and plan_together with traits().
  FramePlan plan(const Schedule& schedule, const FrameWishes& wishes) const;
  FramePlan plan(const Schedule& schedule, const PassWishes& wishes) const;

  /// What belongs to no system; the sky is black.
  UploadData model_data(const Model& model) const;

  /// Matrices, tables, and the lighting that is stored; no direct light. Refers to `model`, which must be the
  /// one of load and outlive the data.
  UploadData system_data(const Model& model, std::uint32_t system) const;

  /// Values of a quantity from its first element on, for record_upload. Refers to nothing.
  UploadData input_data(std::uint32_t system, Quantity quantity, std::span<const Rgb> values,
                        std::uint32_t lighting = 0) const;

  /// Radiosity of the clusters of a system (lm/m2) into one half, to bounce on from. Refers to nothing.
  UploadData radiosity_data(std::uint32_t system, std::uint32_t half, std::span<const Rgb> radiosity,
                            std::uint32_t lighting = 0) const;

  /// Copies as much of `data` as the staging memory (not empty) holds, from `cursor`, which moves on. True
  /// when all of it is recorded. For loading; what changes in frames goes through FrameInputs.
  bool record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                     UploadCursor& cursor) const;

  /// The frame of a plan. Fails, with nothing recorded, with usage when the inputs name what is not there,
  /// and with the error that the device was lost by.
  Result<void> record_frame(VkCommandBuffer commands, const FrameInputs& inputs,
                            const FrameOutputs& outputs) const;

  /// For a host that learns of a lost device first. The first error stays.
  void latch(const Error& error);

  /// Where inputs are, for kernels of the host that write them, ... (A lighting that is not there: all
  /// empty.)
  BufferRange input(std::uint32_t system, Quantity quantity, std::uint32_t lighting = 0) const;
  /// ... and results: four floats per cluster of a system (lm/m2, the last is 0) in the half that the
  /// schedule says, ...
  BufferRange radiosity(std::uint32_t system, std::uint32_t half, std::uint32_t lighting = 0) const;
  /// ... four floats per gather row (lumels, then sensors; lm/m2), whole when the system was published and
  /// until its next gather begins, ...
  BufferRange irradiance(std::uint32_t system, std::uint32_t lighting = 0) const;
  /// ... likewise three times four floats per gather row, moments of its irradiance along x, y and z
  /// (core/directional_irradiance.h; lm/m2): empty where the gather matrix has no directions, ...
  BufferRange directional_irradiance(std::uint32_t system, std::uint32_t lighting = 0) const;
  /// ... likewise nine times four floats per light probe of all systems (Probe::name), in the order of
  /// Harmonics (core/probe_coefficients.h; cd/m2 sr^1/2, the last of four is 0): empty without probes. Those
  /// of a system that was never published are 0, as model_data() left them, ...
  BufferRange probe_coefficients(std::uint32_t lighting = 0) const;
  /// ... and bytes for read_residuals.
  BufferRange residuals() const;

 private:
  explicit GpuSolver(std::unique_ptr<SolverState> state);
  std::unique_ptr<SolverState> state_;
};

}  // namespace relume
