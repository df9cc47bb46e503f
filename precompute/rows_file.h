// SPDX-License-Identifier: MIT
//
// A .rows file: what every ray of a precompute met, by names that outlive changes of the scene, so that the
// next precompute need not trace again what nothing stands in the way of (src/FILE_FORMAT.md, section 5).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/file_parts.h"
#include "core/result.h"
#include "core/section_table.h"
#include "precompute/ray_codes.h"

namespace relume {

/// What rays asked of the scene. Stored.
struct RowsSettings {
  std::uint32_t version = 3;  ///< of these sections, and of what they know of cells
  float offset = 0.0f;        ///< m, that rays are lifted by
  std::uint64_t seed = 0;
  double texel_size = 0.0, cluster_size = 0.0;  ///< m
  glm::dvec3 origin{0.0};
  std::uint64_t emitters = 0;  ///< key of the possible emitters that samples were drawn from
};
static_assert(sizeof(RowsSettings) == 64);

/// A ray that met a possible emitter. Stored.
struct EmitterHit {
  std::uint32_t ray = 0;                 ///< which point of the sequence
  float distance = 0.0f, cosine = 0.0f;  ///< m; of the angle to its normal there, above 0
};
static_assert(sizeof(EmitterHit) == 12);

/// How much is known of one receiver. Stored.
struct ReceiverRecord {
  std::uint64_t identity = 0;  ///< Receiver::identity, or of a probe
  std::uint32_t rays = 0;      ///< codes, one for each point of the sequence
  std::uint32_t samples = 0;   ///< of emitters' area
  std::uint32_t emitter_hits = 0;
  std::uint32_t reserved = 0;  ///< zero
};
static_assert(sizeof(ReceiverRecord) == 24);

/// Points that the rig (rig.h) looks around from: the middles of cells of this edge, from `lower` on, x
/// fastest. Stored.
struct LookGrid {
  glm::vec3 lower{0.0f};
  float step = 0.0f;  ///< m; 0: there are none
  glm::ivec3 size{1};
  std::uint32_t reserved = 0;  ///< zero

  bool operator==(const LookGrid&) const = default;
  std::size_t points() const {
    return step > 0.0f ? std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z) : 0;
  }
};
static_assert(sizeof(LookGrid) == 32);

/// What the rays of such a point met, the first in the lowest bit. Stored.
struct PointLook {
  std::uint64_t escaped = 0, back = 0;
  std::uint32_t rays = 0;      ///< traced
  std::uint32_t reserved = 0;  ///< zero
};
static_assert(sizeof(PointLook) == 24);

/// A sample of an emitter's area, in two bits.
enum class SampleState : std::uint8_t {
  unknown,
  foreign /**< its origin is not the receiver's */,
  hidden,
  visible
};

/// Samples are stored four to a byte, lowest bits first.
inline constexpr std::uint32_t kSamplesPerByte = 4;

struct RowsFile {
  RowsSettings settings;
  std::string scene_file, ray_tracer;
  std::vector<std::string> nodes;  ///< paths
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint64_t> triangle_keys;  ///< geometry_keys.h
  std::vector<std::uint32_t> triangle_nodes;
  std::vector<std::uint8_t> ties;    ///< per triangle: RayCaster::ties
  std::vector<std::uint8_t> hollow;  ///< per triangle: Geometry::hollow
  std::vector<std::uint64_t> element_keys;
  std::vector<std::uint8_t> whole_elements;  ///< per element: all of its light patches belong to it
  std::vector<std::uint64_t> views;          ///< answers about surroundings (views.h), ascending
  LookGrid look_grid;
  std::vector<PointLook> looks;               ///< per point of the grid
  std::vector<ReceiverRecord> receivers;      ///< ascending by identity
  std::span<const std::byte> codes;           ///< of all receivers; kCodePadding bytes follow
  std::span<const std::byte> samples;         ///< of all receivers; each begins a new byte
  std::span<const EmitterHit> emitter_hits;   ///< of all receivers, of each ascending by ray
  std::shared_ptr<const void> owner;          ///< of the bytes that these three may point into
  std::shared_future<Result<void>> arriving;  ///< of start_reading_rows

  /// Waits until codes, samples and hits of emitters may be read, where they are still on their way. Fails as
  /// read_rows does.
  Result<void> await_rays() const { return arriving.valid() ? arriving.get() : Result<void>(); }

  RayCodes ray_codes() const { return {std::uint32_t(triangles.size()), std::uint32_t(element_keys.size())}; }
};

/// The bytes of a .rows file.
std::vector<std::byte> encode_rows(const RowsFile& rows);

/// The same with codes that lie elsewhere, in parts that follow each other, the padding among them; they are
/// borrowed, and nothing else. `checksum` of them (core/section_table.h).
FileParts encode_rows(const RowsFile& rows, std::span<const std::span<const std::byte>> codes,
                      std::uint64_t checksum);

/// What follows the codes.
inline constexpr std::array<std::byte, kCodePadding> kCodesEnd{};

/// Verifies structure, checksums, sizes and order. `name` is used in messages.
Result<RowsFile> decode_rows(std::vector<std::byte> bytes, const std::string& name);
/// The same of sections that `owner` holds, but for their checksums. Of what rays met only sizes are looked
/// at.
Result<RowsFile> decode_rows(std::shared_ptr<const void> owner, const std::vector<Section>& sections,
                             const std::string& name);

/// Whether it says what rays met: codes, samples or hits of emitters.
bool is_of_rays(const SectionRecord& section);

/// decode_rows of a file. Fails (bad_input) also when it cannot be read.
Result<RowsFile> read_rows(const std::filesystem::path& file);
/// The same where others need not wait for what rays met (RowsFile::await_rays), nearly all of the file: by
/// std::launch::async a thread of its own reads it.
Result<RowsFile> start_reading_rows(const std::filesystem::path& file, std::launch policy);

}  // namespace relume
