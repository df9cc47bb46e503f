// SPDX-License-Identifier: MIT
#include "compute/solver_data.h"

#include <bit>
#include <utility>

#include "compute/node_tables.h"
#include "compute/pass_buffers.h"
#include "kernels/shared/glsl_types.h"

namespace relume {
namespace {

static_assert(sizeof(kernels::vec4) == kRgbBytes);
static_assert(sizeof(ProbeSender) == kernels::kProbeSenderUints * sizeof(kernels::uint));

template <class Element>
std::span<const std::byte> bytes_of(const std::vector<Element>& elements) {
  return std::as_bytes(std::span(elements));
}

void add_blocks(UploadData& data, const BlockMatrix& matrix, const std::vector<BlockLayout>& layouts) {
  for (std::size_t i = 0; i < matrix.blocks.size(); ++i) {
    const MatrixBlock& block = matrix.blocks[i];
    const auto add = [&](std::uint32_t binding, std::span<const std::byte> bytes, VkDeviceSize behind = 0) {
      data.pieces.push_back({layouts[i].buffer, layouts[i].sections[binding].offset + behind, bytes});
    };
    add(kernels::kTileOffsetsBinding, bytes_of(block.tile_offsets));
    add(kernels::kColumnsBinding, bytes_of(block.columns));
    add(kernels::kValuesBinding, bytes_of(block.values));
    add(kernels::kRowScalesBinding, bytes_of(block.row_scales));
    if (!block.directions.empty())
      add(kernels::kRowScalesBinding, bytes_of(block.directions), block.row_scales.size() * sizeof(float));
  }
}

void add_nodes(UploadData& data, std::uint32_t records, std::uint32_t parts, const ClusterTreeNodes& tree,
               std::size_t leaves) {
  const NodeTables tables = node_tables(tree, static_cast<std::uint32_t>(leaves));
  data.add_owned(records, 0, owned_bytes(tables.records));
  data.add_owned(parts, 0, owned_bytes(tables.parts));
}

/// A record per import, then the other parts of nodes above the systems (kernels/shared/bindings.h).
std::vector<kernels::uvec4> import_records(const Model& model, const System& system) {
  constexpr auto kWhole = std::bit_cast<kernels::uint>(1.0f);
  const auto sky = static_cast<kernels::uint>(model.systems.size());
  std::vector<kernels::uvec4> records, parts;
  for (const SenderRef& sender : system.imports) {
    if (sender.system != kSpanningNodes) {
      records.push_back({sender.system == kSkySystem ? sky : sender.system, sender.index, kWhole, 0});
      continue;
    }
    const SpanningNode& node = model.top_tree[sender.index];
    for (std::uint32_t k = 0; k < node.part_count; ++k) {
      const SpannedPart& part = model.top_parts[node.first_part + k];
      const auto next = static_cast<kernels::uint>(system.imports.size() + parts.size()) + (k > 0 ? 1 : 0);
      (k > 0 ? parts : records)
          .push_back({part.sender.system, part.sender.index, std::bit_cast<kernels::uint>(part.share),
                      k + 1 < node.part_count ? next : 0});
    }
  }
  records.insert(records.end(), parts.begin(), parts.end());
  return records;
}

void add_stored_lighting(UploadData& data, const System& system, const SystemLayout& layout) {
  std::vector<Rgb> albedo, exitance;
  for (const Cluster& cluster : system.clusters) {
    albedo.emplace_back(cluster.albedo[0], cluster.albedo[1], cluster.albedo[2]);
    exitance.emplace_back(cluster.exitance[0], cluster.exitance[1], cluster.exitance[2]);
  }
  data.add_owned(kAlbedo, 0, rgb_bytes(albedo));
  for (std::uint32_t lighting = 0; lighting < layout.lightings; ++lighting) {
    const VkDeviceSize offset = lighting * layout.clusters_plane.step;
    data.add_owned(kExitance, offset, rgb_bytes(exitance));
    data.add_owned(kDirect, offset, rgb_bytes(std::vector<Rgb>(albedo.size(), Rgb(0.0))));
  }
  data.add_owned(kWeights, 0, rgb_bytes(std::vector<Rgb>(albedo.size(), Rgb(1.0))));
}

void add_probes(UploadData& data, const System& system, const ProbeBlockLayout& block) {
  std::vector<kernels::uint> lists;
  for (const Probe& probe : std::span(system.probes).subspan(block.first_probe, block.probe_count)) {
    const kernels::uint first = probe.first_sender - block.first_sender;
    lists.insert(lists.end(), {first, first + probe.sender_count, probe.name});
  }
  data.add_owned(block.first_buffer + kProbeLists, 0, owned_bytes(lists));
  const auto senders = std::span(system.probe_senders).subspan(block.first_sender, block.sender_count);
  data.pieces.push_back({block.first_buffer + kProbeSenders, 0, std::as_bytes(senders)});
}

}  // namespace

std::vector<std::byte> rgb_bytes(std::span<const Rgb> values) {
  std::vector<kernels::vec4> converted;
  converted.reserve(values.size());
  for (const Rgb& value : values) {
    converted.push_back(
        {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z), 0.0f});
  }
  return owned_bytes(converted);
}

UploadData model_upload(const Model& model, const SolverLayout& layout) {
  UploadData data;
  for (std::uint32_t lighting = 0; lighting < layout.lightings; ++lighting)
    data.add_owned(kRadiosity, lighting * layout.radiosity_plane.step,
                   rgb_bytes(std::vector<Rgb>(model.sky_cells.size(), Rgb(0.0))));
  add_nodes(data, kSkyNodes, kSkyParts, model.sky_tree, model.sky_cells.size());
  data.add_owned(kProbeCoefficients, 0, std::vector<std::byte>(layout.probes_plane.step * layout.lightings));
  return data;
}

UploadData system_upload(const Model& model, std::uint32_t index, const SystemLayout& layout) {
  const System& system = model.systems[index];
  UploadData data;
  data.add_owned(kImports, 0, owned_bytes(import_records(model, system)));
  add_nodes(data, kNodes, kNodeParts, system.tree, system.clusters.size());
  add_stored_lighting(data, system, layout);
  add_blocks(data, system.bounce, layout.bounce);
  add_blocks(data, system.gather, layout.gather);
  if (layout.directional)
    data.add_owned(kIrradiance, 0, std::vector<std::byte>(layout.irradiance_plane.step * layout.lightings));
  for (const ProbeBlockLayout& block : layout.probes) add_probes(data, system, block);
  return data;
}

}  // namespace relume
