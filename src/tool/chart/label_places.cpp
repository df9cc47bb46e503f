// SPDX-License-Identifier: MIT
#include "tool/chart/label_places.h"

#include <algorithm>

namespace relume {
namespace {

/// Of the middle of the label's near side, from the point: right, left, above, below, then the corners.
constexpr double kDirections[][2] = {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}};
constexpr double kDistances[] = {9.0, 16.0, 24.0};

std::size_t characters(const std::string& utf8) {
  return std::size_t(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

double text_width(const std::string& text, double font_size) {
  return 0.58 * font_size * double(characters(text)) + 2.0;
}

std::optional<PixelBox> LabelPlaces::place(double x, double y, const std::string& text, double font_size) {
  const double width = text_width(text, font_size), height = 1.1 * font_size;
  for (const double distance : kDistances) {
    for (const auto& [right, down] : kDirections) {
      const double middle_x =
          x + right * (distance + 0.5 * width) * (down != 0.0 && right != 0.0 ? 0.8 : 1.0);
      const double middle_y =
          y + down * (distance + 0.5 * height) * (down != 0.0 && right != 0.0 ? 0.8 : 1.0);
      const PixelBox box{middle_x - 0.5 * width, middle_y - 0.5 * height, middle_x + 0.5 * width,
                         middle_y + 0.5 * height};
      if (!is_free(box)) continue;
      taken_.push_back(box);
      return box;
    }
  }
  return std::nullopt;
}

bool LabelPlaces::is_free(const PixelBox& box) const {
  return box.inside(bounds_) && std::none_of(taken_.begin(), taken_.end(),
                                             [&](const PixelBox& other) { return box.overlaps(other); });
}

}  // namespace relume
