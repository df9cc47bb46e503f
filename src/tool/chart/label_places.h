// SPDX-License-Identifier: MIT
//
// Where words fit between the marks of a picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace relume {

/// In pixels, y down.
struct PixelBox {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  bool overlaps(const PixelBox& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool inside(const PixelBox& outer) const {
    return left >= outer.left && right <= outer.right && top >= outer.top && bottom <= outer.bottom;
  }
};

/// Width of a text in the font of the charts, with a little to spare.
double text_width(const std::string& text, double font_size);

/// Keeps labels apart from marks and from each other.
class LabelPlaces {
 public:
  explicit LabelPlaces(const PixelBox& bounds) : bounds_(bounds) {}

  void occupy(const PixelBox& box) { taken_.push_back(box); }

  /// A free box for the text beside (x, y), which is then taken; nothing where all around is full.
  std::optional<PixelBox> place(double x, double y, const std::string& text, double font_size);

 private:
  bool is_free(const PixelBox& box) const;

  PixelBox bounds_;
  std::vector<PixelBox> taken_;
};

}  // namespace relume
