// SPDX-License-Identifier: MIT
//
// The cut against plain truncation, and shared column lists against each row's own, on rows of many leaves
// under lights that the precompute has not seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <stdexcept>

#include "precompute/cut_rows.h"
#include "precompute/mutual_visibility.h"
#include "precompute/rows.h"
#include "precompute/surfaces.h"
#include "precompute/survey.h"
#include "verification/rooms.h"

namespace relume::test {
namespace {

constexpr std::uint32_t kBudget = 64, kTile = 8, kRays = 4096;
constexpr std::size_t kManyLeaves = 512;
constexpr std::uint32_t kSkyCells = 6 * 8 * 8;
constexpr double kAlbedo = 0.6;
constexpr int kBounces = 12;

/// Per sender.
using Values = std::vector<double>;

Surfaces clustered(const Scene& scene, const Geometry& geometry, const RayCaster& caster) {
  PrecomputeOptions options;
  options.cluster_size = 0.12, options.texel_size = 0.04;
  PrecomputeReport report;
  auto surfaces = cut_surfaces(scene, options, caster, geometry, report);
  if (!surfaces) throw std::runtime_error(surfaces.error().message);
  cluster_surfaces(scene, caster, report, 0.0, {}, *surfaces);
  return std::move(*surfaces);
}

struct SampledRows {
  std::vector<FormFactorRow> rows;
  std::vector<SurfacePoint> places;
};

/// Two rooms in clusters of 12 cm, surveyed.
class CutQuality : public testing::Test {
 protected:
  CutQuality()
      : scene_(two_rooms()),
        geometry_(make_geometry(scene_)),
        caster_(*make_caster(geometry_)),
        surfaces_(clustered(scene_, geometry_, caster_)),
        emitters_(possible_emitters(scene_, surfaces_)),
        lookup_(surfaces_.geometry, surfaces_.charts, surfaces_.layouts, surfaces_.systems, caster_),
        row_scene_{surfaces_.geometry, caster_, lookup_, emitters_, surfaces_.cluster_count(), 8, {}, 0} {
    row_scene_.sky_senders.resize(kSkyCells);
    std::iota(row_scene_.sky_senders.begin(), row_scene_.sky_senders.end(), surfaces_.cluster_count());
    RowCounts counts;
    ElementRooms rooms;
    survey_ = *survey(row_scene_, surfaces_.charts, surfaces_.systems, lookup_, emitters_, rooms, counts, {});
  }

  /// Elements of every so many clusters, eight of each, side by side: tiles, one after the other.
  SampledRows sample_rows() const {
    const SobolPoints points(kRays);
    RowTracer tracer(row_scene_);
    SampledRows sampled;
    for (const ClusteredSurface& system : surfaces_.systems) {
      const auto members = members_of_clusters(system);
      const std::vector<bool> none(system.surface.elements.size(), false);
      for (std::size_t c = 0; c < members.size(); c += 97) {
        if (members[c].size() < kTile) continue;
        const auto first = std::span(members[c]).first(kTile);
        for (const Receiver& receiver : receivers_of(row_scene_, {surfaces_.charts, system, none}, first)) {
          sampled.rows.push_back(tracer.trace(receiver, points, {0, kRays}).row);
          sampled.places.push_back(receiver.middle());
        }
      }
    }
    return sampled;
  }

  /// Radiosity of each cluster after some bounces of `emitted`.
  Values bounced(const Values& emitted) const {
    Values radiosity = emitted;
    for (int bounce = 0; bounce < kBounces; ++bounce) {
      Values next = emitted;
      for (std::size_t c = 0; c < survey_.rows.size(); ++c)
        next[c] += kAlbedo * irradiance(survey_.rows[c], radiosity);
      radiosity = next;
    }
    return radiosity;
  }

  static double irradiance(const FormFactorRow& row, const Values& radiosity) {
    double sum = 0.0;
    for (std::size_t i = 0; i < row.senders.size(); ++i)
      sum += double(row.values[i]) * radiosity[row.senders[i]];
    return sum;
  }

  double irradiance(const CutTile& tile, std::size_t row, const Values& radiosity) const {
    double sum = 0.0;
    for (std::size_t n = 0; n < tile.nodes.size(); ++n) {
      const TreeNodeRange& range = survey_.senders.tree.nodes[tile.nodes[n]];
      double light = 0.0, weight = 0.0;
      for (std::uint32_t s = range.first; s < range.first + range.count; ++s) {
        light += survey_.senders.weights[s] * radiosity[s];
        weight += survey_.senders.weights[s];
      }
      sum += double(tile.values[row][n]) * light / weight;
    }
    return sum;
  }

  /// Light of a bulb of 100 cd that clusters reflect.
  Values lit_by_bulb(const glm::vec3& bulb) const {
    Values light(survey_.rows.size() + kSkyCells, 0.0);
    for (const ClusteredSurface& system : surfaces_.systems) {
      for (std::size_t e = 0; e < system.cluster.size(); ++e) {
        const Element& element = system.surface.elements[e];
        const glm::vec3 to = bulb - element.position;
        const double distance = double(glm::length(to));
        const double cosine = double(glm::dot(to, element.normal)) / distance;
        const SurfacePoint at{element.position, element.normal}, lamp{bulb, -glm::normalize(to)};
        if (cosine <= 0.0 || !mutually_visible(surfaces_.geometry, caster_, at, lamp)) continue;
        const std::uint32_t sender = system.sender_of(std::uint32_t(e));
        light[sender] += kAlbedo * 100.0 * cosine / (distance * distance) * double(element.area) /
                         survey_.senders.weights[sender];
      }
    }
    return bounced(light);
  }

  /// Light of all clusters of the material that emits.
  Values lit_by_lamp() const {
    Values light(survey_.rows.size() + kSkyCells, 0.0);
    for (const Emitter& emitter : emitters_.list) light[emitter.cluster] = 1000.0;
    return bounced(light);
  }

  std::vector<CutTile> cut(const SampledRows& sampled, std::uint32_t tile_rows) const {
    const CutLimits limits{kBudget, 0.0};
    std::vector<CutRow> all;
    for (std::size_t i = 0; i < sampled.rows.size(); ++i)
      all.push_back({&sampled.rows[i], float(kRays), 0.0f, sampled.places[i]});
    return cut_rows({survey_.senders.tree, survey_.probing}, all, {tile_rows, {&limits, 1}});
  }

  Scene scene_;
  Geometry geometry_;
  RayCaster caster_;
  Surfaces surfaces_;
  Emitters emitters_;
  SenderLookup lookup_;
  RowScene row_scene_;
  Survey survey_;
};

/// The largest factors of a row, rescaled to its sum.
FormFactorRow largest(const FormFactorRow& row, std::size_t count) {
  std::vector<std::size_t> order(row.values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return row.values[a] > row.values[b]; });
  order.resize(std::min(order.size(), count));
  const double sum = std::accumulate(row.values.begin(), row.values.end(), 0.0);
  FormFactorRow kept;
  double kept_sum = 0.0;
  for (const std::size_t i : order) kept_sum += double(row.values[i]);
  for (const std::size_t i : order) {
    kept.senders.push_back(row.senders[i]);
    kept.values.push_back(float(double(row.values[i]) * sum / kept_sum));
  }
  return kept;
}

struct Errors {
  double shared = 0.0, own = 0.0, truncated = 0.0;  ///< root mean square over rows, relative to that of light
};

TEST_F(CutQuality, AgainstTheLargestAndAgainstOwnLists) {
  const SampledRows sampled = sample_rows();
  const std::vector<FormFactorRow>& rows = sampled.rows;
  const std::vector<CutTile> shared = cut(sampled, kTile), own = cut(sampled, 1);
  for (const auto& [name, light] :
       {std::pair("bulb", lit_by_bulb({1.0f, 1.7f, 2.2f})), {"lamp", lit_by_lamp()}}) {
    double total = 0.0, count = 0.0;
    Errors errors;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].senders.size() <= kManyLeaves) continue;
      const double truth = irradiance(rows[r], light);
      const auto squared = [&](double value) { return (value - truth) * (value - truth); };
      errors.shared += squared(irradiance(shared[r / kTile], r % kTile, light));
      errors.own += squared(irradiance(own[r], 0, light));
      errors.truncated += squared(irradiance(largest(rows[r], kBudget), light));
      total += truth * truth, count += 1.0;
    }
    for (double* error : {&errors.shared, &errors.own, &errors.truncated}) *error = std::sqrt(*error / total);
    EXPECT_GT(count, 200.0);
    RecordProperty(std::string(name) + "_own", std::to_string(errors.own));
    RecordProperty(std::string(name) + "_shared", std::to_string(errors.shared));
    RecordProperty(std::string(name) + "_truncated", std::to_string(errors.truncated));
    EXPECT_GE(errors.truncated, 4.0 * errors.shared);
    EXPECT_LE(errors.shared, 1.25 * errors.own);
  }
}

}  // namespace
}  // namespace relume::test
