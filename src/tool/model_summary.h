// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/model.h"
#include "tool/json_value.h"

namespace relume {

/// "1 sky patch", "2 sky patches".
std::string counted(std::uint64_t count, std::string_view noun);

/// The size of a model; matrices of all systems together.
struct ModelSummary {
  std::uint64_t geometry_hash = 0;
  std::uint64_t clusters = 0;
  std::uint64_t lumels = 0;
  std::uint64_t invalid_lumels = 0;
  std::uint64_t sensors = 0;
  std::uint64_t probes = 0;
  std::uint64_t probe_entries = 0;  ///< of their lists of senders
  std::uint64_t probe_cells = 0;    ///< between them
  std::uint64_t sky_patches = 0;
  std::uint64_t tree_nodes = 0;      ///< of all systems, of the sky, and above the systems
  std::uint64_t spanning_nodes = 0;  ///< those above the systems
  std::uint64_t imports = 0;         ///< of all systems
  std::string options;               ///< what the precompute was asked for: a JSON object
  std::uint64_t occluder_triangles = 0;
  double area = 0.0;  ///< m2, of all clusters
  MatrixSummary bounce;
  MatrixSummary gather;
  std::vector<JsonObject>
      systems;  ///< name, clusters, lumels, sensors, imports, lightmap size, bytes of each
  bool lit_by_rig = false;
};

ModelSummary summarise_model(const Model& model);

/// For people.
std::vector<std::string> summary_lines(const ModelSummary& summary);

/// One line for each system, where there are several.
std::vector<std::string> system_lines(const Model& model);

/// The members that `info --json` promises: systems, clusters, lumels, sensors, probes, sky_patches, bounce,
/// gather, file_bytes, geometry_hash.
JsonObject summary_json(const ModelSummary& summary, std::uint64_t file_bytes);

/// One sentence on the light that the precompute put into a scene that shines with nothing.
std::string rig_sentence(const Model& model);

}  // namespace relume
