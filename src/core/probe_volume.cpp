// SPDX-License-Identifier: MIT
#include "core/probe_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relume {
namespace {

/// A cell and where a point lies in it.
struct CellPoint {
  std::uint32_t node = kNoProbe;
  glm::vec3 edges{0.0f};   ///< m
  glm::vec3 within{0.0f};  ///< 0 to 1
};

CellPoint find_cell(const ProbeVolume& volume, const glm::vec3& point) {
  const glm::vec3 counts(float(volume.counts[0]), float(volume.counts[1]), float(volume.counts[2]));
  const glm::vec3 at = glm::clamp((point - volume.lower) / volume.edges, glm::vec3(0.0f), counts);
  const glm::vec3 root = glm::min(glm::floor(at), counts - 1.0f);
  const auto index = std::uint32_t(root.x) +
                     volume.counts[0] * (std::uint32_t(root.y) + volume.counts[1] * std::uint32_t(root.z));
  CellPoint found{volume.nodes[index], volume.edges, at - root};
  while ((found.node & kProbeCellBit) == 0) {
    const auto axis = int(found.node >> kProbeAxisShift);
    const float twice = 2.0f * found.within[axis];
    const bool upper = twice >= 1.0f;
    found.within[axis] = upper ? twice - 1.0f : twice;
    found.edges[axis] *= 0.5f;
    found.node = volume.nodes[(found.node & kProbeChildMask) + (upper ? 1u : 0u)];
  }
  return found;
}

float corner_weight(const glm::vec3& within, std::uint32_t corner) {
  const float x = (corner & 1u) != 0 ? within.x : 1.0f - within.x;
  const float y = (corner & 2u) != 0 ? within.y : 1.0f - within.y;
  const float z = (corner & 4u) != 0 ? within.z : 1.0f - within.z;
  return std::max(x * y * z, kLeastCornerWeight);
}

template <class Element>
void append(const std::vector<Element>& elements, std::vector<std::uint32_t>& words) {
  static_assert(sizeof(Element) % sizeof(std::uint32_t) == 0);
  const std::size_t first = words.size();
  words.resize(first + elements.size() * sizeof(Element) / sizeof(std::uint32_t));
  if (!elements.empty())
    std::memcpy(words.data() + first, elements.data(), elements.size() * sizeof(Element));
}

}  // namespace

std::array<float, 8> corner_weights(const ProbeCell& cell, std::span<const glm::vec4> planes,
                                    const glm::vec3& edges, const glm::vec3& point, const glm::vec3& within) {
  std::array<float, 8> weights{};
  for (std::uint32_t c = 0; c < 8; ++c) {
    if (cell.probes[c] != kNoProbe) weights[c] = corner_weight(within, c);
  }
  for (std::uint32_t p = 0; p < planes.size(); ++p) {
    const glm::vec3 normal(planes[p]);
    const float share =
        (glm::dot(normal, point) + planes[p].w) / (kProbeFade * glm::dot(glm::abs(normal), edges));
    for (std::uint32_t c = 0; c < 8; ++c) {
      if ((cell.sides[c] >> p & 1u) != 0) weights[c] *= std::clamp(share, 0.0f, 1.0f);
      if ((cell.sides[c] >> (8 + p) & 1u) != 0) weights[c] *= std::clamp(-share, 0.0f, 1.0f);
    }
  }
  return weights;
}

WeightedProbes probes_at(const ProbeVolume& volume, const glm::vec3& point) {
  WeightedProbes result;
  result.probes.fill(kNoProbe);
  if (volume.nodes.empty()) return result;
  const CellPoint at = find_cell(volume, point);
  if (at.node == kNoProbe) return result;
  const ProbeCell& cell = volume.cells[at.node & ~kProbeCellBit];
  result.probes = cell.probes;
  const auto planes = std::span(volume.planes).subspan(cell.first_plane, cell.plane_count);
  result.weights = corner_weights(cell, planes, at.edges, point, at.within);
  float sum = 0.0f;
  for (const float weight : result.weights) sum += weight;
  for (float& weight : result.weights) weight = sum > 0.0f ? weight / sum : 0.0f;
  return result;
}

std::vector<std::uint32_t> probe_volume_words(const ProbeVolume& volume) {
  if (volume.nodes.empty()) return {};
  const auto first_cell = std::uint32_t(kProbeVolumeHeader + volume.nodes.size());
  const auto first_plane =
      std::uint32_t(first_cell + volume.cells.size() * sizeof(ProbeCell) / sizeof(std::uint32_t));
  std::vector<std::uint32_t> words;
  for (int axis = 0; axis < 3; ++axis) words.push_back(std::bit_cast<std::uint32_t>(volume.lower[axis]));
  for (int axis = 0; axis < 3; ++axis) words.push_back(std::bit_cast<std::uint32_t>(volume.edges[axis]));
  words.insert(words.end(), volume.counts.begin(), volume.counts.end());
  words.insert(words.end(), {first_cell, first_plane, 0u});
  append(volume.nodes, words);
  append(volume.cells, words);
  append(volume.planes, words);
  return words;
}

}  // namespace relume
