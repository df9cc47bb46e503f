// SPDX-License-Identifier: MIT
#include "core/lightmap_texels.h"

#include <algorithm>
#include <span>

namespace relume {
namespace {

class Filling {
 public:
  explicit Filling(const System& system)
      : system_(system),
        width_(system.lightmap_width),
        height_(system.lightmap_height),
        list_of_(std::size_t{width_} * height_, kNone),
        invalid_(list_of_.size(), false) {
    for (std::uint32_t i = 0; i < system.lumels.size(); ++i) {
      const Lumel& lumel = system.lumels[i];
      const std::size_t texel = std::size_t{lumel.y} * width_ + lumel.x;
      if ((lumel.flags & kLumelInvalid) != 0) {
        invalid_[texel] = true;
      } else {
        begin_list(texel);
        lumels_.push_back(i);
      }
    }
  }

  /// Adds all texels next to those of the last ring. False when there are none.
  bool grow(bool only_invalid) {
    const std::vector<std::size_t> ring = next_ring(only_invalid);
    const std::size_t known = first_.size();
    for (const std::size_t texel : ring) add_nearest(texel, known);
    return !ring.empty();
  }

  LightmapTexels in_order() {
    first_.push_back(static_cast<std::uint32_t>(lumels_.size()));
    LightmapTexels out;
    out.lumels.reserve(lumels_.size());
    for (std::size_t texel = 0; texel < list_of_.size(); ++texel) {
      if (list_of_[texel] == kNone) continue;
      out.texels.push_back({std::uint16_t(texel % width_), std::uint16_t(texel / width_)});
      out.first_lumel.push_back(static_cast<std::uint32_t>(out.lumels.size()));
      const std::span<const std::uint32_t> shown = list(list_of_[texel]);
      out.lumels.insert(out.lumels.end(), shown.begin(), shown.end());
    }
    out.first_lumel.push_back(static_cast<std::uint32_t>(out.lumels.size()));
    return out;
  }

 private:
  void begin_list(std::size_t texel) {
    list_of_[texel] = static_cast<std::uint32_t>(first_.size());
    first_.push_back(static_cast<std::uint32_t>(lumels_.size()));
    texel_of_.push_back(texel);
  }

  std::span<const std::uint32_t> list(std::uint32_t index) const {
    const std::size_t end = index + 1 < first_.size() ? first_[index + 1] : lumels_.size();
    return std::span(lumels_).subspan(first_[index], end - first_[index]);
  }

  template <class Visit>
  void visit_neighbors(std::size_t texel, const Visit& visit) const {
    const auto x = static_cast<std::uint32_t>(texel % width_), y = static_cast<std::uint32_t>(texel / width_);
    for (std::uint32_t ny = y > 0 ? y - 1 : 0; ny <= y + 1 && ny < height_; ++ny) {
      for (std::uint32_t nx = x > 0 ? x - 1 : 0; nx <= x + 1 && nx < width_; ++nx)
        visit(std::size_t{ny} * width_ + nx);
    }
  }

  std::vector<std::size_t> next_ring(bool only_invalid) {
    std::vector<std::size_t> ring;
    for (std::size_t i = ring_begin_; i < texel_of_.size(); ++i) {
      visit_neighbors(texel_of_[i], [&](std::size_t texel) {
        if (list_of_[texel] == kNone && (invalid_[texel] || !only_invalid)) ring.push_back(texel);
      });
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    ring_begin_ = texel_of_.size();
    return ring;
  }

  std::int64_t square_distance(std::size_t texel, std::uint32_t lumel) const {
    const std::int64_t x = std::int64_t(texel % width_) - system_.lumels[lumel].x;
    const std::int64_t y = std::int64_t(texel / width_) - system_.lumels[lumel].y;
    return x * x + y * y;
  }

  /// Looks at lists below `known` only: those of the rings before.
  void add_nearest(std::size_t texel, std::size_t known) {
    std::vector<std::uint32_t> nearest;
    std::int64_t least = 0;
    visit_neighbors(texel, [&](std::size_t neighbor) {
      if (list_of_[neighbor] >= known) return;
      for (const std::uint32_t lumel : list(list_of_[neighbor])) {
        const std::int64_t distance = square_distance(texel, lumel);
        if (!nearest.empty() && distance > least) continue;
        if (distance < least) nearest.clear();
        least = distance;
        nearest.push_back(lumel);
      }
    });
    std::sort(nearest.begin(), nearest.end());
    nearest.erase(std::unique(nearest.begin(), nearest.end()), nearest.end());
    begin_list(texel);
    lumels_.insert(lumels_.end(), nearest.begin(), nearest.end());
  }

  const System& system_;
  std::uint32_t width_, height_;
  std::vector<std::uint32_t> list_of_;  ///< per texel; kNone: nothing to show yet
  std::vector<bool> invalid_;           ///< per texel: holds an invalid lumel
  std::vector<std::uint32_t> first_;    ///< per list, in the order of filling
  std::vector<std::uint32_t> lumels_;
  std::vector<std::size_t> texel_of_;  ///< per list
  std::size_t ring_begin_ = 0;         ///< the first list of the last ring
};

}  // namespace

LightmapTexels lightmap_texels(const System& system, std::uint32_t dilation) {
  Filling filling(system);
  std::uint32_t ring = 0;
  while (filling.grow(ring >= dilation)) ++ring;
  return filling.in_order();
}

}  // namespace relume
