// SPDX-License-Identifier: MIT
#include "core/reference_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/certificate.h"
#include "core/sender_leaves.h"
#include "core/sender_product.h"
#include "core/value_slack.h"

namespace relume {
namespace {

/// Senders numbered through: leaves (clusters, sky patches), nodes of each system, nodes of the sky, nodes
/// above the systems.
class SenderNumbers {
 public:
  explicit SenderNumbers(const Model& model) : model_(model), leaves_(model), next_(leaves_.count()) {
    for (const System& system : model.systems) add_nodes(system.tree.nodes.size());
    add_nodes(model.sky_tree.nodes.size());
    add_nodes(model.top_tree.size());
  }

  const LeafNumbers& leaves() const { return leaves_; }
  std::uint32_t senders() const { return next_; }
  /// kNone: nothing of the sender is loaded.
  std::uint32_t number(const SenderRef& sender) const {
    const SenderLeaves leaves = leaves_.leaves_of(sender);
    if (leaves.ranges.empty()) return kNone;
    const std::size_t systems = model_.systems.size();
    if (sender.system == kSpanningNodes) return first_node_[systems + 1] + sender.index;
    const bool sky = sender.system == kSkySystem;
    const std::size_t own = sky ? model_.sky_cells.size() : model_.systems[sender.system].clusters.size();
    if (sender.index < own) return leaves.ranges.front().first;
    return first_node_[sky ? systems : sender.system] + (sender.index - static_cast<std::uint32_t>(own));
  }
  std::vector<std::uint32_t> of_imports(const System& system) const {
    std::vector<std::uint32_t> numbers;
    for (const SenderRef& sender : system.imports) numbers.push_back(number(sender));
    return numbers;
  }

 private:
  void add_nodes(std::size_t count) {
    first_node_.push_back(next_);
    next_ += static_cast<std::uint32_t>(count);
  }

  const Model& model_;
  LeafNumbers leaves_;
  std::uint32_t next_ = 0;
  std::vector<std::uint32_t> first_node_;  ///< per system, of the sky, above the systems
};

/// Appends the rows of one system to `all`, with columns renumbered and sorted again. A sender that is not
/// loaded has no column: it has no radiosity either.
void append_rows(const CsrMatrix& local, const std::vector<std::uint32_t>& numbers, CsrMatrix& all) {
  std::vector<std::pair<std::uint32_t, double>> row_entries;
  all.column_indices.reserve(all.values.size() + local.values.size());
  all.values.reserve(all.values.size() + local.values.size());
  for (std::uint32_t row = 0; row < local.rows; ++row) {
    row_entries.clear();
    for (std::uint64_t entry = local.row_offsets[row]; entry < local.row_offsets[row + 1]; ++entry) {
      const std::uint32_t number = numbers[local.column_indices[entry]];
      if (number != kNone) row_entries.emplace_back(number, local.values[entry]);
    }
    std::sort(row_entries.begin(), row_entries.end());
    for (const auto& [column, value] : row_entries) {
      all.column_indices.push_back(column);
      all.values.push_back(value);
    }
    all.row_offsets.push_back(all.values.size());
  }
  all.rows += local.rows;
}

CsrMatrix empty_matrix(std::uint32_t columns) {
  CsrMatrix matrix;
  matrix.columns = columns;
  matrix.row_offsets.push_back(0);
  return matrix;
}

/// Appends a row of P.
void append_node(const SenderRef& node, const LeafNumbers& numbers, CsrMatrix& nodes) {
  const SenderLeaves leaves = numbers.leaves_of(node);
  for (const LeafRange& range : leaves.ranges) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      nodes.column_indices.push_back(range.first + i);
      nodes.values.push_back(range.share_of(i));
    }
  }
  nodes.row_offsets.push_back(nodes.values.size());
  ++nodes.rows;
}

/// P: nodes in the order of SenderNumbers.
CsrMatrix node_matrix(const Model& model, const LeafNumbers& numbers) {
  CsrMatrix nodes = empty_matrix(numbers.count());
  const auto append = [&](std::size_t system, std::size_t first, std::size_t count) {
    for (std::size_t n = first; n < first + count; ++n)
      append_node({static_cast<std::uint32_t>(system), static_cast<std::uint32_t>(n)}, numbers, nodes);
  };
  for (std::size_t s = 0; s < model.systems.size(); ++s)
    append(s, model.systems[s].clusters.size(), model.systems[s].tree.nodes.size());
  append(kSkySystem, model.sky_cells.size(), model.sky_tree.nodes.size());
  append(kSpanningNodes, 0, model.top_tree.size());
  return nodes;
}

/// Radiosity of all senders.
std::vector<Rgb> senders(const CsrMatrix& nodes, const Lighting& lighting,
                         const std::vector<Rgb>& radiosity) {
  std::vector<Rgb> all = radiosity;
  all.insert(all.end(), lighting.sky_radiosity.begin(), lighting.sky_radiosity.end());
  for (std::uint32_t node = 0; node < nodes.rows; ++node) all.push_back(row_product(nodes, node, all));
  return all;
}

}  // namespace

SenderMatrix::SenderMatrix(CsrMatrix all_rows, CsrMatrix all_nodes)
    : rows(std::move(all_rows)), nodes(std::move(all_nodes)) {}

namespace {

using DecodeRows = CsrMatrix (*)(const BlockMatrix&);

/// `part`: which rows of each system.
SenderMatrix decoded_matrix(const Model& model, BlockMatrix System::*part, DecodeRows decode_rows) {
  const SenderNumbers numbers(model);
  CsrMatrix rows = empty_matrix(numbers.senders());
  for (const System& system : model.systems)
    append_rows(decode_rows(system.*part), numbers.of_imports(system), rows);
  return {std::move(rows), node_matrix(model, numbers.leaves())};
}

ReferenceMatrices decoded_matrices(const Model& model, DecodeRows decode_rows) {
  return {decoded_matrix(model, &System::bounce, decode_rows),
          decoded_matrix(model, &System::gather, decode_rows)};
}

}  // namespace

SenderMatrix reference_bounce_matrix(const Model& model) {
  return decoded_matrix(model, &System::bounce, decode);
}

ReferenceMatrices reference_matrices(const Model& model) {
  return decoded_matrices(model, decode);
}

ReferenceMatrices reference_slack(const Model& model) {
  return decoded_matrices(model, decode_slack);
}

std::vector<Rgb> bounce(const SenderMatrix& bounce_matrix, const Lighting& lighting,
                        const std::vector<Rgb>& radiosity) {
  const std::vector<Rgb> b = senders(bounce_matrix.nodes, lighting, radiosity);
  std::vector<Rgb> result(bounce_matrix.rows.rows);
  for (std::uint32_t row = 0; row < result.size(); ++row) {
    const Rgb irradiance = lighting.direct[row] + row_product(bounce_matrix.rows, row, b);
    result[row] = lighting.exitance[row] + lighting.albedo[row] * irradiance;
  }
  return result;
}

Result<void> check_shapes(const SenderMatrix& matrix, const Lighting& lighting) {
  const std::size_t clusters = matrix.rows.rows;
  const std::size_t leaves = matrix.rows.columns - matrix.nodes.rows;
  const bool fits = lighting.albedo.size() == clusters && lighting.exitance.size() == clusters &&
                    lighting.direct.size() == clusters && clusters + lighting.sky_radiosity.size() == leaves;
  if (fits) return {};
  return fail(
      ErrorCode::check_failed,
      fmt::format(
          "lighting: expected {} clusters and {} sky patches, found {} albedos, {} exitances, {} direct "
          "irradiances and {} sky patches",
          clusters, leaves - clusters, lighting.albedo.size(), lighting.exitance.size(),
          lighting.direct.size(), lighting.sky_radiosity.size()));
}

Result<void> check_contraction(const ContractionBound& contraction) {
  for (int channel = 0; channel < 3; ++channel) {
    if (contraction.quotient[channel] < 1.0) continue;
    const std::string where = fmt::format(
        "the spectral radius of albedo x form factors lies between {:.6g} and {:.6g}, expected below 1",
        contraction.lower_quotient[channel], contraction.quotient[channel]);
    if (contraction.lower_quotient[channel] >= 1.0) {
      return fail(
          ErrorCode::check_failed,
          fmt::format("the bounces do not converge: in channel {} light grows by a factor of {:.6g} or more "
                      "at each bounce ({})",
                      channel, contraction.lower_quotient[channel], where));
    }
    return fail(ErrorCode::check_failed,
                fmt::format("the bounces may not converge: in channel {}, after {} products, {}", channel,
                            contraction.products, where));
  }
  return {};
}

Result<Solution> solve_reference(const SenderMatrix& bounce_matrix, const Lighting& lighting,
                                 const StopRule& rule, const BounceObserver& observer) {
  if (auto checked = check_shapes(bounce_matrix, lighting); !checked) return tl::unexpected(checked.error());
  const ContractionBound contraction = contraction_bound(bounce_matrix, lighting.albedo);
  if (auto checked = check_contraction(contraction); !checked) return tl::unexpected(checked.error());

  Solution solution;
  for (std::uint32_t row = 0; row < bounce_matrix.rows.rows; ++row) {
    solution.radiosity.push_back(lighting.exitance[row] + lighting.albedo[row] * lighting.direct[row]);
  }
  const Rgb& q = contraction.quotient;
  if (rule.max_bounces == 0) {
    const std::vector<Rgb> next = bounce(bounce_matrix, lighting, solution.radiosity);
    rate_solution(measure_change(bounce_matrix, contraction, solution.radiosity, next), Rgb(1.0), q,
                  solution);
    return solution;
  }
  while (solution.bounces < rule.max_bounces) {
    std::vector<Rgb> next = bounce(bounce_matrix, lighting, solution.radiosity);
    const Change change = measure_change(bounce_matrix, contraction, solution.radiosity, next);
    solution.radiosity = std::move(next);
    rate_solution(change, q, q, solution);
    ++solution.bounces;
    if (observer && !observer(solution.bounces, solution.error_bound)) {
      return fail(ErrorCode::cancelled, fmt::format("cancelled after {} bounces", solution.bounces));
    }
    if (rule.tolerance > 0.0 && solution.error_bound <= rule.tolerance) break;
  }
  return solution;
}

std::vector<Rgb> gather(const SenderMatrix& gather_matrix, const Lighting& lighting,
                        const std::vector<Rgb>& radiosity) {
  const std::vector<Rgb> b = senders(gather_matrix.nodes, lighting, radiosity);
  std::vector<Rgb> irradiance(gather_matrix.rows.rows);
  for (std::uint32_t row = 0; row < irradiance.size(); ++row)
    irradiance[row] = row_product(gather_matrix.rows, row, b);
  return irradiance;
}

}  // namespace relume
