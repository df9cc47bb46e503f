// SPDX-License-Identifier: MIT
#include "core/methods/rgb_lu.h"

#include <utility>

namespace relume {
namespace {

Rgb inverse_pivot(const Rgb& pivot) {
  constexpr double kLeast = 1e-9;
  Rgb result(0.0);
  for (int channel = 0; channel < 3; ++channel) {
    if (pivot[channel] > kLeast) result[channel] = 1.0 / pivot[channel];
  }
  return result;
}

}  // namespace

RgbLu::RgbLu(std::vector<Rgb> matrix, std::size_t size) : size_(size), factors_(std::move(matrix)) {
  for (std::size_t pivot = 0; pivot < size; ++pivot) {
    Rgb& inverse = factors_[pivot * size + pivot];
    inverse = inverse_pivot(inverse);
    for (std::size_t row = pivot + 1; row < size; ++row) {
      Rgb& lower = factors_[row * size + pivot];
      lower *= inverse;
      for (std::size_t column = pivot + 1; column < size; ++column)
        factors_[row * size + column] -= lower * factors_[pivot * size + column];
    }
  }
}

void RgbLu::solve(std::vector<Rgb>& x) const {
  for (std::size_t row = 0; row < size_; ++row) {
    for (std::size_t column = 0; column < row; ++column) x[row] -= factors_[row * size_ + column] * x[column];
  }
  for (std::size_t row = size_; row-- > 0;) {
    for (std::size_t column = row + 1; column < size_; ++column)
      x[row] -= factors_[row * size_ + column] * x[column];
    x[row] *= factors_[row * size_ + row];
  }
}

}  // namespace relume
