// SPDX-License-Identifier: MIT
#ifndef RELUME_KERNELS_LIMITS_H
#define RELUME_KERNELS_LIMITS_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

/// Invocations of a workgroup, in every kernel.
const uint kWorkgroupSize = 64u;

/// Partial sums of a row product; see include/row_product.glsl.
const uint kLanes = 8u;

/// Rows that a workgroup of a row_per_8_lanes kernel does.
const uint kRowsPerWorkgroup = kWorkgroupSize / kLanes;

/// Probes that a workgroup of the probes kernel does.
const uint kProbesPerWorkgroup = kWorkgroupSize / kLanes;

/// Rows of a tile that the tile kernels do; as many as lanes, so that each lane finishes one.
const uint kTileOfRows = 8u;

/// Nodes of so many leaves are summed leaf by leaf, larger ones from these (compute/node_tables.h).
const uint kSmallNode = 8u;

/// A dispatch of a tile kernel is so many sweeps over its rows (y), each of every kSweeps-th workgroup of
/// rows (x): a device that deals out workgroups in equal runs, as lavapipe does to its threads, so deals out
/// equal work, however lengths of rows change from one end to the other.
const uint kSweeps = 16u;

/// Lightings that a solver does at once: what a row kernel has registers for.
const uint kMaxLightings = 4u;

/// Rooms that have a correction: their equations fit the 16 KiB of shared memory that every device offers.
const uint kMaxRooms = 32u;

/// Pairs of sums of a system: of every room that sees, and every one that is seen or none.
const uint kRoomPairs = kMaxRooms * (kMaxRooms + 1u);

/// Every device offers at least this many workgroups along x.
const uint kMaxWorkgroups = 65535u;

RELUME_SHARED_END

#endif
