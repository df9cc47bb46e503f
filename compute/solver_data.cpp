// SPDX-License-Identifier: MIT
#include "compute/solver_data.h"

#include <bit>
#include <span>
#include <utility>

#include "core/sender_leaves.h"
#include "kernels/shared/glsl_types.h"

namespace relume {
namespace {

static_assert(sizeof(kernels::vec4) == kRgbBytes);

template <class Element>
std::span<const std::byte> bytes_of(const std::vector<Element>& elements) {
  return std::as_bytes(std::span(elements));
}

template <class Element>
std::vector<std::byte> owned_bytes(const std::vector<Element>& elements) {
  const std::span<const std::byte> bytes = bytes_of(elements);
  return {bytes.begin(), bytes.end()};
}

void add_blocks(UploadData& data, const BlockMatrix& matrix, const std::vector<BlockLayout>& layouts) {
  for (std::size_t i = 0; i < matrix.blocks.size(); ++i) {
    const MatrixBlock& block = matrix.blocks[i];
    const BlockLayout& layout = layouts[i];
    const auto add = [&](std::uint32_t binding, std::span<const std::byte> bytes) {
      data.pieces.push_back({layout.buffer, layout.sections[binding].offset, bytes});
    };
    add(kernels::kTileOffsetsBinding, bytes_of(block.tile_offsets));
    add(kernels::kColumnsBinding, bytes_of(block.columns));
    add(kernels::kValuesBinding, bytes_of(block.values));
    add(kernels::kRowScalesBinding, bytes_of(block.row_scales));
  }
}

kernels::vec4 to_device(const Rgb& value) {
  return {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z), 0.0f};
}

std::vector<std::byte> device_bytes(const std::vector<Rgb>& values) {
  std::vector<kernels::vec4> converted;
  for (const Rgb& value : values) converted.push_back(to_device(value));
  return owned_bytes(converted);
}

/// An import table as the device reads it (kernels/shared/bindings.h).
struct ImportTable {
  std::vector<kernels::uvec4> records;  ///< per import, then the ranges of nodes above the systems
  std::vector<float> shares;
};

/// Appends the shares of the leaves.
kernels::uvec4 range_record(const LeafRange& range, std::vector<float>& shares) {
  const auto first = static_cast<kernels::uint>(shares.size());
  for (std::uint32_t i = 0; i < range.count; ++i) shares.push_back(static_cast<float>(range.share_of(i)));
  return {range.first, range.count, first, 0};
}

ImportTable import_table(const System& system, const LeafNumbers& numbers) {
  ImportTable table;
  std::vector<kernels::uvec4> ranges;
  for (const SenderRef& sender : system.imports) {
    const SenderLeaves leaves = numbers.leaves_of(sender);
    kernels::uvec4 record{0, 0, 0, 0};
    if (sender.system == kSpanningNodes) {
      record.x = static_cast<kernels::uint>(system.imports.size() + ranges.size());
      record.w = static_cast<kernels::uint>(leaves.ranges.size());
      for (const LeafRange& range : leaves.ranges) ranges.push_back(range_record(range, table.shares));
    } else if (share_count(sender, leaves) > 0) {
      record = range_record(leaves.ranges.front(), table.shares);
    } else if (!leaves.ranges.empty()) {
      record = {leaves.ranges.front().first, 1, 0, 0};
    }
    table.records.push_back(record);
  }
  table.records.insert(table.records.end(), ranges.begin(), ranges.end());
  return table;
}

}  // namespace

UploadData model_upload(const Model& model, const SolverLayout& layout) {
  UploadData data;
  const LeafNumbers numbers(model);
  for (std::size_t i = 0; i < model.systems.size(); ++i) {
    const System& system = model.systems[i];
    const ImportTable imports = import_table(system, numbers);
    data.add_owned(layout.systems[i].imports_buffer, 0, owned_bytes(imports.records));
    data.add_owned(layout.systems[i].import_shares_buffer, 0, owned_bytes(imports.shares));
    add_blocks(data, system.bounce, layout.systems[i].bounce);
    add_blocks(data, system.gather, layout.systems[i].gather);
  }
  return data;
}

UploadData lighting_upload(const Lighting& lighting, const std::vector<Rgb>& weights,
                           const SolverLayout& layout) {
  const std::vector<Rgb> ones(weights.empty() ? lighting.albedo.size() : 0, Rgb(1.0));
  const VkDeviceSize sky = layout.clusters * kRgbBytes;
  UploadData data;
  data.add_owned(kAlbedo, 0, device_bytes(lighting.albedo));
  data.add_owned(kExitance, 0, device_bytes(lighting.exitance));
  data.add_owned(kDirect, 0, device_bytes(lighting.direct));
  data.add_owned(kWeights, 0, device_bytes(weights.empty() ? ones : weights));
  data.add_owned(kRadiosityA, sky, device_bytes(lighting.sky_radiosity));
  data.add_owned(kRadiosityB, sky, device_bytes(lighting.sky_radiosity));
  return data;
}

UploadData radiosity_upload(const std::vector<Rgb>& radiosity, SolveBuffer half) {
  UploadData data;
  data.add_owned(half, 0, device_bytes(radiosity));
  return data;
}

}  // namespace relume
