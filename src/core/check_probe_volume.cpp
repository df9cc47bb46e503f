// SPDX-License-Identifier: MIT
#include "core/model_checks.h"

namespace relume {
namespace {

Result<void> check_grid(const ProbeVolume& volume) {
  std::uint64_t roots = 1;
  for (const std::uint32_t count : volume.counts) {
    if (count == 0 || count > volume.nodes.size()) {
      return broken_model("probe volume: expected 1 to {} root cells along each axis, found {}",
                          volume.nodes.size(), count);
    }
    roots *= count;
  }
  if (roots > volume.nodes.size()) {
    return broken_model("probe volume: expected a node for each of {} root cells, found {}", roots,
                        volume.nodes.size());
  }
  const glm::vec3& edges = volume.edges;
  if (finite(volume.lower) && finite(edges) && edges.x > 0.0f && edges.y > 0.0f && edges.z > 0.0f) return {};
  return broken_model("probe volume: expected a finite corner and edges above 0, found {} x {} x {}", edges.x,
                      edges.y, edges.z);
}

/// Children lie further on than their parents and belong to one, so there is no way in circles.
Result<void> check_nodes(const ProbeVolume& volume) {
  std::uint64_t next = std::uint64_t{volume.counts[0]} * volume.counts[1] * volume.counts[2];
  std::vector<std::uint32_t> depths(volume.nodes.size(), 0);
  std::uint32_t next_cell = 0;
  for (std::size_t n = 0; n < volume.nodes.size(); ++n) {
    const std::uint32_t node = volume.nodes[n];
    if (node == kNoProbe) continue;
    if ((node & kProbeCellBit) != 0) {
      if ((node & ~kProbeCellBit) != next_cell++ || next_cell > volume.cells.size()) {
        return broken_model("probe volume, node {}: expected cell {} of {}, found {}", n, next_cell - 1,
                            volume.cells.size(), node & ~kProbeCellBit);
      }
      continue;
    }
    const std::uint32_t axis = node >> kProbeAxisShift, child = node & kProbeChildMask;
    if (axis > 2 || child != next || next + 2 > volume.nodes.size() || child <= n ||
        depths[n] == kMaxProbeDepth) {
      return broken_model(
          "probe volume, node {}: expected halves across axis 0 to 2 from {} on of {}, at most {} levels "
          "deep, "
          "found axis {}, {}",
          n, next, volume.nodes.size(), kMaxProbeDepth, axis, child);
    }
    depths[child] = depths[child + 1] = depths[n] + 1;
    next += 2;
  }
  if (next == volume.nodes.size() && next_cell == volume.cells.size()) return {};
  return broken_model("probe volume: expected {} nodes and {} cells, as its nodes say, found {} and {}", next,
                      next_cell, volume.nodes.size(), volume.cells.size());
}

Result<void> check_cells(const Model& model) {
  const ProbeVolume& volume = model.probe_volume;
  std::uint64_t next_plane = 0;
  for (std::size_t i = 0; i < volume.cells.size(); ++i) {
    const ProbeCell& cell = volume.cells[i];
    for (const std::uint32_t probe : cell.probes) {
      if (probe != kNoProbe && probe >= model.probe_names.size()) {
        return broken_model("probe cell {}: expected probes below {}, found {}", i, model.probe_names.size(),
                            probe);
      }
    }
    next_plane += cell.plane_count;
    if (cell.plane_count > kMaxCellPlanes ||
        cell.first_plane + std::uint64_t{cell.plane_count} != next_plane ||
        next_plane > volume.planes.size()) {
      return broken_model(
          "probe cell {}: expected at most {} planes that follow those before, of {}, found {} "
          "from {} on",
          i, kMaxCellPlanes, volume.planes.size(), cell.plane_count, cell.first_plane);
    }
    const std::uint32_t plane_bits = (1u << cell.plane_count) - 1u;
    for (const std::uint16_t sides : cell.sides) {
      const std::uint32_t positive = sides & 0xffu, negative = sides >> 8;
      if ((positive & ~plane_bits) == 0 && (negative & ~plane_bits) == 0) continue;
      return broken_model("probe cell {}: expected sides of its {} planes, found {:#x}", i, cell.plane_count,
                          sides);
    }
  }
  for (const glm::vec4& plane : volume.planes) {
    if (!finite(plane) || !unit(glm::vec3(plane)))
      return broken_model("probe volume: expected finite planes with normals of length 1");
  }
  if (next_plane == volume.planes.size()) return {};
  return broken_model("probe volume: expected {} planes, as its cells say, found {}", next_plane,
                      volume.planes.size());
}

}  // namespace

Result<void> check_probe_volume(const Model& model) {
  const ProbeVolume& volume = model.probe_volume;
  if (volume.nodes.empty()) {
    if (volume.cells.empty() && volume.planes.empty()) return {};
    return broken_model("probe volume: expected nodes, found cells or planes without them");
  }
  if (auto checked = check_grid(volume); !checked) return checked;
  if (auto checked = check_nodes(volume); !checked) return checked;
  return check_cells(model);
}

}  // namespace relume
