// SPDX-License-Identifier: MIT
#include "compute/solver_layout.h"

#include <algorithm>
#include <utility>

#include "compute/node_tables.h"
#include "core/directional_irradiance.h"
#include "kernels/shared/limits.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

static_assert(kRadiosity == kernels::kRadiosityBinding && kFirstSender == kernels::kFirstSenderBinding &&
              kResiduals == kernels::kResidualBinding);
static_assert(kImports == kernels::kImportsBinding && kLocalRadiosity == kernels::kLocalRadiosityBinding &&
              kIrradiance == kernels::kIrradianceBinding && kAlbedo == kernels::kAlbedoBinding &&
              kExitance == kernels::kExitanceBinding && kDirect == kernels::kDirectBinding &&
              kWeights == kernels::kWeightsBinding && kNodes == kernels::kNodesBinding &&
              kNodeParts == kernels::kNodePartsBinding && kSystemBuffers == kernels::kOwnRadiosityBinding);

static_assert(kProbeLists == kernels::kProbeListsBinding && kProbeSenders == kernels::kProbeSendersBinding &&
              kProbeBuffers == kernels::kProbeCoefficientsBinding);

constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                      VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
constexpr VkDeviceSize kEmptyBytes = 16;
constexpr VkDeviceSize kNodePartBytes = sizeof(NodeTables::parts[0]);

VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

/// Collects buffers; a buffer without elements still has some bytes, because an empty range cannot be bound.
class BufferList {
 public:
  BufferList(std::vector<BufferRequirement>& buffers, std::string owner, VkDeviceSize alignment)
      : buffers_(buffers), owner_(std::move(owner)), alignment_(alignment) {}

  std::uint32_t add(const std::string& name, VkDeviceSize byte_size) {
    buffers_.push_back({owner_ + name, std::max(byte_size, kEmptyBytes), alignment_, kUsage});
    return static_cast<std::uint32_t>(buffers_.size() - 1);
  }

 private:
  std::vector<BufferRequirement>& buffers_;
  std::string owner_;
  VkDeviceSize alignment_;
};

/// As wide as an entry of a tile of eight rows and a load allow.
VkFormat code_format(const MatrixBlock& block) {
  if (block.tile_rows != kernels::kTileOfRows) return VK_FORMAT_R32_UINT;
  return block.codec == ValueCodec::sqrt8 ? VK_FORMAT_R32G32_UINT : VK_FORMAT_R32G32B32A32_UINT;
}

BlockLayout block_layout(const MatrixBlock& block, const std::string& name, VkDeviceSize alignment,
                         BufferList& buffers) {
  std::array<VkDeviceSize, kernels::kBlockBindings> bytes{};
  bytes[kernels::kTileOffsetsBinding] = block.tile_offsets.size() * sizeof(std::uint32_t);
  bytes[kernels::kColumnsBinding] =
      align_up(block.columns.size() * sizeof(std::uint16_t), sizeof(std::uint32_t));
  bytes[kernels::kValuesBinding] = align_up(block.values.size(), sizeof(std::uint32_t));
  bytes[kernels::kRowScalesBinding] =
      block.row_scales.size() * sizeof(float) + block.directions.size() * sizeof(std::uint32_t);
  BlockLayout layout;
  layout.code_format = code_format(block);
  VkDeviceSize end = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    layout.sections[i] = {align_up(end, alignment), std::max(bytes[i], kEmptyBytes)};
    end = layout.sections[i].offset + layout.sections[i].byte_size;
  }
  layout.buffer = buffers.add(name, end);
  return layout;
}

std::vector<BlockLayout> matrix_layout(const BlockMatrix& matrix, const std::string& name,
                                       VkDeviceSize alignment, BufferList& buffers) {
  std::vector<BlockLayout> blocks;
  for (const MatrixBlock& block : matrix.blocks) {
    blocks.push_back(
        block_layout(block, name + " block " + std::to_string(blocks.size()), alignment, buffers));
  }
  return blocks;
}

/// A single lighting needs no room behind it.
LightingPlane lighting_plane(VkDeviceSize byte_size, const LayoutLimits& limits) {
  return {byte_size, limits.lightings == 1 ? byte_size : align_up(byte_size, limits.alignment)};
}

/// In the order of SystemBuffer.
void add_system_buffers(const SystemLayout& layout, BufferList& buffers) {
  const VkDeviceSize records = VkDeviceSize{layout.imports} + layout.import_parts;
  buffers.add("imports", records * sizeof(kernels::uvec4));
  buffers.add("local radiosity",
              layout.imports * layout.lightings * (layout.half_senders ? kHalfRgbBytes : kRgbBytes));
  buffers.add("irradiance", layout.irradiance_plane.step * layout.lightings);
  buffers.add("albedo", layout.clusters * kRgbBytes);
  for (const char* name : {"exitance", "direct"})
    buffers.add(name, layout.clusters_plane.step * layout.lightings);
  buffers.add("weights", layout.clusters * kRgbBytes);
  buffers.add("nodes", layout.nodes * sizeof(kernels::uvec4));
  buffers.add("node parts", layout.node_parts * kNodePartBytes);
}

/// A probe alone has its block, however long its list.
std::vector<ProbeBlockLayout> probe_blocks(const System& system) {
  constexpr std::uint64_t kMost = kMaxBlockBytes / sizeof(ProbeSender);
  std::vector<ProbeBlockLayout> blocks;
  for (std::uint32_t p = 0; p < system.probes.size(); ++p) {
    const Probe& probe = system.probes[p];
    if (blocks.empty() || std::uint64_t{blocks.back().sender_count} + probe.sender_count > kMost)
      blocks.push_back({p, 0, probe.first_sender, 0, 0});
    ++blocks.back().probe_count;
    blocks.back().sender_count += probe.sender_count;
  }
  return blocks;
}

/// In the order of ProbeBuffer.
void add_probe_buffers(std::vector<ProbeBlockLayout>& blocks, BufferList& buffers) {
  for (ProbeBlockLayout& block : blocks) {
    block.first_buffer = buffers.add(
        "probes", VkDeviceSize{block.probe_count} * kernels::kProbeListUints * sizeof(std::uint32_t));
    buffers.add("probe senders", VkDeviceSize{block.sender_count} * sizeof(ProbeSender));
  }
}

/// In the order of SolveBuffer.
void add_solve_buffers(const SolverLayout& layout, BufferList& buffers) {
  buffers.add("radiosity", layout.radiosity_plane.step * layout.lightings);
  buffers.add("first sender", (VkDeviceSize{layout.systems} + 1) * sizeof(std::uint32_t));
  buffers.add("residuals", layout.residual_bytes());
  buffers.add("sky nodes", layout.sky_nodes * sizeof(kernels::uvec4));
  buffers.add("sky node parts", layout.sky_node_parts * kNodePartBytes);
  buffers.add("probe coefficients", layout.probes_plane.step * layout.lightings);
}

Result<void> check_sizes(const std::vector<BufferRequirement>& buffers, VkDeviceSize max_range) {
  for (const BufferRequirement& buffer : buffers) {
    if (buffer.byte_size > max_range) {
      return fail(ErrorCode::no_device,
                  "the buffer '" + buffer.name + "' needs " + std::to_string(buffer.byte_size) +
                      " bytes, but the device binds at most " + std::to_string(max_range) + " at once");
    }
  }
  return {};
}

std::uint32_t count(std::size_t elements) {
  return static_cast<std::uint32_t>(elements);
}

}  // namespace

VkDeviceSize SolverLayout::residual_bytes() const {
  return VkDeviceSize{lightings} * systems * sizeof(kernels::ResidualRecord);
}

std::uint32_t loaded_senders(const Model& model) {
  std::size_t senders = 0;
  for (const System& system : model.systems) senders += system.clusters.size() + system.tree.nodes.size();
  return count(senders);
}

Result<SolverLayout> solver_layout(const Model& model, std::uint32_t sender_capacity,
                                   const LayoutLimits& limits) {
  SolverLayout layout;
  layout.systems = count(model.systems.size());
  layout.sky_patches = count(model.sky_cells.size());
  layout.sky_nodes = count(model.sky_tree.nodes.size());
  layout.sky_node_parts = count(node_tables(model.sky_tree, layout.sky_patches).parts.size());
  layout.probes = count(model.probe_names.size());
  layout.sender_capacity = sender_capacity;
  layout.sender_step = static_cast<std::uint32_t>(std::max<VkDeviceSize>(limits.alignment / kRgbBytes, 1));
  layout.lightings = limits.lightings;
  const VkDeviceSize places = VkDeviceSize{layout.sky_places()} + layout.system_places();
  layout.radiosity_plane = lighting_plane(places * kRgbBytes, limits);
  layout.probes_plane = lighting_plane(layout.probes * kProbeBytes, limits);
  BufferList buffers(layout.buffers, "", limits.alignment);
  add_solve_buffers(layout, buffers);
  if (auto checked = check_sizes(layout.buffers, limits.max_range); !checked) {
    return tl::unexpected<Error>(checked.error());
  }
  return layout;
}

Result<SystemLayout> system_layout(const Model& model, std::uint32_t index, const LayoutLimits& limits) {
  const System& system = model.systems[index];
  SystemLayout layout;
  layout.clusters = count(system.clusters.size());
  layout.nodes = count(system.tree.nodes.size());
  layout.node_parts = count(node_tables(system.tree, layout.clusters).parts.size());
  layout.imports = count(system.imports.size());
  for (const SenderRef& sender : system.imports) {
    if (sender.system == kSpanningNodes) layout.import_parts += model.top_tree[sender.index].part_count - 1;
  }
  layout.gather_rows = system.gather.rows;
  layout.directional = is_directional(system);
  layout.half_senders = limits.half_senders;
  layout.lightings = limits.lightings;
  layout.clusters_plane = lighting_plane(layout.clusters * kRgbBytes, limits);
  layout.irradiance_plane =
      lighting_plane(layout.gather_rows * (kRgbBytes + (layout.directional ? kMomentBytes : 0)), limits);
  BufferList buffers(layout.buffers, "system " + std::to_string(index) + " ", limits.alignment);
  add_system_buffers(layout, buffers);
  layout.bounce = matrix_layout(system.bounce, "bounce", limits.alignment, buffers);
  layout.gather = matrix_layout(system.gather, "gather", limits.alignment, buffers);
  layout.probes = probe_blocks(system);
  add_probe_buffers(layout.probes, buffers);
  if (auto checked = check_sizes(layout.buffers, limits.max_range); !checked) {
    return tl::unexpected<Error>(checked.error());
  }
  return layout;
}

std::uint32_t SolverLayout::sky_places() const {
  return static_cast<std::uint32_t>(align_up(sky_senders(), sender_step));
}

std::uint32_t SolverLayout::system_places() const {
  return static_cast<std::uint32_t>(
      align_up(2 * VkDeviceSize{sender_capacity} + VkDeviceSize{systems} * (sender_step - 1), sender_step));
}

BufferRange radiosity_part(const SolverLayout& layout, const BufferRange& radiosity, std::uint32_t first,
                           std::uint32_t count) {
  const VkDeviceSize planes = (layout.lightings - 1) * layout.radiosity_plane.step;
  if (count == 0) return {radiosity.buffer, radiosity.offset, kRgbBytes};
  return {radiosity.buffer, radiosity.offset + first * kRgbBytes, planes + count * kRgbBytes};
}

VkDeviceSize largest_texel_buffer(const SolverLayout& solver, const SystemLayout& layout) {
  const VkDeviceSize senders = solver.radiosity_plane.step * solver.lightings / kRgbBytes;
  const VkDeviceSize clusters = layout.clusters_plane.step * layout.lightings / kRgbBytes;
  const VkDeviceSize imports = VkDeviceSize{layout.imports} + layout.import_parts;
  const VkDeviceSize imported = VkDeviceSize{layout.imports} * layout.lightings;
  const VkDeviceSize parts = layout.node_parts;
  VkDeviceSize bytes = std::max({senders, clusters, imports, imported, parts}) * sizeof(std::uint32_t);
  for (const auto* blocks : {&layout.bounce, &layout.gather}) {
    for (const BlockLayout& block : *blocks) {
      for (const BlockSection& section : block.sections) bytes = std::max(bytes, section.byte_size);
    }
  }
  return bytes / sizeof(std::uint32_t);
}

}  // namespace relume
