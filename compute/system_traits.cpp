// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numeric>

#include "compute/schedule.h"
#include "core/block_matrix.h"
#include "core/quantities.h"

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

/// What rows see of each system, at most.
class LargestShares {
 public:
  LargestShares(const Model& model, const System& system)
      : largest_(model.systems.size() + 1, 0.0), of_row_(largest_.size(), 0.0) {
    for (const SenderRef& sender : system.imports) parts_.push_back(parts_of(model, sender));
  }

  /// A share of the row that is at hand.
  void see(std::uint32_t column, double share) {
    for (const Coupling& part : parts_[column]) of_row_[part.system] += share * part.share;
  }

  /// The row at hand is whole; it counts `factor` times what it sees.
  void finish_row(double factor) {
    const double of_systems = std::accumulate(of_row_.begin(), of_row_.end() - 1, 0.0);
    total_ = std::max(total_, factor * of_systems);
    for (std::size_t s = 0; s < largest_.size(); ++s)
      largest_[s] = std::max(largest_[s], factor * of_row_[s]);
    std::fill(of_row_.begin(), of_row_.end(), 0.0);
  }

  template <class Factor>
  void add(const BlockMatrix& matrix, const Factor& factor) {
    const CsrMatrix rows = decode(matrix);
    for (std::uint32_t row = 0; row < rows.rows; ++row) {
      for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e) {
        see(rows.column_indices[e], rows.values[e]);
      }
      finish_row(factor(row));
    }
  }

  CouplingRow result() const {
    CouplingRow result{{}, total_};
    for (std::uint32_t s = 0; s < largest_.size(); ++s) {
      if (largest_[s] > 0.0) result.shares.push_back({s, largest_[s]});
    }
    return result;
  }

 private:
  std::vector<std::vector<Coupling>> parts_;  ///< per import
  std::vector<double> largest_, of_row_;      ///< per system, then the sky
  double total_ = 0.0;
};

/// A plane through a probe receives at most solid angle / pi of a sender, and 1 of all.
void add_probes(const System& system, LargestShares& shares) {
  for (const Probe& probe : system.probes) {
    double sum = 0.0;
    for (std::uint32_t k = probe.first_sender; k < probe.first_sender + probe.sender_count; ++k) {
      const ProbeSender& sender = system.probe_senders[k];
      shares.see(sender.column, sender.solid_angle / kPi);
      sum += sender.solid_angle / kPi;
    }
    shares.finish_row(1.0 / std::max(1.0, sum));
  }
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
  LargestShares bounce(model, system), gather(model, system);
  bounce.add(system.bounce, reflected);
  gather.add(system.gather, [](std::uint32_t) { return 1.0; });
  add_probes(system, gather);
  traits.bounce = bounce.result();
  traits.gather = gather.result();
  return traits;
}

}  // namespace relume
