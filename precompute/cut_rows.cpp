// SPDX-License-Identifier: MIT
#include "precompute/cut_rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

namespace relume {
namespace {

/// Rows [first, last) of a tile.
struct Run {
  std::size_t first = 0, last = 0;
};

constexpr float kAlike = 0.95f;

std::vector<Run> alike_runs(std::span<const RowToCut> rows) {
  std::vector<Run> runs;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const bool joins = !runs.empty() && rows[r].room == rows[runs.back().first].room &&
                       glm::dot(rows[r].normal, rows[runs.back().first].normal) > kAlike;
    if (!joins) runs.push_back({r, r});
    runs.back().last = r + 1;
  }
  return runs;
}

/// The values of one node in the rows of a run, towards their mean.
void shrink_node(const Run& run, std::size_t node, double rays, std::vector<std::vector<float>>& values) {
  const double count = double(run.last - run.first);
  double mean = 0.0, variance = 0.0;
  for (std::size_t r = run.first; r < run.last; ++r) mean += values[r][node] / count;
  for (std::size_t r = run.first; r < run.last; ++r)
    variance += (values[r][node] - mean) * (values[r][node] - mean) / (count - 1.0);
  if (variance <= 0.0) return;
  const double kept = std::max(0.0, 1.0 - mean / rays / variance);
  for (std::size_t r = run.first; r < run.last; ++r)
    values[r][node] = float(mean + kept * (values[r][node] - mean));
}

void shrink_run(const SenderTree& senders, const Run& run, double rays, CutTile& tile) {
  if (run.last - run.first < 2) return;
  std::vector<double> sums, shrunk_sums;
  const auto by_rays = [&](std::size_t node) {
    return !senders.sampled_by_area[senders.tree.nodes[tile.nodes[node]].first];
  };
  const auto sum = [&](std::size_t row) {
    double total = 0.0;
    for (std::size_t n = 0; n < tile.nodes.size(); ++n)
      total += by_rays(n) ? double(tile.values[row][n]) : 0.0;
    return total;
  };
  for (std::size_t r = run.first; r < run.last; ++r) sums.push_back(sum(r));
  for (std::size_t n = 0; n < tile.nodes.size(); ++n) {
    if (by_rays(n)) shrink_node(run, n, rays, tile.values);
  }
  for (std::size_t r = run.first; r < run.last; ++r) {
    const double shrunk = sum(r);
    const double scale = shrunk > 0.0 ? sums[r - run.first] / shrunk : 0.0;
    for (std::size_t n = 0; n < tile.nodes.size(); ++n) {
      if (by_rays(n)) tile.values[r][n] = float(tile.values[r][n] * scale);
    }
  }
}

}  // namespace

std::vector<CutTile> cut_rows(const SenderTree& senders, std::span<const RowToCut> rows,
                              const TileCutOptions& options) {
  std::vector<CutTile> tiles((rows.size() + options.rows - 1) / options.rows);
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    const std::size_t first = t * options.rows;
    const auto part = rows.subspan(first, std::min<std::size_t>(options.rows, rows.size() - first));
    std::vector<const FormFactorRow*> pointers;
    for (const RowToCut& row : part) pointers.push_back(row.row);
    tiles[t] = cut_tile(senders.tree, senders.weights, pointers, options.rays, {options.budget, 0.0});
    if (!options.shrink_noise) return;
    for (const Run& run : alike_runs(part)) shrink_run(senders, run, options.rays, tiles[t]);
  });
  return tiles;
}

}  // namespace relume
