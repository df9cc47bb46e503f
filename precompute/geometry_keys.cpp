// SPDX-License-Identifier: MIT
#include "precompute/geometry_keys.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "core/mix.h"
#include "precompute/key_index.h"

namespace relume {
namespace {

/// Numbers mixed one after the other.
class KeyMaker {
 public:
  explicit KeyMaker(std::uint64_t start = 0) : value_(start) {}
  KeyMaker& add(std::uint64_t number) {
    value_ = mix(value_, number);
    return *this;
  }
  KeyMaker& add(float a, float b) {
    return add(std::uint64_t{std::bit_cast<std::uint32_t>(a)} << 32 | std::bit_cast<std::uint32_t>(b));
  }
  KeyMaker& add(const glm::vec2& v) { return add(v.x, v.y); }
  KeyMaker& add(const glm::vec3& v) { return add(v.x, v.y).add(v.z, 0.0f); }
  /// 0 is nobody's.
  std::uint64_t value() const { return value_ == 0 ? 1 : value_; }

 private:
  std::uint64_t value_;
};

std::vector<std::uint64_t> map_keys(const Opacity& opacity) {
  std::vector<std::uint64_t> keys;
  for (const OpacityMap& map : opacity.maps) {
    KeyMaker key(std::uint64_t(map.rule));
    key.add(map.cutoff, map.solid).add(std::uint64_t{map.width} << 32 | map.height);
    key.add(std::uint64_t(map.wrap_s) << 32 | std::uint64_t(map.wrap_t));
    for (std::size_t i = 0; i < std::size_t{map.width} * map.height; ++i)
      key.add(opacity.texels[map.first_texel + i]);
    keys.push_back(key.value());
  }
  return keys;
}

std::uint64_t chart_key(const Geometry& geometry, const std::vector<std::uint64_t>& triangles,
                        const Chart& chart) {
  KeyMaker key(std::uint64_t(chart.side));
  key.add(std::uint64_t{chart.width} << 32 | chart.height);
  std::vector<std::uint32_t> materials;  // what counts is which triangles share one
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    const std::uint32_t material = geometry.material[chart.triangles[i]];
    const auto known = std::find(materials.begin(), materials.end(), material);
    key.add(triangles[chart.triangles[i]]).add(std::uint64_t(known - materials.begin()));
    if (known == materials.end()) materials.push_back(material);
    for (const glm::vec2& corner : chart.corners[i]) key.add(corner);
  }
  return key.value();
}

void forget_repeats(std::vector<std::uint64_t>& keys) {
  const KeyIndex index(keys);
  std::vector<std::uint32_t> repeats;
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    if (index.after(index.find(keys[i])) != kNone) repeats.push_back(i);
  }
  for (const std::uint32_t i : repeats) keys[i] = 0;
}

}  // namespace

std::vector<std::uint64_t> triangle_keys(const Geometry& geometry) {
  const Opacity& opacity = geometry.opacity.stored();
  const std::vector<std::uint64_t> maps = map_keys(opacity);
  std::vector<std::uint64_t> keys(geometry.triangles.size());
  for (std::size_t t = 0; t < keys.size(); ++t) {
    KeyMaker key(geometry.double_sided[geometry.material[t]] ? 2 : 1);
    for (const auto corner : geometry.triangles[t]) key.add(geometry.positions[corner]);
    keys[t] = key.add(geometry.normals[t]).value();
  }
  for (const OpacityTriangle& listed : opacity.triangles) {
    KeyMaker key(keys[listed.triangle]);
    key.add(maps[listed.map]);
    for (const glm::vec3& corner : listed.corners) key.add(corner);
    keys[listed.triangle] = key.value();
  }
  return keys;
}

ElementNamer::ElementNamer(const Geometry& geometry, const std::vector<std::uint64_t>& triangles,
                           const std::vector<Chart>& charts, const std::vector<AtlasLayout>& layouts)
    : triangles_(triangles), charts_(charts.size()), positions_(charts.size()) {
  for (const AtlasLayout& layout : layouts) {
    for (std::size_t i = 0; i < layout.charts.size(); ++i) positions_[layout.charts[i]] = layout.positions[i];
  }
  tbb::parallel_for(std::size_t{0}, charts.size(),
                    [&](std::size_t c) { charts_[c] = chart_key(geometry, triangles, charts[c]); });
}

std::uint64_t ElementNamer::key(std::uint32_t width, const Element& element, std::span<const Piece> pieces,
                                std::uint32_t number, std::uint32_t count) const {
  const glm::uvec2& position = positions_[element.chart];
  const std::uint32_t x = element.cell % width - position.x, y = element.cell / width - position.y;
  KeyMaker key(charts_[element.chart]);
  key.add(std::uint64_t{x} << 32 | y).add(std::uint64_t{number} << 32 | count);
  key.add((element.walled ? 1u : 0u) + (element.split ? 2u : 0u));
  for (const Piece& piece : pieces) {
    key.add(triangles_[piece.shape.triangle]);
    for (const glm::vec2& corner : piece.shape.corners) key.add(corner);
  }
  return key.value();
}

std::vector<std::uint64_t> element_keys(const ElementNamer& namer,
                                        const std::vector<ClusteredSurface>& surfaces) {
  std::vector<std::uint64_t> keys;
  for (const ClusteredSurface& system : surfaces) {
    const SystemSurface& surface = system.surface;
    const std::size_t first = keys.size();
    keys.resize(first + surface.elements.size());
    tbb::parallel_for(std::size_t{0}, surface.elements.size(), [&](std::size_t e) {
      const Element& element = surface.elements[e];
      const std::span pieces = std::span(surface.pieces).subspan(element.first_piece, element.piece_count);
      const std::uint32_t of_cell = surface.first_element[element.cell];
      keys[first + e] = namer.key(surface.width, element, pieces, std::uint32_t(e) - of_cell,
                                  surface.first_element[element.cell + 1] - of_cell);
    });
  }
  forget_repeats(keys);
  return keys;
}

std::uint64_t emitters_key(const Emitters& emitters) {
  KeyMaker key(emitters.list.size());
  for (const Emitter& emitter : emitters.list) {
    key.add(std::bit_cast<std::uint64_t>(emitter.area)).add(emitter.centroid).add(emitter.normal);
    key.add(emitter.radius, 0.0f);
    for (const Patch& patch : emitter.points.patches())
      key.add(patch.corner)
          .add(patch.edge1)
          .add(patch.edge2)
          .add(patch.frame.normal)
          .add(patch.area_below, 0.0f);
  }
  return key.value();
}

}  // namespace relume
