// SPDX-License-Identifier: MIT
#include "precompute/emitters.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/quantities.h"

namespace relume {
namespace {

void add_element(const Geometry& geometry, const SystemSurface& surface, const Element& element, Side side,
                 Emitter& emitter) {
  emitter.material = element.material;
  emitter.centroid += element.position * element.area;
  emitter.normal += element.normal * element.area;
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    const Piece& piece = surface.pieces[element.first_piece + p];
    const SurfacePiece& shape = piece.shape;
    std::array<glm::vec3, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = geometry.point(shape.triangle, shape.corners[k].x, shape.corners[k].y);
    emitter.area += piece.area;
    emitter.points.add(corners, geometry.normal(shape.triangle, side), piece.area);
  }
}

void finish(const SystemSurface& surface, const std::vector<std::uint32_t>& elements, Emitter& emitter) {
  emitter.centroid /= float(emitter.area);
  emitter.normal /= float(emitter.area);
  for (const auto e : elements) {
    const Element& element = surface.elements[e];
    emitter.radius =
        std::max(emitter.radius, glm::length(element.position - emitter.centroid) + std::sqrt(element.area));
  }
}

/// Upper estimate of the unoccluded form factor from the receiver's middle to the emitter: cosines as large
/// as the sizes of both allow.
double estimate(const Emitter& emitter, const Receiver& receiver) {
  const glm::vec3 to = emitter.centroid - receiver.middle().position;
  const float reach = emitter.radius + receiver.radius();
  const float distance = std::max(glm::length(to), 1e-12f);
  const glm::vec3 direction = to / distance;
  const float slack = std::min(1.0f, reach / distance);
  const float bend = 1.0f - std::min(1.0f, glm::length(emitter.normal));
  const float cos_receiver = std::clamp(glm::dot(direction, receiver.middle().normal) + slack, 0.0f, 1.0f);
  const float cos_emitter = std::clamp(-glm::dot(direction, emitter.normal) + slack + bend, 0.0f, 1.0f);
  const double squared = std::max(double(distance) * distance, emitter.area / kPi);
  return std::min(1.0, emitter.area * cos_receiver * cos_emitter / (kPi * squared));
}

}  // namespace

Emitters find_emitters(const Geometry& geometry, const std::vector<Chart>& charts,
                       const std::vector<ClusteredSurface>& systems, const std::vector<bool>& material_emits,
                       const std::vector<bool>& node_emits) {
  Emitters emitters;
  for (const ClusteredSurface& system : systems) {
    emitters.of_cluster.resize(system.first_cluster + system.cluster_count, kNone);
    std::vector<std::vector<std::uint32_t>> members(system.cluster_count);
    for (std::uint32_t e = 0; e < system.surface.elements.size(); ++e) {
      const Element& element = system.surface.elements[e];
      if (!material_emits[element.material] && !node_emits[charts[element.chart].node]) continue;
      members[system.cluster[e]].push_back(e);
    }
    for (std::uint32_t c = 0; c < system.cluster_count; ++c) {
      if (members[c].empty()) continue;
      Emitter emitter;
      emitter.cluster = system.first_cluster + c;
      for (const auto e : members[c]) {
        const Element& element = system.surface.elements[e];
        add_element(geometry, system.surface, element, charts[element.chart].side, emitter);
      }
      finish(system.surface, members[c], emitter);
      emitters.of_cluster[emitter.cluster] = std::uint32_t(emitters.list.size());
      emitters.list.push_back(std::move(emitter));
    }
  }
  return emitters;
}

void renumber(const std::vector<std::uint32_t>& numbers, Emitters& emitters) {
  std::fill(emitters.of_cluster.begin(), emitters.of_cluster.end(), kNone);
  for (std::uint32_t e = 0; e < emitters.list.size(); ++e) {
    emitters.list[e].cluster = numbers[emitters.list[e].cluster];
    emitters.of_cluster[emitters.list[e].cluster] = e;
  }
}

std::size_t EmitterChoice::choose(float& u) const {
  const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, double(u));
  const auto index = std::size_t(found - cumulative.begin());
  const double below = index > 0 ? cumulative[index - 1] : 0.0;
  const double stretched = probability[index] > 0.0 ? (double(u) - below) / probability[index] : 0.0;
  u = std::clamp(float(stretched), 0.0f, 0.99999994f);
  return index;
}

void choose_emitters(const Emitters& emitters, const Receiver& receiver, EmitterChoice& choice) {
  choice.probability.clear();
  choice.cumulative.clear();
  double sum = 0.0;
  for (const Emitter& emitter : emitters.list) {
    choice.probability.push_back(estimate(emitter, receiver));
    sum += choice.probability.back();
  }
  const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
  double below = 0.0;
  for (double& probability : choice.probability) {
    probability *= scale;
    choice.cumulative.push_back(below += probability);
  }
}

}  // namespace relume
