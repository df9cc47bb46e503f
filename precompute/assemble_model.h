// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/model.h"
#include "precompute/light_probes.h"
#include "precompute/number_senders.h"
#include "precompute/precompute.h"
#include "precompute/rows.h"
#include "precompute/system_tiles.h"

namespace relume {

/// Everything that a model is put together from.
struct ModelParts {
  const Scene& scene;
  const Geometry& geometry;
  const std::vector<Chart>& charts;
  const std::vector<AtlasLayout>& layouts;
  const std::vector<ClusteredSurface>& surfaces;
  const std::vector<std::vector<bool>>& own_elements;  ///< per system and element
  const std::vector<SystemRows>& rows;
  const SensorRows& sensors;
  const std::vector<std::uint32_t>& sensor_systems;               ///< per sensor: the one that it belongs to
  const std::vector<std::vector<std::uint32_t>>& element_orders;  ///< per system: as the model stores them
  const std::vector<SystemTiles>& tiles;  ///< per system; empty: rows are full, each a tile of its leaves
  const NodeFlux* flux = nullptr;         ///< of the nodes that tiles keep; without tiles there is none
  const ProbeRows& probes;
  const Emitters& emitters;
  const SenderTree& senders;
  std::uint32_t cluster_count = 0;
};

/// The model without lights, camera and provenance, values stored with `codec`.
/// Fails (usage) when a system sees more senders than columns can name.
Result<Model> assemble_model(const ModelParts& parts, ValueCodec codec, double max_albedo,
                             PrecomputeReport& report);

/// Elements of a system in the order that the model stores: by cluster, then by cell.
std::vector<std::uint32_t> stored_order(const ClusteredSurface& surface);

/// Per element of a system: whether it is the one whose value its lumel shows (the largest of its cell, of a
/// node that has a lightmap).
std::vector<bool> own_elements(const Scene& scene, const std::vector<Chart>& charts,
                               const SystemSurface& surface);

}  // namespace relume
