// SPDX-License-Identifier: MIT
#pragma once

#include <string>
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

// A model is put together in steps. What each fills, no other touches, so that those without a word on order
// may run side by side.

/// Systems with their names and sizes, and cells of the sky: before all others.
void start_model(const ModelParts& parts, double max_albedo, Model& model);

/// Elements, clusters without colours, lumels, charts, materials, and occluders without their tree.
void store_surfaces(const ModelParts& parts, Model& model, PrecomputeReport& report);

/// Colours of clusters, after their surfaces.
void store_colors(const Scene& scene, double max_albedo, Model& model, std::vector<std::string>& warnings);

/// Where many lumels are invalid, the scene is not what its author thinks. After the surfaces.
void warn_of_invalid_lumels(const Model& model, std::vector<std::string>& warnings);

/// All rows, values stored with `codec`, with what their columns mean. Of the report, only warnings are
/// added. Fails (usage) when a system sees more senders than columns can name.
Result<void> store_rows(const ModelParts& parts, ValueCodec codec, Model& model, PrecomputeReport& report);

/// Elements of a system in the order that the model stores: by cluster, then by cell.
std::vector<std::uint32_t> stored_order(const ClusteredSurface& surface);

/// Per element of a system: whether it is the one whose value its lumel shows (the largest of its cell, of a
/// node that has a lightmap).
std::vector<bool> own_elements(const Scene& scene, const std::vector<Chart>& charts,
                               const SystemSurface& surface);

}  // namespace relume
