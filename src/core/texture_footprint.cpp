// SPDX-License-Identifier: MIT
#include "core/texture_footprint.h"

#include <algorithm>
#include <cmath>

#include "core/piece_samples.h"

namespace relume {
namespace {

/// What a point that alpha cuts out counts for: something, so that a cluster of nothing else has a mean too.
constexpr double kCutOut = 1e-12;

template <class Listed>
const Listed* find(const std::vector<Listed>& list, std::uint32_t triangle) {
  const auto at = std::lower_bound(list.begin(), list.end(), triangle,
                                   [](const Listed& listed, std::uint32_t t) { return listed.triangle < t; });
  return at != list.end() && at->triangle == triangle ? &*at : nullptr;
}

class FootprintBuilder {
 public:
  FootprintBuilder(const Model& model, const System& system, glm::dvec2 image_size)
      : occluders_(model.occluders), system_(system), image_size_(image_size) {}

  void add_cluster(std::uint32_t index) {
    const Cluster& cluster = system_.clusters[index];
    const auto first = static_cast<std::uint32_t>(out_.samples.size());
    weights_.clear();
    for (std::uint32_t e = 0; e < cluster.element_count; ++e) {
      const SurfaceElement& element = system_.elements[cluster.first_element + e];
      for (std::uint32_t p = 0; p < element.piece_count; ++p)
        add_piece(system_.pieces[element.first_piece + p]);
    }
    double sum = 0.0;
    for (const double weight : weights_) sum += weight;
    if (sum <= 0.0) {
      out_.samples.resize(first);
      return;
    }
    for (std::size_t i = 0; i < weights_.size(); ++i)
      out_.samples[first + i].weight = static_cast<float>(weights_[i] / sum);
    out_.clusters.push_back({index, first, static_cast<std::uint32_t>(weights_.size())});
  }

  TextureFootprint finish() { return std::move(out_); }

 private:
  void add_piece(const SurfacePiece& piece) {
    const TextureTriangle* texture = find(occluders_.texture, piece.triangle);
    if (texture == nullptr) return;
    const OpacityTriangle* opacity = find(occluders_.opacity.triangles, piece.triangle);
    const glm::dvec2 origin(texture->corners[0]);
    const glm::dvec2 s = glm::dvec2(texture->corners[1]) - origin,
                     t = glm::dvec2(texture->corners[2]) - origin;
    const double share = piece_share(piece.corners);
    const double texels = 0.5 * share * std::abs(s.x * t.y - s.y * t.x) * image_size_.x * image_size_.y;
    const std::uint32_t count = piece_sample_count(texels);
    const double weight = triangle_area(occluders_, piece.triangle) * share / count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const glm::dvec2 at = piece_sample(i, piece.corners);
      const glm::dvec2 uv = origin + at.x * s + at.y * t;
      const double solid =
          opacity == nullptr ? 1.0 : opacity_at(occluders_.opacity, *opacity, float(at.x), float(at.y));
      out_.samples.push_back({float(uv.x), float(uv.y), 0.0f});
      weights_.push_back(weight * std::max(solid, kCutOut));
    }
  }

  const Occluders& occluders_;
  const System& system_;
  glm::dvec2 image_size_;
  std::vector<double> weights_;  ///< of the cluster, before they are made to add up to 1
  TextureFootprint out_;
};

}  // namespace

TextureFootprint texture_footprint(const Model& model, std::uint32_t system, std::uint32_t material,
                                   std::uint32_t width, std::uint32_t height) {
  FootprintBuilder builder(model, model.systems[system], glm::dvec2(width, height));
  const std::vector<Cluster>& clusters = model.systems[system].clusters;
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].material == material) builder.add_cluster(c);
  }
  return builder.finish();
}

}  // namespace relume
