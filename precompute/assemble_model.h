// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/model.h"
#include "precompute/number_senders.h"
#include "precompute/precompute.h"
#include "precompute/rows.h"

namespace relume {

/// Everything that a model is put together from.
struct ModelParts {
  const Scene& scene;
  const Geometry& geometry;
  const std::vector<Chart>& charts;
  const std::vector<SystemLayout>& layouts;
  const std::vector<ClusteredSurface>& surfaces;
  const std::vector<std::vector<bool>>& own_elements;  ///< per system and element
  const std::vector<SystemRows>& rows;
  const std::vector<FormFactorRow>& sensor_rows;
  const std::vector<std::uint32_t>& sensor_systems;  ///< per sensor: the one that it belongs to
  const Emitters& emitters;
  const SenderTree& senders;
  std::uint32_t cluster_count = 0;
  std::uint32_t sky_resolution = 0;
};

/// The model without lights, camera and provenance.
/// Fails (usage) when a system sees more senders than columns can name.
Result<Model> assemble_model(const ModelParts& parts, const PrecomputeOptions& options,
                             PrecomputeReport& report);

/// Per element of a system: whether it is the one whose value its lumel shows (the largest of its cell, of a
/// node that has a lightmap).
std::vector<bool> own_elements(const Scene& scene, const std::vector<Chart>& charts,
                               const SystemSurface& surface);

}  // namespace relume
