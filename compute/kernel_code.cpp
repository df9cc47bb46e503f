// SPDX-License-Identifier: MIT
#include "compute/kernel_code.h"

#include "spirv/bounce_row_per_8_lanes.h"
#include "spirv/bounce_row_per_thread.h"
#include "spirv/bounce_tile_shared.h"
#include "spirv/bounce_tile_shuffle.h"
#include "spirv/correct_rooms.h"
#include "spirv/direct_clusters.h"
#include "spirv/direct_gather.h"
#include "spirv/direct_sum.h"
#include "spirv/direct_trace.h"
#include "spirv/directions.h"
#include "spirv/gather_row_per_8_lanes.h"
#include "spirv/gather_row_per_thread.h"
#include "spirv/gather_tile_shared.h"
#include "spirv/gather_tile_shuffle.h"
#include "spirv/import_radiosity.h"
#include "spirv/lightmap_direction.h"
#include "spirv/lightmap_r11g11b10f.h"
#include "spirv/lightmap_rgb9e5.h"
#include "spirv/lightmap_rgba16f.h"
#include "spirv/materials.h"
#include "spirv/nodes.h"
#include "spirv/nodes_shuffle.h"
#include "spirv/probes.h"
#include "spirv/residual.h"
#include "spirv/restrict_rooms.h"
#include "spirv/screen.h"
#include "spirv/shadow_rays.h"
#include "spirv/solve_rooms.h"
#include "spirv/start.h"

namespace relume {

std::span<const std::uint32_t> kernel_code(KernelId kernel) {
  switch (kernel) {
    case KernelId::start:
      return start_spirv;
    case KernelId::import_radiosity:
      return import_radiosity_spirv;
    case KernelId::bounce_row_per_thread:
      return bounce_row_per_thread_spirv;
    case KernelId::bounce_row_per_8_lanes:
      return bounce_row_per_8_lanes_spirv;
    case KernelId::gather_row_per_thread:
      return gather_row_per_thread_spirv;
    case KernelId::gather_row_per_8_lanes:
      return gather_row_per_8_lanes_spirv;
    case KernelId::bounce_tile_shared:
      return bounce_tile_shared_spirv;
    case KernelId::gather_tile_shared:
      return gather_tile_shared_spirv;
    case KernelId::bounce_tile_shuffle:
      return bounce_tile_shuffle_spirv;
    case KernelId::gather_tile_shuffle:
      return gather_tile_shuffle_spirv;
    case KernelId::directions:
      return directions_spirv;
    case KernelId::nodes:
      return nodes_spirv;
    case KernelId::nodes_shuffle:
      return nodes_shuffle_spirv;
    case KernelId::probes:
      return probes_spirv;
    case KernelId::residual:
      return residual_spirv;
    case KernelId::lightmap_direction:
      return lightmap_direction_spirv;
    case KernelId::restrict_rooms:
      return restrict_rooms_spirv;
    case KernelId::solve_rooms:
      return solve_rooms_spirv;
    case KernelId::correct_rooms:
      return correct_rooms_spirv;
    case KernelId::lightmap_rgba16f:
      return lightmap_rgba16f_spirv;
    case KernelId::lightmap_r11g11b10f:
      return lightmap_r11g11b10f_spirv;
    case KernelId::lightmap_rgb9e5:
      return lightmap_rgb9e5_spirv;
    case KernelId::materials:
      return materials_spirv;
    case KernelId::screen:
      return screen_spirv;
    case KernelId::direct_trace:
      return direct_trace_spirv;
    case KernelId::direct_sum:
      return direct_sum_spirv;
    case KernelId::direct_clusters:
      return direct_clusters_spirv;
    case KernelId::direct_gather:
      return direct_gather_spirv;
    case KernelId::shadow_rays:
      return shadow_rays_spirv;
  }
  return {};
}

const char* kernel_file_name(KernelId kernel) {
  switch (kernel) {
    case KernelId::start:
      return "start";
    case KernelId::import_radiosity:
      return "import_radiosity";
    case KernelId::bounce_row_per_thread:
      return "bounce_row_per_thread";
    case KernelId::bounce_row_per_8_lanes:
      return "bounce_row_per_8_lanes";
    case KernelId::gather_row_per_thread:
      return "gather_row_per_thread";
    case KernelId::gather_row_per_8_lanes:
      return "gather_row_per_8_lanes";
    case KernelId::bounce_tile_shared:
      return "bounce_tile_shared";
    case KernelId::gather_tile_shared:
      return "gather_tile_shared";
    case KernelId::bounce_tile_shuffle:
      return "bounce_tile_shuffle";
    case KernelId::gather_tile_shuffle:
      return "gather_tile_shuffle";
    case KernelId::directions:
      return "directions";
    case KernelId::nodes:
      return "nodes";
    case KernelId::nodes_shuffle:
      return "nodes_shuffle";
    case KernelId::probes:
      return "probes";
    case KernelId::residual:
      return "residual";
    case KernelId::lightmap_direction:
      return "lightmap_direction";
    case KernelId::restrict_rooms:
      return "restrict_rooms";
    case KernelId::solve_rooms:
      return "solve_rooms";
    case KernelId::correct_rooms:
      return "correct_rooms";
    case KernelId::lightmap_rgba16f:
      return "lightmap_rgba16f";
    case KernelId::lightmap_r11g11b10f:
      return "lightmap_r11g11b10f";
    case KernelId::lightmap_rgb9e5:
      return "lightmap_rgb9e5";
    case KernelId::materials:
      return "materials";
    case KernelId::screen:
      return "screen";
    case KernelId::direct_trace:
      return "direct_trace";
    case KernelId::direct_sum:
      return "direct_sum";
    case KernelId::direct_clusters:
      return "direct_clusters";
    case KernelId::direct_gather:
      return "direct_gather";
    case KernelId::shadow_rays:
      return "shadow_rays";
  }
  return "";
}

}  // namespace relume
