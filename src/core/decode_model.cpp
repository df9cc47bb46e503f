// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <new>
#include <optional>

#include "core/decode_sections.h"
#include "core/model_file.h"
#include "core/model_sections.h"
#include "core/section_table.h"

namespace relume {
namespace {

using namespace sections;

/// Reads what ByteWriter wrote. After the first read past the end everything reads as zero and `good` is
/// false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  T take() {
    T value{};
    const auto bytes = take_bytes(sizeof value);
    if (good_) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::string take_string() {
    const auto bytes = take_bytes(take<std::uint32_t>());
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  /// `count` values and the zeros that pad them to a multiple of 4 bytes.
  template <class T>
  std::vector<T> take_padded(std::uint64_t count) {
    const std::uint64_t length = count * sizeof(T);
    const auto bytes = take_bytes(length);
    std::vector<T> values(good_ ? count : 0);
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    for (const std::byte padding : take_bytes((4 - length % 4) % 4)) good_ = good_ && padding == std::byte{0};
    return values;
  }
  bool good() const { return good_; }
  bool at_end() const { return rest_.empty(); }

 private:
  std::span<const std::byte> take_bytes(std::uint64_t count) {
    good_ = good_ && count <= rest_.size();
    if (!good_) return {};
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  std::span<const std::byte> rest_;
  bool good_ = true;
};

tl::unexpected<Error> malformed(const SectionRecord& record, const std::string& sentence) {
  return fail(ErrorCode::bad_input, fmt::format("section {}: {}", describe(record), sentence));
}

Result<void> check_consumed(const ByteReader& reader, const SectionRecord& record) {
  if (reader.good() && reader.at_end()) return {};
  return malformed(record, reader.good() ? "expected the end of the section, found more bytes"
                                         : "expected more bytes (or zeros as padding) than there are");
}

template <class T>
Result<void> read_array(const Section& section, std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (section.bytes.size() % sizeof(T) != 0) {
    return malformed(section.record, fmt::format("expected a multiple of {} bytes, found {}", sizeof(T),
                                                 section.bytes.size()));
  }
  values.resize(section.bytes.size() / sizeof(T));
  std::memcpy(values.data(), section.bytes.data(), section.bytes.size());
  return {};
}

/// One record after the other until the section ends.
template <class T>
Result<void> read_records(const Section& section, std::vector<T>& records,
                          const std::function<T(ByteReader&)>& read) {
  ByteReader reader(section.bytes);
  while (reader.good() && !reader.at_end()) records.push_back(read(reader));
  return check_consumed(reader, section.record);
}

/// `systems` is how many there are sections of.
Result<void> read_info(const Section& section, std::size_t systems, Model& model) {
  ByteReader info(section.bytes);
  model.origin = info.take<glm::dvec3>();
  model.max_albedo = info.take<double>();
  model.geometry_hash = info.take<std::uint64_t>();
  model.sky_resolution = info.take<std::uint32_t>();
  const auto system_count = info.take<std::uint32_t>();
  const auto flags = info.take<std::uint32_t>();
  const auto reserved = info.take<std::uint32_t>();
  const Rgb sky = info.take<Rgb>();
  Camera camera;
  camera.position = info.take<glm::dvec3>();
  camera.forward = info.take<glm::dvec3>();
  camera.up = info.take<glm::dvec3>();
  camera.vertical_field_of_view = info.take<double>();
  model.provenance.scene_file = info.take_string();
  model.provenance.tool = info.take_string();
  model.provenance.ray_tracer = info.take_string();
  model.provenance.options = info.take_string();
  if (auto checked = check_consumed(info, section.record); !checked) return checked;
  if ((flags & ~(kInfoLitByRig | kInfoHasSky | kInfoHasCamera)) != 0 || reserved != 0) {
    return malformed(section.record,
                     fmt::format("expected known flags, found {:#x} and {:#x}", flags, reserved));
  }
  if (system_count != systems) {
    return malformed(section.record, fmt::format("expected {} systems, as there are sections of, found {}",
                                                 systems, system_count));
  }
  model.lit_by_rig = (flags & kInfoLitByRig) != 0;
  if ((flags & kInfoHasSky) != 0) model.sky_radiance = sky;
  if ((flags & kInfoHasCamera) != 0) model.camera = camera;
  model.systems.resize(system_count);
  return {};
}

Light read_light(ByteReader& reader) {
  Light light;
  light.type = reader.take<LightType>();
  light.intensity = reader.take<Rgb>();
  light.position = reader.take<glm::dvec3>();
  light.direction = reader.take<glm::dvec3>();
  light.range = reader.take<double>();
  light.inner_cone_angle = reader.take<double>();
  light.outer_cone_angle = reader.take<double>();
  light.name = reader.take_string();
  return light;
}

Result<void> read_materials(const Section& section, Model& model) {
  std::uint32_t all_flags = 0;
  const std::function<MaterialRecord(ByteReader&)> read = [&all_flags](ByteReader& reader) {
    const auto flags = reader.take<std::uint32_t>();
    all_flags |= flags;
    return MaterialRecord{reader.take_string(), (flags & kMaterialDoubleSided) != 0,
                          (flags & kMaterialPossibleEmitter) != 0};
  };
  if (auto done = read_records(section, model.materials, read); !done) return done;
  if ((all_flags & ~(kMaterialDoubleSided | kMaterialPossibleEmitter)) == 0) return {};
  return malformed(section.record, fmt::format("expected known flags, found {:#x}", all_flags));
}

Result<void> read_nodes(const Section& section, Model& model) {
  const std::function<NodeRecord(ByteReader&)> read = [](ByteReader& reader) {
    NodeRecord node;
    node.geometry_hash = reader.take<std::uint64_t>();
    node.path = reader.take_string();
    return node;
  };
  return read_records(section, model.nodes, read);
}

Result<void> read_system_head(const Section& section, System& system) {
  ByteReader reader(section.bytes);
  system.lightmap_width = reader.take<std::uint32_t>();
  system.lightmap_height = reader.take<std::uint32_t>();
  system.name = reader.take_string();
  return check_consumed(reader, section.record);
}

Result<void> read_block(const Section& section, BlockMatrix& matrix) {
  ByteReader reader(section.bytes);
  const auto header = reader.take<BlockHeader>();
  MatrixBlock block;
  block.first_row = header.first_row;
  block.row_count = header.row_count;
  block.tile_rows = header.tile_rows;
  block.codec = static_cast<ValueCodec>(header.codec);
  const std::size_t bytes_of_value = value_bytes(block.codec);
  if (bytes_of_value == 0 || (header.tile_rows != 1 && header.tile_rows != 8)) {
    return malformed(section.record,
                     fmt::format("expected value codec 0, 1 or 2 and tiles of 1 or 8 rows, found {} and {}",
                                 header.codec, header.tile_rows));
  }
  block.tile_offsets = reader.take_padded<std::uint32_t>(header.tile_offset_count);
  block.columns = reader.take_padded<std::uint16_t>(header.column_count);
  block.values =
      reader.take_padded<std::byte>(std::uint64_t{header.column_count} * header.tile_rows * bytes_of_value);
  block.row_scales = reader.take_padded<float>(header.row_count);
  if (auto checked = check_consumed(reader, section.record); !checked) return checked;
  matrix.rows += block.row_count;
  matrix.blocks.push_back(std::move(block));
  return {};
}

/// Of the first block of the gather matrix that has values, but no directions yet.
Result<void> read_directions(const Section& section, BlockMatrix& gather) {
  for (MatrixBlock& block : gather.blocks) {
    if (!block.columns.empty() && block.directions.empty()) return read_array(section, block.directions);
  }
  return malformed(section.record,
                   "expected a block of the gather matrix before, found none without directions");
}

std::string_view id_of(const Section& section) {
  return {section.record.id.data(), section.record.id.size()};
}

Result<void> read_probe_volume(const Section& section, ProbeVolume& volume) {
  ByteReader reader(section.bytes);
  volume.lower = reader.take<glm::vec3>();
  volume.edges = reader.take<glm::vec3>();
  volume.counts = reader.take<std::array<std::uint32_t, 3>>();
  return check_consumed(reader, section.record);
}

/// nullopt: no section of the model that this version knows.
std::optional<Result<void>> read_model_section(const Section& section, Model& model) {
  const std::string_view id = id_of(section);
  Occluders& occluders = model.occluders;
  if (id == kSkyCells) return read_array(section, model.sky_cells);
  if (id == kSkyTree) return read_array(section, model.sky_tree.nodes);
  if (id == kSkyTreeShares) return read_array(section, model.sky_tree.shares);
  if (id == kTopTree) return read_array(section, model.top_tree);
  if (id == kTopParts) return read_array(section, model.top_parts);
  if (id == kMaterials) return read_materials(section, model);
  if (id == kNodes) return read_nodes(section, model);
  if (id == kLights) return read_records<Light>(section, model.lights, read_light);
  if (id == kOccluderPositions) return read_array(section, occluders.positions);
  if (id == kOccluderTriangles) return read_array(section, occluders.triangles);
  if (id == kOccluderMaterials) return read_array(section, occluders.material);
  if (id == kOccluderNodes) return read_array(section, occluders.node);
  if (id == kOccluderSystems) return read_array(section, occluders.system);
  if (id == kOccluderFrontUv) return read_array(section, occluders.front_uv);
  if (id == kOccluderBackUv) return read_array(section, occluders.back_uv);
  if (id == kOpacityMaps) return read_array(section, occluders.opacity.maps);
  if (id == kOpacityTexels) return read_array(section, occluders.opacity.texels);
  if (id == kOpacityTriangles) return read_array(section, occluders.opacity.triangles);
  if (id == kTextureTriangles) return read_array(section, occluders.texture);
  if (id == kBvhNodes) return read_array(section, occluders.bvh.nodes);
  if (id == kBvhTriangles) return read_array(section, occluders.bvh.triangles);
  if (id == kProbeVolume) return read_probe_volume(section, model.probe_volume);
  if (id == kProbeVolumeNodes) return read_array(section, model.probe_volume.nodes);
  if (id == kProbeVolumeCells) return read_array(section, model.probe_volume.cells);
  if (id == kProbeVolumePlanes) return read_array(section, model.probe_volume.planes);
  if (id != kSensorNames && id != kProbeNames) return std::nullopt;
  return read_records<std::string>(section, id == kSensorNames ? model.sensor_names : model.probe_names,
                                   [](ByteReader& reader) { return reader.take_string(); });
}

/// nullopt: no section of a system that this version knows.
std::optional<Result<void>> read_system_section(const Section& section, System& system) {
  const std::string_view id = id_of(section);
  if (id == kSystem) return read_system_head(section, system);
  if (id == kClusters) return read_array(section, system.clusters);
  if (id == kElements) return read_array(section, system.elements);
  if (id == kPieces) return read_array(section, system.pieces);
  if (id == kOwnPatches) return read_array(section, system.own_patches);
  if (id == kLumels) return read_array(section, system.lumels);
  if (id == kSensors) return read_array(section, system.sensors);
  if (id == kLiftedSensors) return read_array(section, system.lifted_sensors);
  if (id == kProbes) return read_array(section, system.probes);
  if (id == kProbeSenders) return read_array(section, system.probe_senders);
  if (id == kCharts) return read_array(section, system.charts);
  if (id == kTree) return read_array(section, system.tree.nodes);
  if (id == kTreeShares) return read_array(section, system.tree.shares);
  if (id == kImports) return read_array(section, system.imports);
  if (id == kClusterRays) return read_array(section, system.rays);
  if (id == kCutErrors) return read_array(section, system.cut_errors);
  if (id == kBounceHalvings) return read_array(section, system.bounce_halvings);
  if (id == kGatherHalvings) return read_array(section, system.gather_halvings);
  if (id == kBounceBlock) return read_block(section, system.bounce);
  if (id == kGatherBlock) return read_block(section, system.gather);
  if (id == kGatherDirections) return read_directions(section, system.gather);
  return std::nullopt;
}

Result<void> read_section(const Section& section, Model& model) {
  const SectionRecord& record = section.record;
  const bool of_model = record.owner == kNone;
  std::optional<Result<void>> done;
  if (of_model || record.owner < model.systems.size()) {
    done = of_model ? read_model_section(section, model)
                    : read_system_section(section, model.systems[record.owner]);
  }
  if (done) return *done;
  if ((record.flags & kSectionOptional) != 0) return {};
  return malformed(record, "expected a section that this version of Relume knows, or one marked as optional");
}

/// Sections are in one order: by owner, and each but those of blocks of a matrix once. INFO comes first, SYST
/// first in its system.
Result<void> check_order(const std::vector<Section>& sections) {
  if (sections.empty() || id_of(sections.front()) != kInfo || sections.front().record.owner != kNone) {
    return fail(ErrorCode::bad_input, "expected INFO as the first section");
  }
  std::uint32_t systems = 0;
  for (std::size_t index = 1; index < sections.size(); ++index) {
    const SectionRecord& record = sections[index].record;
    const std::string_view id = id_of(sections[index]);
    if (record.owner == systems && id == kSystem) {
      ++systems;
    } else if (systems == 0 ? record.owner != kNone : record.owner != systems - 1) {
      return malformed(record,
                       "expected sections of the model first, then those of each system in order, each "
                       "beginning with SYST");
    }
    if (id == kBounceBlock || id == kGatherBlock || id == kGatherDirections) continue;
    for (std::size_t before = index; before-- > 0 && sections[before].record.owner == record.owner;) {
      if (id_of(sections[before]) == id) return malformed(record, "expected it once");
    }
  }
  return {};
}

Result<Model> assemble(const std::vector<Section>& sections, const std::vector<bool>& chosen) {
  if (auto checked = check_order(sections); !checked) return tl::unexpected(checked.error());
  const SectionRecord& last = sections.back().record;
  const std::size_t systems = last.owner == kNone ? 0 : std::size_t{last.owner} + 1;
  Model model;
  if (auto done = read_info(sections.front(), systems, model); !done) return tl::unexpected(done.error());
  for (const Section& section : std::span(sections).subspan(1)) {
    if (auto done = read_section(section, model); !done) return tl::unexpected(done.error());
  }
  for (std::size_t index = 0; index < systems; ++index) {
    System& system = model.systems[index];
    if (!chosen.empty() && !chosen[index]) {
      const std::string system_name = system.name;
      system = {};
      system.name = system_name;
      system.loaded = false;
    }
    system.bounce.columns = static_cast<std::uint32_t>(system.imports.size());
    system.gather.columns = system.bounce.columns;
    // Nodes of systems that are not there have leaves that nobody knows.
    if (!chosen.empty()) system.bounce_halvings.clear(), system.gather_halvings.clear();
  }
  return model;
}

}  // namespace

Result<std::string> decode_system_name(const Section& section) {
  System system;
  if (auto done = read_system_head(section, system); !done) return tl::unexpected(done.error());
  return system.name;
}

Result<Model> decode_sections(const std::vector<Section>& sections, const std::vector<bool>& chosen,
                              const std::string& name) {
  auto model = assemble(sections, chosen);
  if (!model) return fail(model.error().code, name + ": " + model.error().message);
  if (auto checked = check_model(*model); !checked) {
    return fail(checked.error().code, name + ": " + checked.error().message);
  }
  return model;
}

Result<Model> decode_model(std::span<const std::byte> bytes, const std::string& name) {
  try {
    const auto sections = read_sections(bytes, name);
    if (!sections) return tl::unexpected(sections.error());
    return decode_sections(*sections, {}, name);
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::out_of_memory,
        fmt::format("{}: memory ran out: expected about {} bytes beside those of the file, found less", name,
                    bytes.size()));
  }
}

}  // namespace relume
