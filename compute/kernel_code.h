// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace relume {

/// Every file kernels/*.comp.
enum class KernelId : std::uint32_t {
  start,
  import_radiosity,
  bounce_row_per_thread,
  bounce_row_per_8_lanes,
  gather_row_per_thread,
  gather_row_per_8_lanes,
  bounce_tile_shared,
  gather_tile_shared,
  bounce_tile_shuffle,
  gather_tile_shuffle,
  directions,
  small_nodes,
  nodes,
  nodes_shuffle,
  probes,
  residual,
  lightmap_direction,
  restrict_rooms,
  solve_rooms,
  correct_rooms,
  combine_lights,
  lightmap_rgba16f,
  lightmap_r11g11b10f,
  lightmap_rgb9e5,
  materials,
  screen,
  direct_trace,
  direct_sum,
  direct_clusters,
  direct_gather,
  shadow_rays,
};

/// The SPIR-V of a kernel, embedded when the library was built. Valid for ever.
std::span<const std::uint32_t> kernel_code(KernelId kernel);

/// Its name: the file in kernels/ without ".comp".
const char* kernel_file_name(KernelId kernel);

}  // namespace relume
