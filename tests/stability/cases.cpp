// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/methods/room_correction.h"
#include "stability/lab.h"
#include "support/box_rooms.h"
#include "support/matrices.h"

namespace relume::test {
namespace {

Rooms one_room(std::size_t clusters) {
  return {std::vector<std::uint32_t>(clusters, 0), 1};
}

Rooms rooms_of(const BoxRooms& boxes) {
  const std::vector<float> areas(boxes.areas.begin(), boxes.areas.end());
  return largest_rooms(find_rooms(SenderMatrix(boxes.matrix), boxes.centroids, areas, kCorrectionScale),
                       boxes.areas, kMaxCorrectionRooms);
}

/// One lamp under the ceiling of the first room; walls up to 60 % of the distance to 1 brighter or darker.
Lighting lamp_lighting(const BoxRooms& boxes, double albedo) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(-0.6, 0.6);
  Lighting lighting = uniform_lighting(boxes.size(), Rgb(0.0), Rgb(0.0));
  for (Rgb& rho : lighting.albedo) rho = Rgb(std::min(albedo + (1.0 - albedo) * share(random), 0.9999));
  std::size_t lamp = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto to_lamp = [&](std::size_t k) {
      return std::hypot(boxes.centroids[k].x - 2, boxes.centroids[k].y - 3, boxes.centroids[k].z - 2.5f);
    };
    if (to_lamp(i) < to_lamp(lamp)) lamp = i;
  }
  lighting.exitance[lamp] = Rgb(100.0);
  return lighting;
}

Case with_boxes(const std::string& name, BoxRooms boxes, Lighting lighting) {
  Case c{name, SenderMatrix(boxes.matrix), std::move(lighting), boxes.areas, rooms_of(boxes), {}, 0.0};
  const double lambda = power_method(c.matrix, c.lighting);
  if (lambda < 1.0) {
    c.exact = dense_solution(c.matrix, c.lighting);
  } else {
    c.spectral_radius = lambda;
  }
  return c;
}

Case small_case(const std::string& name, const SenderMatrix& matrix, Lighting lighting,
                std::vector<double> exact) {
  const std::size_t n = lighting.albedo.size();
  return {name, matrix, std::move(lighting), std::vector<double>(n, 1.0), one_room(n), std::move(exact), 0.0};
}

/// Every surface emits M and has albedo rho, every row sums to 1: B = M / (1 - rho).
Case furnace(const std::string& name, double albedo) {
  const BoxRooms boxes = box_rooms(1, 1.0);
  return {name,
          SenderMatrix(boxes.matrix),
          uniform_lighting(boxes.size(), Rgb(albedo), Rgb(2.0)),
          boxes.areas,
          rooms_of(boxes),
          std::vector<double>(boxes.size(), 2.0 / (1.0 - albedo)),
          0.0};
}

/// What rows see of other rooms, through one node for each room.
SenderMatrix clustered(const BoxRooms& boxes) {
  const std::uint32_t n = boxes.matrix.rows;
  CsrMatrix rows, nodes;
  rows.columns = n + boxes.rooms, nodes.columns = n;
  rows.row_offsets = nodes.row_offsets = {0};
  std::vector<double> room_areas(boxes.rooms, 0.0);
  for (std::uint32_t i = 0; i < n; ++i) room_areas[boxes.room[i]] += boxes.areas[i];
  for (std::uint32_t r = 0; r < boxes.rooms; ++r) {
    for (std::uint32_t i = 0; i < n; ++i) {
      if (boxes.room[i] != r) continue;
      nodes.column_indices.push_back(i);
      nodes.values.push_back(boxes.areas[i] / room_areas[r]);
    }
    nodes.row_offsets.push_back(nodes.values.size());
    ++nodes.rows;
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    std::vector<double> far(boxes.rooms, 0.0);
    for (auto e = boxes.matrix.row_offsets[i]; e < boxes.matrix.row_offsets[i + 1]; ++e) {
      const std::uint32_t j = boxes.matrix.column_indices[e];
      if (boxes.room[j] != boxes.room[i]) {
        far[boxes.room[j]] += boxes.matrix.values[e];
        continue;
      }
      rows.column_indices.push_back(j);
      rows.values.push_back(boxes.matrix.values[e]);
    }
    for (std::uint32_t r = 0; r < boxes.rooms; ++r) {
      if (far[r] == 0.0) continue;
      rows.column_indices.push_back(n + r);
      rows.values.push_back(far[r]);
    }
    rows.row_offsets.push_back(rows.values.size());
    ++rows.rows;
  }
  return {rows, nodes};
}

CsrMatrix stored(const CsrMatrix& matrix, ValueCodec codec) {
  BlockMatrixBuilder builder(matrix.columns, codec);
  for (std::uint32_t r = 0; r < matrix.rows; ++r) {
    const auto first = static_cast<std::ptrdiff_t>(matrix.row_offsets[r]),
               last = static_cast<std::ptrdiff_t>(matrix.row_offsets[r + 1]);
    const std::vector<std::uint16_t> columns(matrix.column_indices.begin() + first,
                                             matrix.column_indices.begin() + last);
    const std::vector<double> values(matrix.values.begin() + first, matrix.values.begin() + last);
    builder.append_row(columns, values);
  }
  return decode(std::move(builder).finish());
}

/// 8 bits of the largest value of the row, rounded up: rows sum to more than 1.
CsrMatrix rounded_up(CsrMatrix matrix) {
  for (std::uint32_t r = 0; r < matrix.rows; ++r) {
    double most = 0.0;
    for (auto e = matrix.row_offsets[r]; e < matrix.row_offsets[r + 1]; ++e)
      most = std::max(most, matrix.values[e]);
    for (auto e = matrix.row_offsets[r]; e < matrix.row_offsets[r + 1]; ++e)
      matrix.values[e] = std::ceil(matrix.values[e] / most * 255.0) / 255.0 * most;
  }
  return matrix;
}

Case changed_rows(const std::string& name, std::uint32_t rooms, double albedo,
                  const std::function<CsrMatrix(const CsrMatrix&)>& change) {
  BoxRooms boxes = box_rooms(rooms, 1.0);
  const Lighting lighting = lamp_lighting(boxes, albedo);
  boxes.matrix = change(boxes.matrix);
  return with_boxes(name, std::move(boxes), lighting);
}

Case clustered_case(const std::string& name, double albedo) {
  const BoxRooms boxes = box_rooms(2, 1.0);
  Case c{name, clustered(boxes), lamp_lighting(boxes, albedo), boxes.areas, rooms_of(boxes), {}, 0.0};
  c.exact = dense_solution(c.matrix, c.lighting);
  return c;
}

Case black_beside_white() {
  const BoxRooms boxes = box_rooms(1, 1.0);
  Lighting lighting = lamp_lighting(boxes, 0.5);
  for (std::size_t i = 0; i < boxes.size(); ++i) lighting.albedo[i] = Rgb(i % 2 == 0 ? 0.0 : 0.9999);
  return with_boxes("black beside white", boxes, lighting);
}

Case scaled_light(const std::string& name, double first, double second) {
  const BoxRooms boxes = box_rooms(2, 1.0);
  Lighting lighting = lamp_lighting(boxes, 0.9);
  for (std::size_t i = 0; i < boxes.size(); ++i) lighting.exitance[i] = Rgb(0.0);
  lighting.exitance.front() = Rgb(first);
  lighting.exitance.back() = Rgb(second);
  return with_boxes(name, boxes, lighting);
}

/// The second and the third cluster see nothing; the first sees them, the third is black.
Case empty_rows() {
  const CsrMatrix matrix = to_csr({{0.0, 0.5, 0.5}, {0, 0, 0}, {0, 0, 0}}, 3);
  Lighting lighting = uniform_lighting(3, Rgb(0.5), Rgb(4.0));
  lighting.albedo[2] = Rgb(0.0);
  return small_case("empty rows", matrix, lighting, {4.0 + 0.5 * (2.0 + 2.0), 4.0, 4.0});
}

/// A hollow sphere in one piece sees itself only: B = M / (1 - rho F).
Case one_cluster() {
  return small_case("one cluster", to_csr({{0.75}}, 1), uniform_lighting(1, Rgb(0.8), Rgb(1.0)),
                    {1.0 / (1.0 - 0.6)});
}

Case one_group() {
  Case c = box_case("one group for two rooms, 0.95", 2, 1.0, 0.95);
  c.rooms = one_room(c.areas.size());
  return c;
}

void add_albedos(std::vector<CaseMaker>& cases) {
  for (const auto& [albedo, text] :
       {std::pair(0.9, "0.9"), {0.99, "0.99"}, {0.999, "0.999"}, {0.9999, "0.9999"}}) {
    const double rho = albedo;
    const std::string suffix = std::string(", ") + text;
    cases.push_back({"furnace" + suffix, [=] { return furnace("furnace" + suffix, rho); }});
    cases.push_back({"two rooms" + suffix, [=] { return box_case("two rooms" + suffix, 2, 1.0, rho); }});
    cases.push_back(
        {"corridor of eight" + suffix, [=] { return box_case("corridor of eight" + suffix, 8, 1.0, rho); }});
  }
}

CsrMatrix times_1_02(CsrMatrix matrix) {
  for (double& value : matrix.values) value *= 1.02;
  return matrix;
}

void add_changed_rows(std::vector<CaseMaker>& cases) {
  const auto add = [&cases](const std::string& name, double albedo,
                            const std::function<CsrMatrix(const CsrMatrix&)>& change) {
    cases.push_back({name, [=] { return changed_rows(name, 2, albedo, change); }});
  };
  const auto noisy = [](const CsrMatrix& m) { return noisy_rows(m, 64, 1); };
  add("rows of 64 rays, 0.95", 0.95, noisy);
  add("rows of 64 rays, 0.99", 0.99, noisy);
  cases.push_back({"clustered rows, 0.99", [] { return clustered_case("clustered rows, 0.99", 0.99); }});
  add("16-bit rows, 0.99", 0.99, [](const CsrMatrix& m) { return stored(m, ValueCodec::unorm16); });
  add("8-bit rows, 0.99", 0.99, [](const CsrMatrix& m) { return stored(m, ValueCodec::sqrt8); });
  add("8-bit rows rounded up, 0.99", 0.99, rounded_up);
  add("rows x 1.02, 0.95", 0.95, times_1_02);
  add("rows x 1.02, 0.99", 0.99, times_1_02);
  for (const auto& [albedo, text] : {std::pair(0.8, "0.8"), {0.95, "0.95"}, {0.99, "0.99"}}) {
    const std::string name = std::string("unscaled point to point, ") + text;
    const double rho = albedo;
    cases.push_back({name, [=] {
                       BoxRooms boxes = unscaled_box_rooms(2, 1.0);
                       const Lighting lighting = lamp_lighting(boxes, rho);
                       return with_boxes(name, std::move(boxes), lighting);
                     }});
  }
}

}  // namespace

Case box_case(const std::string& name, std::uint32_t rooms, double patch, double albedo) {
  const BoxRooms boxes = box_rooms(rooms, patch);
  Case c{name, SenderMatrix(boxes.matrix), lamp_lighting(boxes, albedo), boxes.areas, rooms_of(boxes), {},
         0.0};
  c.exact = dense_solution(c.matrix, c.lighting);
  return c;
}

const std::vector<CaseMaker>& all_cases() {
  static const std::vector<CaseMaker> cases = [] {
    std::vector<CaseMaker> all;
    add_albedos(all);
    add_changed_rows(all);
    all.push_back({"one group for two rooms, 0.95", one_group});
    all.push_back({"black beside white", black_beside_white});
    all.push_back({"empty rows", empty_rows});
    all.push_back({"one cluster", one_cluster});
    all.push_back({"1e9 beside 1e-6", [] { return scaled_light("1e9 beside 1e-6", 1e9, 1e-6); }});
    all.push_back({"subnormal emission", [] { return scaled_light("subnormal emission", 1e-310, 0.0); }});
    return all;
  }();
  return cases;
}

}  // namespace relume::test
