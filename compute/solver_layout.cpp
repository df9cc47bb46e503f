// SPDX-License-Identifier: MIT
#include "compute/solver_layout.h"

#include <algorithm>
#include <utility>

#include "core/sender_leaves.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                      VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
constexpr VkDeviceSize kEmptyBytes = 16;

VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

/// Collects buffers; a buffer without elements still has some bytes, because an empty range cannot be bound.
class BufferList {
 public:
  BufferList(std::vector<BufferRequirement>& buffers, VkDeviceSize alignment)
      : buffers_(buffers), alignment_(alignment) {}

  std::uint32_t add(std::string name, VkDeviceSize byte_size) {
    buffers_.push_back({std::move(name), std::max(byte_size, kEmptyBytes), alignment_, kUsage});
    return static_cast<std::uint32_t>(buffers_.size() - 1);
  }

 private:
  std::vector<BufferRequirement>& buffers_;
  VkDeviceSize alignment_;
};

BlockLayout block_layout(const MatrixBlock& block, const std::string& name, VkDeviceSize alignment,
                         BufferList& buffers) {
  std::array<VkDeviceSize, kernels::kBlockBindings> bytes{};
  bytes[kernels::kTileOffsetsBinding] = block.tile_offsets.size() * sizeof(std::uint32_t);
  bytes[kernels::kColumnsBinding] =
      align_up(block.columns.size() * sizeof(std::uint16_t), sizeof(std::uint32_t));
  bytes[kernels::kValuesBinding] = align_up(block.values.size(), sizeof(std::uint32_t));
  bytes[kernels::kRowScalesBinding] = block.row_scales.size() * sizeof(float);
  BlockLayout layout;
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

SystemLayout system_layout(const System& system, const LeafNumbers& numbers, const std::string& name,
                           VkDeviceSize alignment, BufferList& buffers) {
  SystemLayout layout;
  layout.imports = static_cast<std::uint32_t>(system.imports.size());
  for (const SenderRef& sender : system.imports) {
    const SenderLeaves leaves = numbers.leaves_of(sender);
    if (sender.system == kSpanningNodes)
      layout.import_ranges += static_cast<std::uint32_t>(leaves.ranges.size());
    layout.import_shares += share_count(sender, leaves);
  }
  const VkDeviceSize records = VkDeviceSize{layout.imports} + layout.import_ranges;
  layout.gather_rows = system.gather.rows;
  layout.imports_buffer = buffers.add(name + " imports", records * sizeof(kernels::uvec4));
  layout.import_shares_buffer = buffers.add(name + " import shares", layout.import_shares * sizeof(float));
  layout.local_radiosity_buffer = buffers.add(name + " local radiosity", layout.imports * kRgbBytes);
  layout.irradiance_buffer = buffers.add(name + " irradiance", layout.gather_rows * kRgbBytes);
  layout.bounce = matrix_layout(system.bounce, name + " bounce", alignment, buffers);
  layout.gather = matrix_layout(system.gather, name + " gather", alignment, buffers);
  return layout;
}

/// In the order of SolveBuffer.
void add_solve_buffers(const SolverLayout& layout, BufferList& buffers) {
  const VkDeviceSize cluster_bytes = layout.clusters * kRgbBytes;
  const VkDeviceSize sender_bytes = cluster_bytes + layout.sky_patches * kRgbBytes;
  buffers.add("radiosity a", sender_bytes);
  buffers.add("radiosity b", sender_bytes);
  buffers.add("albedo", cluster_bytes);
  buffers.add("exitance", cluster_bytes);
  buffers.add("direct", cluster_bytes);
  buffers.add("weights", cluster_bytes);
  buffers.add("residual", sizeof(kernels::ResidualRecord));
}

Result<void> check_sizes(const SolverLayout& layout, VkDeviceSize max_range) {
  for (const BufferRequirement& buffer : layout.buffers) {
    if (buffer.byte_size > max_range) {
      return fail(ErrorCode::no_device,
                  "the buffer '" + buffer.name + "' needs " + std::to_string(buffer.byte_size) +
                      " bytes, but the device binds at most " + std::to_string(max_range) + " at once");
    }
  }
  return {};
}

}  // namespace

std::uint32_t share_count(const SenderRef& sender, const SenderLeaves& leaves) {
  std::uint32_t count = 0;
  for (const LeafRange& range : leaves.ranges) count += range.count;
  const bool leaf = sender.system != kSpanningNodes && count == 1;
  return leaf ? 0 : count;
}

Result<SolverLayout> solver_layout(const Model& model, const LayoutLimits& limits) {
  SolverLayout layout;
  layout.sky_patches = static_cast<std::uint32_t>(model.sky_cells.size());
  const std::vector<std::uint32_t> first_clusters = cluster_offsets(model);
  layout.clusters = first_clusters.back();
  const LeafNumbers numbers(model);
  BufferList buffers(layout.buffers, limits.alignment);
  add_solve_buffers(layout, buffers);
  for (const System& system : model.systems) {
    const std::size_t index = layout.systems.size();
    layout.systems.push_back(
        system_layout(system, numbers, "system " + std::to_string(index), limits.alignment, buffers));
    layout.systems.back().first_cluster = first_clusters[index];
  }
  if (auto checked = check_sizes(layout, limits.max_range); !checked) {
    return tl::unexpected<Error>(checked.error());
  }
  return layout;
}

VkDeviceSize largest_texel_buffer(const SolverLayout& layout) {
  VkDeviceSize bytes = 0;
  for (const SystemLayout& system : layout.systems) {
    for (const auto* blocks : {&system.bounce, &system.gather}) {
      for (const BlockLayout& block : *blocks) {
        bytes = std::max({bytes, block.sections[kernels::kColumnsBinding].byte_size,
                          block.sections[kernels::kValuesBinding].byte_size});
      }
    }
  }
  return bytes / sizeof(std::uint32_t);
}

}  // namespace relume
