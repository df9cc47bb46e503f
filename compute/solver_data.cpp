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

kernels::uvec4 range_record(const LeafRange& range) {
  return {range.first, range.count, 0, 0};
}

/// A record per import, then the ranges of nodes above the systems (kernels/shared/bindings.h).
std::vector<kernels::uvec4> import_records(const System& system, const LeafNumbers& numbers) {
  std::vector<kernels::uvec4> records, ranges;
  for (const SenderRef& sender : system.imports) {
    const SenderLeaves leaves = numbers.leaves_of(sender);
    kernels::uvec4 record{0, 0, 0, 0};
    if (sender.system == kSpanningNodes) {
      record.x = static_cast<kernels::uint>(system.imports.size() + ranges.size());
      record.w = static_cast<kernels::uint>(leaves.ranges.size());
      for (const LeafRange& range : leaves.ranges) ranges.push_back(range_record(range));
    } else if (!leaves.ranges.empty()) {
      record = range_record(leaves.ranges.front());
    }
    const double weight = numbers.weight_of(leaves);
    record.z = std::bit_cast<kernels::uint>(weight > 0.0 ? static_cast<float>(1.0 / weight) : 0.0f);
    records.push_back(record);
  }
  records.insert(records.end(), ranges.begin(), ranges.end());
  return records;
}

}  // namespace

UploadData model_upload(const Model& model, const SolverLayout& layout) {
  UploadData data;
  const LeafNumbers numbers(model);
  const std::vector<double>& weights = numbers.weights();
  data.add_owned(kLeafWeights, 0, owned_bytes(std::vector<float>(weights.begin(), weights.end())));
  for (std::size_t i = 0; i < model.systems.size(); ++i) {
    const System& system = model.systems[i];
    data.add_owned(layout.systems[i].imports_buffer, 0, owned_bytes(import_records(system, numbers)));
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
