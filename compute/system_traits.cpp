// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numeric>

#include "compute/schedule.h"
#include "core/block_matrix.h"

namespace relume {
namespace {

/// Parts of a sender in systems, as shares that sum to 1.
std::vector<Coupling> parts_of(const Model& model, const SenderRef& sender) {
  if (sender.system == kSkySystem) return {{static_cast<std::uint32_t>(model.systems.size()), 1.0}};
  if (sender.system != kSpanningNodes) return {{sender.system, 1.0}};
  const SpanningNode& node = model.top_tree[sender.index];
  std::vector<Coupling> parts;
  for (std::uint32_t p = node.first_part; p < node.first_part + node.part_count; ++p) {
    parts.push_back({model.top_parts[p].sender.system, model.top_parts[p].share});
  }
  return parts;
}

/// The largest of factor(row) x what a row sees of each system, over the rows of a matrix.
template <class Factor>
CouplingRow largest_shares(const Model& model, const System& system, const BlockMatrix& matrix,
                           const Factor& factor) {
  std::vector<std::vector<Coupling>> parts;
  for (const SenderRef& sender : system.imports) parts.push_back(parts_of(model, sender));
  const std::size_t sky = model.systems.size();
  std::vector<double> largest(sky + 1, 0.0), of_row(sky + 1);
  CouplingRow result;
  const CsrMatrix rows = decode(matrix);
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    std::fill(of_row.begin(), of_row.end(), 0.0);
    for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e) {
      for (const Coupling& part : parts[rows.column_indices[e]]) {
        of_row[part.system] += rows.values[e] * part.share;
      }
    }
    for (std::size_t s = 0; s <= sky; ++s) largest[s] = std::max(largest[s], factor(row) * of_row[s]);
    const double of_systems = std::accumulate(of_row.begin(), of_row.end() - 1, 0.0);
    result.total = std::max(result.total, factor(row) * of_systems);
  }
  for (std::uint32_t s = 0; s <= sky; ++s) {
    if (largest[s] > 0.0) result.shares.push_back({s, largest[s]});
  }
  return result;
}

}  // namespace

SystemTraits system_traits(const Model& model, std::uint32_t index, const SystemDispatches& dispatches,
                           std::span<const Rgb> albedo) {
  const System& system = model.systems[index];
  SystemTraits traits;
  traits.loaded = true;
  for (std::size_t kernel = 0; kernel < kStepKernels; ++kernel) {
    for (const DispatchStep& step : dispatches[kernel]) traits.costs[kernel].push_back(step.cost);
  }
  const auto reflected = [&](std::uint32_t row) {
    if (!albedo.empty()) return std::max({albedo[row].x, albedo[row].y, albedo[row].z});
    const auto& stored = system.clusters[row].albedo;
    return double{std::max({stored[0], stored[1], stored[2]})};
  };
  traits.bounce = largest_shares(model, system, system.bounce, reflected);
  traits.gather = largest_shares(model, system, system.gather, [](std::uint32_t) { return 1.0; });
  return traits;
}

}  // namespace relume
