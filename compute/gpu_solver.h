// SPDX-License-Identifier: MIT
//
// The solve on a device that somebody else owns: B = M + rho (H + K b), I = G b (core/solve.h).
//
// The life of a solver: create; the host provides buffers() and binds them; record_upload of model_data, then
// of lighting_data; record_start; then record_bounces, record_residual and record_gather in any number.
//
// A record function only appends copies, dispatches and barriers to a command buffer in recording state
// (outside a render pass, for a queue that can compute). It never submits, waits or allocates, and the solver
// remembers nothing of it, so a command buffer may be dropped, or submitted again. Record functions may be
// called from several threads at once for different command buffers.
//
// Synchronisation: inside a record function, and between record functions that run one after another on one
// queue, the barriers are the solver's. At the border to everything else, begin -> end:
//
//   record_upload    TRANSFER write -> TRANSFER write, of the buffers that the data names
//   record_start     COMPUTE_SHADER read -> COMPUTE_SHADER write of both radiosities
//   record_bounces   COMPUTE_SHADER read -> COMPUTE_SHADER write of radiosity and local radiosity
//   record_gather    COMPUTE_SHADER read -> COMPUTE_SHADER write of irradiance and local radiosity
//   record_residual  TRANSFER write -> COMPUTE_SHADER write of the residual
//
// The ends are made visible to COMPUTE_SHADER and to TRANSFER reads, so that a host copies results out
// without a barrier of its own; for any other stage it adds one, and one after reads of its own before the
// solver writes again. Left behind: the bound compute pipeline, descriptor sets 0 to 2 and push constants [0,
// 16) of the compute bind point.
//
// What it does not do: own memory, queues or command buffers; compile kernels at run time; choose a device
// (compute/standalone does).
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "compute/host_device.h"
#include "compute/upload.h"
#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// How the rows of a matrix are spread over invocations. All give the same bits
/// (kernels/include/row_product.glsl).
enum class RowKernel : std::uint32_t { row_per_thread, row_per_8_lanes };

/// "row_per_thread", "row_per_8_lanes".
std::string_view row_kernel_name(RowKernel kernel);
std::optional<RowKernel> row_kernel_from_name(std::string_view name);

/// Where row products read matrices and radiosity from. All give the same bits.
enum class MatrixFetch : std::uint32_t {
  storage,  ///< storage buffers: every device can
  texels,   ///< uniform texel buffers of the same bytes: 2.5 times as fast on lavapipe 22.3
};

struct SolverOptions {
  RowKernel kernel = RowKernel::row_per_8_lanes;
  /// No dispatch has more, unless a single row has: about 10 ms on two cores of a processor.
  std::uint64_t max_dispatch_form_factors = 4'000'000;
  /// Nothing: texels, if texel buffers of the device are large enough (maxTexelBufferElements).
  std::optional<MatrixFetch> fetch{};
};

/// Radiosity lives in two halves: a bounce reads one and writes the other.
enum class RadiosityHalf : std::uint32_t { a, b };

inline RadiosityHalf other_half(RadiosityHalf half) {
  return half == RadiosityHalf::a ? RadiosityHalf::b : RadiosityHalf::a;
}

/// How far a bounce or gather got, in dispatches. A value of the host's.
struct PassCursor {
  std::uint32_t next_dispatch = 0;
};

/// What a part of a bounce or gather came to.
struct PassPart {
  bool complete = false;   ///< the pass has no more parts
  std::uint64_t cost = 0;  ///< form factors recorded
};

/// What the last bounce changed, as maxima over all clusters, per channel.
struct Residual {
  Rgb weighted_change{0.0};     ///< |change| / weight: see ContractionBound
  Rgb change{0.0};              ///< lm/m2
  Rgb weighted_radiosity{0.0};  ///< |B| / weight, B after the bounce
  Rgb radiosity{0.0};           ///< |B|, lm/m2
};

/// Reads the bytes of GpuSolver::residual().
Residual read_residual(std::span<const std::byte> bytes);

/// Gives the host's memory for one buffer; the offset must keep its alignment. The host frees it after the
/// solver is gone.
using BufferAllocator = std::function<Result<BufferRange>(const BufferRequirement&)>;

struct SolverState;

class GpuSolver {
 public:
  /// Compiles the pipelines that the model needs. The model must be valid (check_model); it is read, not
  /// kept. Fails with no_device when the device does not meet device_requirements or cannot bind a buffer of
  /// this size.
  static Result<GpuSolver> create(const HostDevice& host, const Model& model, const SolverOptions& options);

  GpuSolver(GpuSolver&&) noexcept;
  GpuSolver& operator=(GpuSolver&&) noexcept;
  /// No command buffer of the solver may be running.
  ~GpuSolver();

  /// What the host has to provide. Valid as long as the solver. Device-local memory is best for all of it.
  std::span<const BufferRequirement> buffers() const;

  /// Hands over one range per entry of buffers(), in that order. To be called once, before anything is
  /// recorded; the buffers must outlive the solver.
  Result<void> bind(std::span<const BufferRange> ranges);

  /// The same, asking for one buffer after the other.
  Result<void> bind(const BufferAllocator& allocate);

  /// Matrices and import tables. Refers to `model`, which must be the one of create and outlive the data.
  UploadData model_data(const Model& model) const;

  /// Albedo, exitance, direct irradiance, sky and the weights of a contraction bound (empty: all 1). Refers
  /// to nothing. `lighting` must be valid (check_lighting).
  UploadData lighting_data(const Lighting& lighting, const std::vector<Rgb>& weights) const;

  /// Radiosity of all clusters (lm/m2) into one half, to bounce on from. Refers to nothing.
  UploadData radiosity_data(const std::vector<Rgb>& radiosity, RadiosityHalf half) const;

  /// Copies as much of `data` as the staging memory (not empty) holds, from `cursor`, which moves on. True
  /// when all of it is recorded.
  bool record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                     UploadCursor& cursor) const;

  /// B0 = M + rho H. Returns the half that holds it (both do).
  RadiosityHalf record_start(VkCommandBuffer commands) const;

  /// `count` bounces from the radiosity in `from`. Returns the half that the last one wrote.
  RadiosityHalf record_bounces(VkCommandBuffer commands, std::uint32_t count, RadiosityHalf from) const;

  /// The part of one bounce that starts at `cursor`, which moves on, and has at most `max_cost` form factors,
  /// but at least one dispatch. The half that the bounce writes holds nothing of use until it is complete.
  PassPart record_bounce_part(VkCommandBuffer commands, RadiosityHalf from, PassCursor& cursor,
                              std::uint64_t max_cost) const;

  /// Irradiance of all gather rows from the radiosity in `from`.
  void record_gather(VkCommandBuffer commands, RadiosityHalf from) const;

  /// The part of a gather, as record_bounce_part.
  PassPart record_gather_part(VkCommandBuffer commands, RadiosityHalf from, PassCursor& cursor,
                              std::uint64_t max_cost) const;

  /// What the bounce that wrote `last` changed; the other half must still hold what it read.
  void record_residual(VkCommandBuffer commands, RadiosityHalf last) const;

  /// Form factors of one bounce (imports counted too).
  std::uint64_t bounce_cost() const;

  /// Where results are, as four floats per cluster of all systems (lm/m2, the last is 0), ...
  BufferRange radiosity(RadiosityHalf half) const;
  /// ... as four floats per gather row of a system (lumels, then sensors; lm/m2), ...
  BufferRange irradiance(std::uint32_t system) const;
  /// H, four floats per cluster of all systems (lm/m2), for who computes it on the device.
  BufferRange direct_irradiance() const;
  /// ... and as bytes for read_residual.
  BufferRange residual() const;

 private:
  explicit GpuSolver(std::unique_ptr<SolverState> state);
  std::unique_ptr<SolverState> state_;
};

}  // namespace relume
