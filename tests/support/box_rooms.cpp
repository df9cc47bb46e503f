// SPDX-License-Identifier: MIT
#include "support/box_rooms.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace relume::test {
namespace {

using Point = glm::dvec3;
constexpr double kLength = 4.0, kWidth = 5.0, kHeight = 3.0;
constexpr double kDoorWidth = 1.0, kDoorHeight = 2.0;

struct Patch {
  Point middle, normal;
  double area;
  std::uint32_t room;
};

/// Where the door after room `r` begins along z.
double door_begin(std::uint32_t r) {
  return r % 2 == 0 ? 1.0 : kWidth - kDoorWidth - 1.0;
}

bool in_door(std::uint32_t r, double y, double z) {
  return y < kDoorHeight && z > door_begin(r) && z < door_begin(r) + kDoorWidth;
}

void add_wall(const Point& corner, const Point& u, const Point& v, const Point& normal, double patch,
              std::uint32_t room, std::vector<Patch>& patches) {
  const auto columns = static_cast<int>(std::lround(glm::length(u) / patch));
  const auto rows = static_cast<int>(std::lround(glm::length(v) / patch));
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const Point middle = corner + (i + 0.5) / columns * u + (j + 0.5) / rows * v;
      patches.push_back({middle, normal, glm::length(u) * glm::length(v) / (columns * rows), room});
    }
  }
}

std::vector<Patch> make_patches(std::uint32_t count, double patch) {
  std::vector<Patch> all;
  for (std::uint32_t r = 0; r < count; ++r) {
    const double x = r * kLength;
    const Point u(kLength, 0, 0), v(0, kHeight, 0), w(0, 0, kWidth);
    std::vector<Patch> room;
    add_wall({x, 0, 0}, u, w, {0, 1, 0}, patch, r, room);
    add_wall({x, kHeight, 0}, u, w, {0, -1, 0}, patch, r, room);
    add_wall({x, 0, 0}, u, v, {0, 0, 1}, patch, r, room);
    add_wall({x, 0, kWidth}, u, v, {0, 0, -1}, patch, r, room);
    add_wall({x, 0, 0}, w, v, {1, 0, 0}, patch, r, room);
    add_wall({x + kLength, 0, 0}, w, v, {-1, 0, 0}, patch, r, room);
    for (const Patch& p : room) {
      const bool before = r > 0 && p.normal.x > 0 && in_door(r - 1, p.middle.y, p.middle.z);
      const bool after = r + 1 < count && p.normal.x < 0 && in_door(r, p.middle.y, p.middle.z);
      if (!before && !after) all.push_back(p);
    }
  }
  return all;
}

bool sees(const Patch& a, const Patch& b) {
  const Patch& left = a.room < b.room ? a : b;
  const Patch& right = a.room < b.room ? b : a;
  for (std::uint32_t r = left.room; r < right.room; ++r) {
    const double t = ((r + 1) * kLength - left.middle.x) / (right.middle.x - left.middle.x);
    const Point crossing = left.middle + t * (right.middle - left.middle);
    if (!(t >= 0.0 && t <= 1.0) || !in_door(r, crossing.y, crossing.z)) return false;
  }
  return true;
}

/// cos cos / (pi r^2), the same both ways.
double kernel(const Patch& a, const Patch& b) {
  const Point d = b.middle - a.middle;
  const double square = glm::dot(d, d);
  const double from = glm::dot(a.normal, d), to = -glm::dot(b.normal, d);
  if (from <= 1e-9 || to <= 1e-9 || !sees(a, b)) return 0.0;
  return from * to / (std::numbers::pi * square * square);
}

double row_sum(const CsrMatrix& matrix, std::uint32_t row) {
  double sum = 0.0;
  for (auto e = matrix.row_offsets[row]; e < matrix.row_offsets[row + 1]; ++e) sum += matrix.values[e];
  return sum;
}

/// K_ij <- d_i K_ij d_j until every row sums to 1.
void scale_to_closure(CsrMatrix& matrix) {
  for (int pass = 0; pass < 200; ++pass) {
    std::vector<double> factor(matrix.rows);
    double worst = 0.0;
    for (std::uint32_t r = 0; r < matrix.rows; ++r) {
      const double sum = row_sum(matrix, r);
      factor[r] = 1.0 / std::sqrt(sum);
      worst = std::max(worst, std::abs(sum - 1.0));
    }
    if (worst < 1e-14) return;
    for (std::uint32_t r = 0; r < matrix.rows; ++r) {
      for (auto e = matrix.row_offsets[r]; e < matrix.row_offsets[r + 1]; ++e)
        matrix.values[e] *= factor[r] * factor[matrix.column_indices[e]];
    }
  }
}

}  // namespace

BoxRooms unscaled_box_rooms(std::uint32_t count, double patch) {
  const std::vector<Patch> patches = make_patches(count, patch);
  BoxRooms result;
  result.rooms = count;
  result.matrix.rows = result.matrix.columns = static_cast<std::uint32_t>(patches.size());
  result.matrix.row_offsets.push_back(0);
  for (const Patch& a : patches) {
    result.areas.push_back(a.area);
    result.centroids.emplace_back(a.middle);
    result.room.push_back(a.room);
    for (std::uint32_t j = 0; j < patches.size(); ++j) {
      const double value = kernel(a, patches[j]) * patches[j].area;
      if (value <= 0.0) continue;
      result.matrix.column_indices.push_back(j);
      result.matrix.values.push_back(value);
    }
    result.matrix.row_offsets.push_back(result.matrix.values.size());
  }
  return result;
}

BoxRooms box_rooms(std::uint32_t count, double patch) {
  BoxRooms result = unscaled_box_rooms(count, patch);
  scale_to_closure(result.matrix);
  return result;
}

CsrMatrix noisy_rows(const CsrMatrix& exact, std::uint32_t rays, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  CsrMatrix result;
  result.columns = exact.columns;
  result.row_offsets.push_back(0);
  for (std::uint32_t r = 0; r < exact.rows; ++r) {
    const auto first = static_cast<std::ptrdiff_t>(exact.row_offsets[r]),
               last = static_cast<std::ptrdiff_t>(exact.row_offsets[r + 1]);
    std::discrete_distribution<std::size_t> draw(exact.values.begin() + first, exact.values.begin() + last);
    std::vector<std::uint32_t> hits(static_cast<std::size_t>(last - first), 0);
    for (std::uint32_t ray = 0; ray < rays; ++ray) ++hits[draw(random)];
    const double closure = row_sum(exact, r);
    for (std::size_t k = 0; k < hits.size(); ++k) {
      if (hits[k] == 0) continue;
      result.column_indices.push_back(exact.column_indices[static_cast<std::size_t>(first) + k]);
      result.values.push_back(closure * hits[k] / rays);
    }
    result.row_offsets.push_back(result.values.size());
    ++result.rows;
  }
  return result;
}

}  // namespace relume::test
