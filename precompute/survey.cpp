// SPDX-License-Identifier: MIT
#include "precompute/survey.h"

#include <algorithm>

#include "precompute/ray_recall.h"
#include "precompute/rooms.h"

namespace relume {
namespace {

std::vector<std::uint32_t> rooms_of(const std::vector<ClusteredSurface>& surfaces,
                                    const std::vector<FormFactorRow>& rows) {
  std::vector<glm::vec3> centroids(rows.size(), glm::vec3(0.0f));
  std::vector<float> areas(rows.size(), 0.0f);
  for (const ClusteredSurface& surface : surfaces) {
    for (std::size_t e = 0; e < surface.cluster.size(); ++e) {
      const Element& element = surface.surface.elements[e];
      centroids[surface.first_cluster + surface.cluster[e]] += element.area * element.position;
      areas[surface.first_cluster + surface.cluster[e]] += element.area;
    }
  }
  for (std::size_t c = 0; c < rows.size(); ++c) centroids[c] /= areas[c];
  return find_rooms(rows, centroids, areas);
}

ElementRooms rooms_of_elements(const std::vector<ClusteredSurface>& surfaces,
                               const std::vector<std::uint32_t>& of_cluster) {
  ElementRooms rooms;
  for (const ClusteredSurface& surface : surfaces) {
    auto& own = rooms.of_element.emplace_back();
    for (const std::uint32_t cluster : surface.cluster)
      own.push_back(of_cluster[surface.first_cluster + cluster]);
  }
  for (const std::uint32_t room : of_cluster) rooms.count = std::max(rooms.count, room + 1);
  return rooms;
}

/// In the order of new numbers.
template <class T>
std::vector<T> reordered(std::vector<T> values, const std::vector<std::uint32_t>& numbers) {
  std::vector<T> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[numbers[i]] = std::move(values[i]);
  return result;
}

}  // namespace

Result<Survey> survey(RowScene& scene, const std::vector<Chart>& charts,
                      std::vector<ClusteredSurface>& surfaces, SenderLookup& lookup, Emitters& emitters,
                      ElementRooms& rooms, RowCounts& counts, const ProgressObserver& observer) {
  auto halves = trace_survey(scene, charts, surfaces, counts, observer);
  if (!halves) return tl::unexpected(halves.error());
  Survey result;
  result.rows = mean_rows(*halves, sender_count(scene));
  if (rooms.count == 0) rooms = rooms_of_elements(surfaces, rooms_of(surfaces, result.rows));
  std::vector<std::uint32_t> of_cluster = rooms_of_clusters(surfaces, rooms);
  std::vector<std::uint32_t> numbers;
  result.senders = number_senders(emitters, of_cluster, scene.sky_resolution, surfaces, numbers);
  for (auto* rows : {&halves->first, &halves->second, &result.rows}) {
    renumber(numbers, *rows);
    *rows = reordered(std::move(*rows), numbers);
  }
  renumber(numbers, emitters);
  lookup.follow_clusters();
  for (std::uint32_t& sender : scene.sky_senders) sender = numbers[sender];
  if (scene.memory != nullptr)
    follow_senders(lookup, emitters, scene.sky_senders, std::uint32_t(sender_count(scene)), *scene.memory);
  const ProbedScene probed{scene.geometry, scene.caster, surfaces, emitters, result.senders, scene.seed};
  result.probing = probe(probed, *halves, rooms, reordered(std::move(of_cluster), numbers));
  return result;
}

}  // namespace relume
