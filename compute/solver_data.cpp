// SPDX-License-Identifier: MIT
#include "compute/solver_data.h"

#include <span>
#include <utility>

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
    const std::span<const std::byte> sections[] = {bytes_of(block.tile_offsets), bytes_of(block.columns),
                                                   bytes_of(block.values), bytes_of(block.row_scales)};
    for (std::size_t s = 0; s < layout.sections.size(); ++s) {
      data.pieces.push_back({layout.buffer, layout.sections[s].offset, sections[s]});
    }
  }
}

kernels::vec4 to_device(const Rgb& value) {
  return {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z), 0.0f};
}

/// One quantity of all clusters, numbered through, as it lies among padded clusters.
std::vector<std::byte> padded(const std::vector<Rgb>& values, const SolverLayout& layout,
                              const Rgb& padding) {
  std::vector<kernels::vec4> out(layout.padded_clusters, to_device(padding));
  std::size_t next = 0;
  for (const SystemLayout& system : layout.systems) {
    for (std::uint32_t i = 0; i < system.clusters; ++i) {
      out[system.first_cluster + i] = to_device(values[next++]);
    }
  }
  return owned_bytes(out);
}

}  // namespace

UploadData model_upload(const Model& model, const SolverLayout& layout) {
  UploadData data;
  for (std::size_t i = 0; i < model.systems.size(); ++i) {
    const System& system = model.systems[i];
    std::vector<std::uint32_t> senders;
    for (const SenderRef& sender : system.imports) senders.push_back(sender_number(layout, sender));
    data.add_owned(layout.systems[i].imports_buffer, 0, owned_bytes(senders));
    add_blocks(data, system.bounce, layout.systems[i].bounce);
    add_blocks(data, system.gather, layout.systems[i].gather);
  }
  return data;
}

UploadData lighting_upload(const Lighting& lighting, const std::vector<Rgb>& weights,
                           const SolverLayout& layout) {
  std::vector<kernels::vec4> sky;
  for (const Rgb& radiosity : lighting.sky_radiosity) sky.push_back(to_device(radiosity));
  const std::vector<Rgb> ones(weights.empty() ? lighting.albedo.size() : 0, Rgb(1.0));

  UploadData data;
  data.add_owned(kAlbedo, 0, padded(lighting.albedo, layout, Rgb(0.0)));
  data.add_owned(kExitance, 0, padded(lighting.exitance, layout, Rgb(0.0)));
  data.add_owned(kDirect, 0, padded(lighting.direct, layout, Rgb(0.0)));
  data.add_owned(kWeights, 0, padded(weights.empty() ? ones : weights, layout, Rgb(1.0)));
  data.add_owned(kRadiosityA, layout.padded_clusters * kRgbBytes, owned_bytes(sky));
  data.add_owned(kRadiosityB, layout.padded_clusters * kRgbBytes, owned_bytes(sky));
  return data;
}

}  // namespace relume
