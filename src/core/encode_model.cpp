// SPDX-License-Identifier: MIT
#include <array>

#include "core/model_file.h"
#include "core/model_sections.h"
#include "core/section_table.h"

namespace relume {
namespace {

using namespace sections;

/// Values and strings one after the other, without padding. A string is its length in 32 bits and its bytes.
class ByteWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(std::as_bytes(std::span(&value, 1)));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    append(std::as_bytes(std::span(text)));
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  void append(std::span<const std::byte> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }

  std::vector<std::byte> bytes_;
};

void add_info(const Model& model, SectionWriter& file) {
  ByteWriter info;
  const std::uint32_t flags = (model.lit_by_rig ? kInfoLitByRig : 0u) |
                              (model.sky_radiance ? kInfoHasSky : 0u) | (model.camera ? kInfoHasCamera : 0u);
  info.put(model.origin);
  info.put(model.max_albedo);
  info.put(model.geometry_hash);
  info.put(model.sky_resolution);
  info.put(static_cast<std::uint32_t>(model.systems.size()));
  info.put(flags);
  info.put(std::uint32_t{0});
  info.put(model.sky_radiance.value_or(Rgb(0.0)));
  const Camera camera = model.camera.value_or(Camera{});
  info.put(camera.position);
  info.put(camera.forward);
  info.put(camera.up);
  info.put(camera.vertical_field_of_view);
  info.put(model.provenance.scene_file);
  info.put(model.provenance.tool);
  info.put(model.provenance.ray_tracer);
  info.put(model.provenance.options);
  file.add(kInfo, kNone, info.bytes());
}

void add_lights(const std::vector<Light>& lights, SectionWriter& file) {
  ByteWriter records;
  for (const Light& light : lights) {
    records.put(light.type);
    records.put(light.intensity);
    records.put(light.position);
    records.put(light.direction);
    records.put(light.range);
    records.put(light.inner_cone_angle);
    records.put(light.outer_cone_angle);
    records.put(light.name);
  }
  file.add(kLights, kNone, records.bytes());
}

void add_named_records(const Model& model, SectionWriter& file) {
  ByteWriter materials, nodes, sensors, probes;
  for (const MaterialRecord& material : model.materials) {
    materials.put((material.double_sided ? kMaterialDoubleSided : 0u) |
                  (material.possible_emitter ? kMaterialPossibleEmitter : 0u));
    materials.put(material.name);
  }
  for (const NodeRecord& node : model.nodes) {
    nodes.put(node.geometry_hash);
    nodes.put(node.path);
  }
  for (const std::string& name : model.sensor_names) sensors.put(name);
  for (const std::string& name : model.probe_names) probes.put(name);
  file.add(kMaterials, kNone, materials.bytes());
  file.add(kNodes, kNone, nodes.bytes());
  file.add(kSensorNames, kNone, sensors.bytes());
  file.add(kProbeNames, kNone, probes.bytes(), kSectionOptional);
}

void add_probe_volume(const ProbeVolume& volume, SectionWriter& file) {
  if (volume.nodes.empty()) return;
  ByteWriter head;
  head.put(volume.lower);
  head.put(volume.edges);
  head.put(volume.counts);
  file.add(kProbeVolume, kNone, head.bytes(), kSectionOptional);
  file.borrow_array(kProbeVolumeNodes, kNone, volume.nodes, kSectionOptional);
  file.borrow_array(kProbeVolumeCells, kNone, volume.cells, kSectionOptional);
  file.borrow_array(kProbeVolumePlanes, kNone, volume.planes, kSectionOptional);
}

void add_occluders(const Occluders& occluders, SectionWriter& file) {
  file.borrow_array(kOccluderPositions, kNone, occluders.positions);
  file.borrow_array(kOccluderTriangles, kNone, occluders.triangles);
  file.borrow_array(kOccluderMaterials, kNone, occluders.material);
  file.borrow_array(kOccluderNodes, kNone, occluders.node);
  file.borrow_array(kOccluderSystems, kNone, occluders.system);
  file.borrow_array(kOccluderFrontUv, kNone, occluders.front_uv);
  file.borrow_array(kOccluderBackUv, kNone, occluders.back_uv);
  file.borrow_array(kOpacityMaps, kNone, occluders.opacity.maps);
  file.borrow_array(kOpacityTexels, kNone, occluders.opacity.texels);
  file.borrow_array(kOpacityTriangles, kNone, occluders.opacity.triangles);
  file.borrow_array(kTextureTriangles, kNone, occluders.texture, kSectionOptional);
  file.borrow_array(kBvhNodes, kNone, occluders.bvh.nodes);
  file.borrow_array(kBvhTriangles, kNone, occluders.bvh.triangles);
}

void add_matrix(const BlockMatrix& matrix, std::string_view id, std::uint32_t owner, SectionWriter& file) {
  static constexpr std::array<std::byte, 4> kZeros{};
  for (const MatrixBlock& block : matrix.blocks) {
    const BlockHeader header{block.first_row,
                             block.row_count,
                             block.tile_rows,
                             static_cast<std::uint32_t>(block.codec),
                             static_cast<std::uint32_t>(block.tile_offsets.size()),
                             static_cast<std::uint32_t>(block.columns.size())};
    const auto head = std::as_bytes(std::span(&header, 1));
    std::vector<std::byte> own(head.begin(), head.end());
    std::vector<std::span<const std::byte>> parts{own};
    const auto add_padded = [&](std::span<const std::byte> bytes) {
      parts.push_back(bytes);
      parts.push_back(std::span(kZeros).first((4 - bytes.size() % 4) % 4));
    };
    add_padded(std::as_bytes(std::span(block.tile_offsets)));
    add_padded(std::as_bytes(std::span(block.columns)));
    add_padded(std::as_bytes(std::span(block.values)));
    add_padded(std::as_bytes(std::span(block.row_scales)));
    file.borrow(id, owner, parts);
    file.keep(std::move(own));
  }
}

void add_system(const System& system, std::uint32_t index, SectionWriter& file) {
  ByteWriter head;
  head.put(system.lightmap_width);
  head.put(system.lightmap_height);
  head.put(system.name);
  file.add(kSystem, index, head.bytes());
  file.borrow_array(kClusters, index, system.clusters);
  file.borrow_array(kElements, index, system.elements);
  file.borrow_array(kPieces, index, system.pieces);
  file.borrow_array(kOwnPatches, index, system.own_patches);
  file.borrow_array(kLumels, index, system.lumels);
  file.borrow_array(kSensors, index, system.sensors);
  file.borrow_array(kLiftedSensors, index, system.lifted_sensors);
  file.borrow_array(kProbes, index, system.probes, kSectionOptional);
  file.borrow_array(kProbeSenders, index, system.probe_senders, kSectionOptional);
  file.borrow_array(kCharts, index, system.charts);
  file.borrow_array(kTree, index, system.tree.nodes);
  file.borrow_array(kTreeShares, index, system.tree.shares);
  file.borrow_array(kImports, index, system.imports);
  file.borrow_array(kClusterRays, index, system.rays, kSectionOptional);
  file.borrow_array(kCutErrors, index, system.cut_errors, kSectionOptional);
  file.borrow_array(kBounceHalvings, index, system.bounce_halvings, kSectionOptional);
  file.borrow_array(kGatherHalvings, index, system.gather_halvings, kSectionOptional);
  add_matrix(system.bounce, kBounceBlock, index, file);
  add_matrix(system.gather, kGatherBlock, index, file);
  for (const MatrixBlock& block : system.gather.blocks)
    file.borrow_array(kGatherDirections, index, block.directions, kSectionOptional);
}

}  // namespace

FileParts encode_model_parts(const Model& model) {
  SectionWriter file;
  add_info(model, file);
  file.borrow_array(kSkyCells, kNone, model.sky_cells);
  file.borrow_array(kSkyTree, kNone, model.sky_tree.nodes);
  file.borrow_array(kSkyTreeShares, kNone, model.sky_tree.shares);
  file.borrow_array(kTopTree, kNone, model.top_tree);
  file.borrow_array(kTopParts, kNone, model.top_parts);
  add_named_records(model, file);
  add_probe_volume(model.probe_volume, file);
  add_lights(model.lights, file);
  add_occluders(model.occluders, file);
  for (std::size_t index = 0; index < model.systems.size(); ++index) {
    add_system(model.systems[index], static_cast<std::uint32_t>(index), file);
  }
  return std::move(file).finish_parts();
}

std::vector<std::byte> encode_model(const Model& model) {
  return encode_model_parts(model).joined();
}

}  // namespace relume
