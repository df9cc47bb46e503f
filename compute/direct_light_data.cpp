// SPDX-License-Identifier: MIT
#include "compute/direct_light_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include "core/light_patches.h"

namespace relume {
namespace {

constexpr std::uint32_t kBlockPatches = 512;  // more only when a single element has them
/// The next cluster joins a block when it lies no further from its middle than so many of its radii, and its
/// normals differ by no more than this.
constexpr double kJoinRadii = 2.0;
constexpr double kJoinNormals = 0.5;

float as_float(std::uint32_t bits) {
  return std::bit_cast<float>(bits);
}

kernels::vec4 corner(const glm::dvec3& p, std::uint32_t bits = 0) {
  return {float(p.x), float(p.y), float(p.z), as_float(bits)};
}

/// A block while elements are added, with the points and normals of its pieces.
class BlockFacts {
 public:
  void add(const glm::dvec3& point, const glm::dvec3& normal) {
    points_.push_back(point);
    normals_.push_back(normal);
  }

  /// Whether a point and normal of another cluster would make the block little larger.
  bool near(const glm::dvec3& point, const glm::dvec3& normal) const {
    LightBlock block;
    write(block);
    return glm::length(point - block.centre) <= kJoinRadii * block.radius &&
           glm::length(normal - block.axis) <= kJoinNormals;
  }

  void write(LightBlock& block) const {
    glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower, mean(0.0);
    for (const glm::dvec3& p : points_) lower = glm::min(lower, p), upper = glm::max(upper, p);
    for (const glm::dvec3& n : normals_) mean += n;
    block.centre = 0.5 * (lower + upper);
    const double length = glm::length(mean);
    block.axis = length > 0.0 ? mean / length : glm::dvec3(0.0, 0.0, 1.0);
    block.lowest = std::numeric_limits<double>::infinity();
    block.highest = -block.lowest;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      block.radius = std::max(block.radius, glm::length(points_[i] - block.centre));
      block.spread = std::max(block.spread, glm::length(normals_[i] - block.axis));
      block.lowest = std::min(block.lowest, glm::dot(block.axis, points_[i]));
      block.highest = std::max(block.highest, glm::dot(block.axis, points_[i]));
    }
  }

 private:
  std::vector<glm::dvec3> points_, normals_;
};

/// Adds one system after the other.
class SurfaceWriter {
 public:
  SurfaceWriter(const Model& model, double patches_per_element)
      : model_(model), patches_per_element_(patches_per_element) {}

  void add(const System& system) {
    const auto first_element = static_cast<std::uint32_t>(out_.elements.size());
    const auto first_cluster = static_cast<std::uint32_t>(out_.clusters.size() / 2);
    std::size_t patch = 0;
    cluster_areas_.assign(system.clusters.size(), 0.0);
    for (const SurfaceElement& element : system.elements) cluster_areas_[element.cluster] += element.area;
    for (const SurfaceElement& element : system.elements) add_element(system, element, first_cluster, patch);
    for (const Cluster& cluster : system.clusters) {
      out_.clusters.push_back(first_element + cluster.first_element);
      out_.clusters.push_back(cluster.element_count);
    }
    for (const Lumel& lumel : system.lumels) out_.gather_rows.push_back(first_element + lumel.element);
    for (std::size_t i = 0; i < system.sensors.size(); ++i) {
      out_.gather_rows.push_back(static_cast<std::uint32_t>(out_.elements.size()));
      add_sensor(glm::dvec3(system.lifted_sensors[i]), glm::normalize(glm::dvec3(system.sensors[i].normal)));
    }
    close_block();
  }

  LightSurfaces finish() && { return std::move(out_); }

 private:
  void add_element(const System& system, const SurfaceElement& element, std::uint32_t first_cluster,
                   std::size_t& next_patch) {
    const auto first_piece = static_cast<std::uint32_t>(out_.pieces.size());
    const ElementPatches own = own_patches(model_, system, element, next_patch, patches_per_element_);
    next_patch += own.stored_count;
    std::vector<std::uint32_t> patches;
    double area = 0.0;
    for (const ElementPatches::Patch& patch : own.patches) {
      const ElementPatches::Piece& piece = own.pieces[patch.piece];
      patches.push_back((first_piece + patch.piece) << 4 | static_cast<std::uint32_t>(patch.index));
      area += area_of(patch_of_piece(piece.whole, piece.rows, patch.index).corners);
    }
    std::vector<std::pair<glm::dvec3, glm::dvec3>> facts;
    for (const ElementPatches::Piece& piece : own.pieces) {
      const auto& [a, b, c] = piece.whole.corners;
      const std::uint32_t flags = std::uint32_t(piece.rows) | (own.lost_some ? kernels::kPieceUncut : 0);
      for (const glm::dvec3& at : piece.whole.corners) facts.emplace_back(at, piece.whole.normal);
      out_.pieces.push_back(
          {corner(a, flags), corner(b, piece.whole.key), corner(c), corner(piece.whole.normal)});
    }
    const std::uint32_t cluster = first_cluster + element.cluster;
    const bool joins = block_.element_count == 0 || cluster + 1 == block_.end_cluster ||
                       facts_.near(glm::dvec3(element.position), glm::dvec3(element.normal));
    if (!joins) close_block();
    start_element(static_cast<std::uint32_t>(patches.size()), cluster);
    for (const auto& [point, normal] : facts) facts_.add(point, normal);
    push_element(patches, area, element.area / cluster_areas_[element.cluster], cluster);
  }

  void add_sensor(const glm::dvec3& point, const glm::dvec3& normal) {
    const auto piece = static_cast<std::uint32_t>(out_.pieces.size());
    out_.pieces.push_back({corner(point, kernels::kPieceSensor), {}, {}, corner(normal)});
    start_element(1, kNone);
    facts_.add(point, normal);
    push_element({piece << 4}, 1.0, 0.0, kNone);
  }

  /// Closes the block when the element does not fit or is of another kind.
  void start_element(std::uint32_t patches, std::uint32_t cluster) {
    const bool sensors = block_.end_cluster == block_.first_cluster;
    if (block_.element_count > 0 &&
        (block_.element_count == kernels::kBlockElements || block_.patch_count + patches > kBlockPatches ||
         sensors != (cluster == kNone)))
      close_block();
    if (block_.element_count == 0) {
      block_.first_element = static_cast<std::uint32_t>(out_.elements.size());
      block_.first_cluster = block_.end_cluster = cluster == kNone ? 0 : cluster;
    }
    if (cluster != kNone) block_.end_cluster = cluster + 1;
    ++block_.element_count;
    block_.patch_count += patches;
  }

  void push_element(const std::vector<std::uint32_t>& patches, double area, double weight,
                    std::uint32_t cluster) {
    kernels::LightElement element{};
    element.first_patch = static_cast<std::uint32_t>(out_.patches.size());
    element.patch_count = static_cast<std::uint32_t>(patches.size());
    element.inverse_area = area > 0.0 ? float(1.0 / area) : 0.0f;
    element.weight = float(weight);
    element.cluster = cluster == kNone ? 0 : cluster;
    out_.elements.push_back(element);
    out_.patches.insert(out_.patches.end(), patches.begin(), patches.end());
  }

  void close_block() {
    if (block_.element_count == 0) return;
    facts_.write(block_);
    out_.blocks.push_back(block_);
    block_ = {};
    facts_ = {};
  }

  const Model& model_;
  double patches_per_element_;
  LightSurfaces out_;
  std::vector<double> cluster_areas_;  ///< of the system that is added
  LightBlock block_;
  BlockFacts facts_;
};

}  // namespace

LightSurfaces light_surfaces(const Model& model, const std::vector<std::uint32_t>& systems,
                             double patches_per_element) {
  SurfaceWriter writer(model, patches_per_element);
  for (const std::uint32_t system : systems) writer.add(model.systems[system]);
  return std::move(writer).finish();
}

LightTables light_tables(const LightSurfaces& surfaces) {
  LightTables tables;
  for (const LightBlock& block : surfaces.blocks) {
    tables.words.push_back(block.first_element);
    tables.words.push_back(block.element_count);
  }
  tables.clusters = static_cast<std::uint32_t>(tables.words.size());
  tables.words.insert(tables.words.end(), surfaces.clusters.begin(), surfaces.clusters.end());
  tables.gather_rows = static_cast<std::uint32_t>(tables.words.size());
  tables.words.insert(tables.words.end(), surfaces.gather_rows.begin(), surfaces.gather_rows.end());
  return tables;
}

std::vector<kernels::uvec4> leaf_triangles(const Occluders& occluders) {
  std::vector<std::uint32_t> listed(occluders.triangles.size(), 0);
  for (std::uint32_t i = 0; i < occluders.opacity.triangles.size(); ++i)
    listed[occluders.opacity.triangles[i].triangle] = i + 1;
  std::vector<kernels::uvec4> corners;
  for (const std::uint32_t triangle : occluders.bvh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = occluders.positions[occluders.triangles[triangle][k]];
      corners.push_back({std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                         std::bit_cast<std::uint32_t>(p.z), k == 0 ? listed[triangle] : 0});
    }
  }
  return corners;
}

std::vector<std::uint32_t> opacity_words(const Opacity& opacity) {
  std::vector<std::uint32_t> words(2);
  const auto append = [&words](const auto& values) {
    const std::span bytes = std::as_bytes(std::span(values));
    const std::size_t first = words.size();
    words.resize(first + (bytes.size() + 3) / 4);
    if (!bytes.empty()) std::memcpy(&words[first], bytes.data(), bytes.size());
    return static_cast<std::uint32_t>(first);
  };
  append(opacity.triangles);
  words[0] = append(opacity.maps);
  words[1] = append(opacity.texels);
  return words;
}

kernels::LightRecord light_record(const Light& light) {
  const double inner = std::cos(light.inner_cone_angle), outer = std::cos(light.outer_cone_angle);
  kernels::LightRecord record{};
  record.position = {float(light.position.x), float(light.position.y), float(light.position.z),
                     float(light.range)};
  record.direction = corner(light.direction, static_cast<std::uint32_t>(light.type));
  record.intensity = {float(light.intensity.x), float(light.intensity.y), float(light.intensity.z), 0.0f};
  record.cone = {float(outer), float(1.0 / std::max(0.001, inner - outer)),
                 float(std::sin(light.outer_cone_angle)), float(max_patch_solid_angle(light))};
  return record;
}

}  // namespace relume
