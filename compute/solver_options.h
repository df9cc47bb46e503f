// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace relume {

/// How the rows of a matrix are spread over invocations. All give the same bits
/// (kernels/include/row_product.glsl). Blocks that are not in tiles of 8 rows are done by row_per_8_lanes
/// where a tile kernel was chosen.
enum class RowKernel : std::uint32_t {
  row_per_thread,
  row_per_8_lanes,
  tile_shared,   ///< 8 invocations do a tile of 8 rows and meet in shared memory
  tile_shuffle,  ///< the same, meeting by subgroup shuffles: see supports_row_kernel
};

inline constexpr RowKernel kRowKernels[] = {RowKernel::row_per_thread, RowKernel::row_per_8_lanes,
                                            RowKernel::tile_shared, RowKernel::tile_shuffle};

/// The name of the enumerator.
std::string_view row_kernel_name(RowKernel kernel);
std::optional<RowKernel> row_kernel_from_name(std::string_view name);

/// Where row products read matrices and radiosity from. All give the same bits.
enum class MatrixFetch : std::uint32_t {
  storage,  ///< storage buffers: every device can
  texels,   ///< uniform texel buffers of the same bytes: 2 to 3 times as fast on lavapipe 22.3
};

/// What a device may be fastest with: see KernelTrials.
struct RowKernelChoice {
  RowKernel kernel = RowKernel::tile_shared;
  MatrixFetch fetch = MatrixFetch::storage;
  friend bool operator==(const RowKernelChoice&, const RowKernelChoice&) = default;
};

/// Lightings that a solver does at once, at most.
inline constexpr std::uint32_t kMaxLightings = 4;

struct SolverOptions {
  /// Nothing: as default_tile_kernel (compute/row_kernels.h) says. KernelTrials finds the fastest.
  std::optional<RowKernel> kernel{};
  /// No dispatch has more, unless a single row has: about 10 ms on two cores of a processor. A form factor
  /// counts once for each lighting.
  std::uint64_t max_dispatch_form_factors = 4'000'000;
  /// Nothing: texels, for systems whose blocks fit texel buffers of the device (maxTexelBufferElements).
  std::optional<MatrixFetch> fetch{};
  /// Senders (clusters and nodes) of all systems that are loaded at a time; 0: as many as are loaded in the
  /// model of GpuSolver::create.
  std::uint32_t sender_capacity = 0;
  /// lm/m2. Above 0: products read what senders shine in half precision, rounded to nearest, which halves the
  /// memory that they read it from; the radiosity itself, which goes around, stays in single precision. No
  /// surface or sky patch may have more, what has counts as this; what is below 2^-28 of it is black. Each
  /// product is off by up to 2^-11 of itself, of which bounds of plans know nothing.
  double half_senders_up_to = 0.0;
  /// Of one model, 1 to kMaxLightings: see "Several lightings" in gpu_solver.h.
  std::uint32_t lightings = 1;
};

}  // namespace relume
