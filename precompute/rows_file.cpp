// SPDX-License-Identifier: MIT
#include "precompute/rows_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/vector_relational.hpp>

#include "core/section_table.h"

namespace relume {
namespace {

constexpr std::uint32_t kWhole = 0xffffffffu;  ///< owner of all sections
constexpr std::uint32_t kVersion = 3;

std::vector<std::byte> texts(const std::vector<std::string>& strings) {
  std::vector<std::byte> bytes;
  for (const std::string& text : strings) {
    const auto length = std::uint32_t(text.size());
    const auto* head = reinterpret_cast<const std::byte*>(&length);
    bytes.insert(bytes.end(), head, head + sizeof length);
    const auto* body = reinterpret_cast<const std::byte*>(text.data());
    bytes.insert(bytes.end(), body, body + text.size());
  }
  return bytes;
}

std::size_t sample_bytes(const ReceiverRecord& receiver) {
  return (std::size_t{receiver.samples} + kSamplesPerByte - 1) / kSamplesPerByte;
}

/// Sections by their names; what is missing is empty.
class Reader {
 public:
  Reader(const std::vector<Section>& sections, const std::string& name) : sections_(sections), name_(name) {}

  tl::unexpected<Error> bad(const std::string& what) const {
    return fail(ErrorCode::bad_input, fmt::format("{}: {}", name_, what));
  }
  std::span<const std::byte> bytes(std::string_view id) const {
    for (const Section& section : sections_) {
      if (std::string_view(section.record.id.data(), 4) == id) return section.bytes;
    }
    return {};
  }
  template <class T>
  bool read(std::string_view id, std::vector<T>& values) const {
    const auto found = bytes(id);
    if (found.size() % sizeof(T) != 0) return false;
    values.resize(found.size() / sizeof(T));
    if (!found.empty()) std::memcpy(values.data(), found.data(), found.size());
    return true;
  }
  bool read(std::string_view id, std::vector<std::string>& strings) const {
    auto rest = bytes(id);
    while (!rest.empty()) {
      std::uint32_t length = 0;
      if (rest.size() < sizeof length) return false;
      std::memcpy(&length, rest.data(), sizeof length);
      rest = rest.subspan(sizeof length);
      if (rest.size() < length) return false;
      strings.emplace_back(reinterpret_cast<const char*>(rest.data()), length);
      rest = rest.subspan(length);
    }
    return true;
  }

 private:
  const std::vector<Section>& sections_;
  const std::string& name_;
};

/// Whether the scene makes sense by itself.
bool sound_scene(const RowsFile& rows) {
  const std::size_t triangles = rows.triangles.size();
  if (rows.triangle_keys.size() != triangles || rows.triangle_nodes.size() != triangles) return false;
  if (!rows.ties.empty() && rows.ties.size() != triangles) return false;
  if (!rows.hollow.empty() && rows.hollow.size() != triangles) return false;
  if (rows.whole_elements.size() != rows.element_keys.size()) return false;
  if (!std::is_sorted(rows.views.begin(), rows.views.end())) return false;
  if (glm::any(glm::lessThan(rows.look_grid.size, glm::ivec3(1)))) return false;
  if (rows.look_grid.points() != rows.looks.size()) return false;
  for (const glm::vec3& p : rows.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
  }
  for (const auto& triangle : rows.triangles) {
    for (const auto corner : triangle) {
      if (corner >= rows.positions.size()) return false;
    }
  }
  return std::all_of(rows.triangle_nodes.begin(), rows.triangle_nodes.end(),
                     [&](std::uint32_t node) { return node < rows.nodes.size(); }) &&
         rows.ray_codes().count() < kWhole;
}

/// Whether receivers ascend and what is known of them is there.
bool sound_receivers(const RowsFile& rows) {
  std::uint64_t codes = 0, samples = 0, hits = 0;
  for (std::size_t i = 0; i < rows.receivers.size(); ++i) {
    const ReceiverRecord& receiver = rows.receivers[i];
    if (i > 0 && rows.receivers[i - 1].identity >= receiver.identity) return false;
    codes += receiver.rays, samples += sample_bytes(receiver), hits += receiver.emitter_hits;
  }
  return codes * rows.ray_codes().width() + kCodePadding == rows.codes.size() &&
         samples == rows.samples.size() && hits == rows.emitter_hits.size();
}

Result<void> read_settings(const Reader& reader, RowsFile& rows) {
  const auto settings = reader.bytes("RINF");
  if (settings.size() < sizeof rows.settings.version)
    return reader.bad("expected a .rows file, found another: it has no section 'RINF'");
  std::memcpy(&rows.settings.version, settings.data(), sizeof rows.settings.version);
  if (rows.settings.version != kVersion) {
    return reader.bad(fmt::format("section 'RINF': expected version {} of the rows, found {}", kVersion,
                                  rows.settings.version));
  }
  if (settings.size() != sizeof rows.settings) {
    return reader.bad(
        fmt::format("section 'RINF': expected {} bytes, found {}", sizeof rows.settings, settings.size()));
  }
  std::memcpy(&rows.settings, settings.data(), sizeof rows.settings);
  return {};
}

Result<void> read_all(const Reader& reader, RowsFile& rows) {
  if (auto read = read_settings(reader, rows); !read) return read;
  std::vector<std::string> names;
  std::vector<LookGrid> grids;
  const bool whole = reader.read("RNAM", names) && reader.read("RNOD", rows.nodes) &&
                     reader.read("RPOS", rows.positions) && reader.read("RTRI", rows.triangles) &&
                     reader.read("RTKY", rows.triangle_keys) && reader.read("RTND", rows.triangle_nodes) &&
                     reader.read("RTIE", rows.ties) && reader.read("RHOL", rows.hollow) &&
                     reader.read("RELM", rows.element_keys) && reader.read("RWHL", rows.whole_elements) &&
                     reader.read("RVWS", rows.views) && reader.read("RGRD", grids) &&
                     reader.read("RLKS", rows.looks) && grids.size() <= 1 &&
                     reader.read("RRCV", rows.receivers) && names.size() == 2;
  if (!whole) return reader.bad("expected sections of whole entries, found one that ends inside an entry");
  if (!grids.empty()) rows.look_grid = grids[0];
  rows.scene_file = names[0], rows.ray_tracer = names[1];
  const auto hits = reader.bytes("REMH");
  rows.codes = reader.bytes("RCOD"), rows.samples = reader.bytes("RSMP");
  if (hits.size() % sizeof(EmitterHit) != 0 || !sound_scene(rows))
    return reader.bad("expected a scene whose numbers fit together, found one that does not");
  rows.emitter_hits = {reinterpret_cast<const EmitterHit*>(hits.data()), hits.size() / sizeof(EmitterHit)};
  if (!sound_receivers(rows))
    return reader.bad(
        "sections 'RRCV', 'RCOD', 'RSMP', 'REMH': expected as many rays as receivers have, found others");
  return {};
}

}  // namespace

std::vector<std::byte> encode_rows(const RowsFile& rows) {
  const std::span<const std::span<const std::byte>> codes(&rows.codes, 1);
  return encode_rows(rows, codes, checksum_of(codes)).joined();
}

FileParts encode_rows(const RowsFile& rows, std::span<const std::span<const std::byte>> codes,
                      std::uint64_t checksum) {
  SectionWriter writer;
  const auto add = [&](std::string_view id, const auto& values, std::uint32_t flags = 0) {
    writer.add(id, kWhole, std::as_bytes(std::span(values)), flags);
  };
  add("RINF", std::span(&rows.settings, 1));
  add("RNAM", texts({rows.scene_file, rows.ray_tracer}));
  add("RNOD", texts(rows.nodes));
  add("RPOS", rows.positions);
  add("RTRI", rows.triangles);
  add("RTKY", rows.triangle_keys);
  add("RTND", rows.triangle_nodes);
  add("RTIE", rows.ties);
  add("RHOL", rows.hollow);
  add("RELM", rows.element_keys);
  add("RWHL", rows.whole_elements);
  add("RVWS", rows.views, kSectionOptional);
  if (!rows.looks.empty()) add("RGRD", std::span(&rows.look_grid, 1), kSectionOptional);
  add("RLKS", rows.looks, kSectionOptional);
  add("RRCV", rows.receivers);
  writer.borrow("RCOD", kWhole, codes, 0, checksum);
  add("RSMP", rows.samples);
  add("REMH", rows.emitter_hits);
  return std::move(writer).finish_parts();
}

Result<RowsFile> decode_rows(std::vector<std::byte> bytes, const std::string& name) {
  const auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  const auto sections = read_sections(*owner, name);
  if (!sections) return tl::unexpected(sections.error());
  return decode_rows(owner, *sections, name);
}

Result<RowsFile> decode_rows(std::shared_ptr<const void> owner, const std::vector<Section>& sections,
                             const std::string& name) {
  RowsFile rows;
  rows.owner = std::move(owner);
  if (auto read = read_all(Reader(sections, name), rows); !read) return tl::unexpected(read.error());
  return rows;
}

bool is_of_rays(const SectionRecord& section) {
  const std::string_view id(section.id.data(), section.id.size());
  return id == "RCOD" || id == "RSMP" || id == "REMH";
}

}  // namespace relume
