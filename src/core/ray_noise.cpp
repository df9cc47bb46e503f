// SPDX-License-Identifier: MIT
#include "core/ray_noise.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vector_relational.hpp>

#include "core/mix.h"
#include "core/sender_product.h"

namespace relume {
namespace {

/// Solutions with errors of random sign, and bounces of each at most.
constexpr std::uint32_t kNoiseDraws = 4, kMostBounces = 32;
/// Bounces end once they add no more than this part.
constexpr double kSmallPart = 0.01;

/// Radiosity of one kind of senders alone.
struct Senders {
  std::vector<Rgb> clusters, sky;
};

std::vector<Rgb> squares(std::vector<Rgb> values) {
  for (Rgb& value : values) value *= value;
  return values;
}

/// Per row: variance of one ray.
std::vector<Rgb> ray_variance(const SenderMatrix& matrix, const Senders& senders) {
  Lighting lighting;
  lighting.sky_radiosity = squares(senders.sky);
  std::vector<Rgb> variance = gather(matrix, lighting, squares(senders.clusters));
  lighting.sky_radiosity = senders.sky;
  const std::vector<Rgb> light = gather(matrix, lighting, senders.clusters);
  for (std::size_t row = 0; row < variance.size(); ++row)
    variance[row] = glm::max(variance[row] - light[row] * light[row], Rgb(0.0));
  return variance;
}

struct BothKinds {
  Senders surfaces, emitters;
};

BothKinds both_kinds(const Model& model, const Lighting& lighting, const std::vector<Rgb>& radiosity) {
  BothKinds kinds;
  kinds.surfaces = {radiosity, lighting.sky_radiosity};
  kinds.emitters = {std::vector<Rgb>(radiosity.size(), Rgb(0.0)),
                    std::vector<Rgb>(lighting.sky_radiosity.size(), Rgb(0.0))};
  std::size_t i = 0;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) {
      if (model.materials[cluster.material].possible_emitter)
        std::swap(kinds.surfaces.clusters[i], kinds.emitters.clusters[i]);
      ++i;
    }
  }
  return kinds;
}

/// Per row of a matrix: variance of its irradiance, as if each row had one ray of its cluster's kind.
/// `of_row`: the rays of each row.
std::vector<Rgb> row_variance(const SenderMatrix& matrix, const BothKinds& kinds,
                              const std::vector<VarianceShares>& of_row) {
  std::vector<Rgb> variance = ray_variance(matrix, kinds.surfaces);
  const std::vector<Rgb> of_emitters = ray_variance(matrix, kinds.emitters);
  for (std::size_t row = 0; row < variance.size(); ++row) {
    variance[row] =
        double(of_row[row].surfaces) * variance[row] + double(of_row[row].emitters) * of_emitters[row];
  }
  return variance;
}

VarianceShares divided(const VarianceShares& shares, double rays) {
  return {float(double(shares.surfaces) / rays), float(double(shares.emitters) / rays)};
}

/// How many of its elements count for the row of a cluster.
double equal_elements(const System& system, const Cluster& cluster) {
  double sum = 0.0, squared = 0.0;
  for (std::uint32_t e = 0; e < cluster.element_count; ++e) {
    const double area = double(system.elements[cluster.first_element + e].area);
    sum += area, squared += area * area;
  }
  return squared > 0.0 ? sum * sum / squared : 1.0;
}

struct SharesOfRows {
  std::vector<VarianceShares> clusters, gather_rows;  ///< over the number of rays
};

SharesOfRows shares_of_rows(const Model& model) {
  SharesOfRows shares;
  for (const System& system : model.systems) {
    for (std::size_t c = 0; c < system.clusters.size(); ++c) {
      const double rays = double(system.rays[c].count) * equal_elements(system, system.clusters[c]);
      shares.clusters.push_back(divided(system.rays[c].variance, rays));
    }
    for (const Lumel& lumel : system.lumels) {
      const ClusterRays& rays = system.rays[system.elements[lumel.element].cluster];
      shares.gather_rows.push_back(divided(rays.variance, double(rays.count)));
    }
    shares.gather_rows.resize(shares.gather_rows.size() + system.sensors.size(), {0.0f, 0.0f});
  }
  return shares;
}

/// Errors of radiosity when those of the rows are `source`, reflected until little is left.
std::vector<Rgb> follow_errors(const SenderMatrix& bounce, const std::vector<Rgb>& albedo,
                               const std::vector<Rgb>& source) {
  std::vector<Rgb> errors = source;
  for (std::uint32_t bounces = 0; bounces < kMostBounces; ++bounces) {
    const std::vector<Rgb> arrived = cluster_product(bounce, errors);
    Rgb change(0.0), size(0.0);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const Rgb next = source[i] + albedo[i] * arrived[i];
      change = glm::max(change, glm::abs(next - errors[i]));
      size = glm::max(size, glm::abs(next));
      errors[i] = next;
    }
    if (glm::all(glm::lessThanEqual(change, kSmallPart * size))) break;
  }
  return errors;
}

void add_squares(const std::vector<Rgb>& values, std::vector<Rgb>& sums) {
  for (std::size_t i = 0; i < values.size(); ++i) sums[i] += values[i] * values[i] / double(kNoiseDraws);
}

}  // namespace

std::optional<RayNoise> ray_noise(const Model& model, const ReferenceMatrices& matrices,
                                  const Lighting& lighting, const std::vector<Rgb>& radiosity) {
  for (const System& system : model.systems) {
    const bool told = system.rays.size() == system.clusters.size() &&
                      std::all_of(system.rays.begin(), system.rays.end(),
                                  [](const ClusterRays& rays) { return rays.count > 0; });
    if (!told) return {};
  }
  const BothKinds kinds = both_kinds(model, lighting, radiosity);
  const SharesOfRows shares = shares_of_rows(model);
  RayNoise noise{row_variance(matrices.bounce, kinds, shares.clusters),
                 row_variance(matrices.gather, kinds, shares.gather_rows)};
  for (const System& system : model.systems)
    for (const ClusterRays& rays : system.rays)
      noise.measured = noise.measured || rays.variance != VarianceShares{};
  std::vector<Rgb> deviation;
  for (std::size_t i = 0; i < radiosity.size(); ++i)
    deviation.push_back(lighting.albedo[i] * glm::sqrt(noise.radiosity[i]));
  for (std::uint32_t draw = 0; draw < kNoiseDraws; ++draw) {
    std::vector<Rgb> source = deviation;
    for (std::size_t i = 0; i < source.size(); ++i)
      if ((mix(i, draw) & 1u) != 0) source[i] = -source[i];
    const std::vector<Rgb> errors = follow_errors(matrices.bounce, lighting.albedo, source);
    add_squares(cluster_product(matrices.bounce, errors), noise.radiosity);
    add_squares(cluster_product(matrices.gather, errors), noise.irradiance);
  }
  for (std::size_t i = 0; i < radiosity.size(); ++i)
    noise.radiosity[i] = lighting.albedo[i] * glm::sqrt(noise.radiosity[i]);
  for (Rgb& value : noise.irradiance) value = glm::sqrt(value);
  return noise;
}

}  // namespace relume
