// SPDX-License-Identifier: MIT
#include "core/loose_rows.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>

#include "core/halvings.h"
#include "core/sender_numbers.h"
#include "core/value_slack.h"

namespace relume {
namespace {

void append_halvings_of(const Model& model, const System& system, const BlockMatrix& matrix,
                        const std::vector<std::uint8_t>& bytes, LooseRows& all) {
  if (bytes.empty()) {
    all.first_halving.resize(all.first_halving.size() + matrix.rows, kUntold);
    return;
  }
  const auto offsets = halving_offsets(matrix, leaves_of_columns(model, system), bytes);
  const std::uint64_t before = 4 * std::uint64_t{all.halvings.size()};
  for (std::uint32_t row = 0; row < matrix.rows; ++row) all.first_halving.push_back(before + (*offsets)[row]);
  all.halvings.insert(all.halvings.end(), bytes.begin(), bytes.end());
}

void append_system(const Model& model, const System& system, const BlockMatrix& matrix,
                   const std::vector<std::uint8_t>& halvings, const std::vector<std::uint32_t>& numbers,
                   LooseRows& all) {
  const CsrMatrix rows = decode(matrix);
  const ValueSlack slack = decode_slack(matrix);
  const std::uint64_t before = all.rows.values.size();
  for (const std::uint32_t column : rows.column_indices) all.rows.column_indices.push_back(numbers[column]);
  for (std::uint32_t row = 0; row < rows.rows; ++row)
    all.rows.row_offsets.push_back(before + rows.row_offsets[row + 1]);
  all.rows.values.insert(all.rows.values.end(), rows.values.begin(), rows.values.end());
  all.rows.rows += rows.rows;
  all.slack.insert(all.slack.end(), slack.each.values.begin(), slack.each.values.end());
  all.running.insert(all.running.end(), slack.running.begin(), slack.running.end());
  append_halvings_of(model, system, matrix, halvings, all);
}

/// What entries of a row count for.
class Worth {
 public:
  Worth(const LooseRows& matrix, const std::vector<Rgb>& leaves) : matrix_(matrix), leaves_(leaves) {
    const CsrMatrix& nodes = matrix.nodes;
    for (std::uint32_t node = 0; node < nodes.rows; ++node) {
      Rgb most = leaves[nodes.column_indices[nodes.row_offsets[node]]];
      for (auto e = nodes.row_offsets[node] + 1; e < nodes.row_offsets[node + 1]; ++e)
        most = glm::max(most, leaves[nodes.column_indices[e]]);
      brightest_.push_back(most);
    }
  }

  void of_row(std::uint32_t row, std::vector<Rgb>& worth) const {
    worth.clear();
    std::uint64_t next = matrix_.first_halving[row];
    for (auto e = matrix_.rows.row_offsets[row]; e < matrix_.rows.row_offsets[row + 1]; ++e)
      worth.push_back(of_sender(matrix_.rows.column_indices[e], next));
  }

 private:
  Rgb of_sender(std::uint32_t sender, std::uint64_t& next) const {
    if (sender < leaves_.size()) return leaves_[sender];
    const auto node = std::uint32_t(sender - leaves_.size());
    if (next == kUntold || node >= matrix_.told_nodes) return brightest_[node];
    const CsrMatrix& nodes = matrix_.nodes;
    const auto first = nodes.row_offsets[node];
    const auto count = std::uint32_t(nodes.row_offsets[node + 1] - first);
    return most_of_halves<Rgb>(matrix_.halvings, 0, count, next, [&](std::uint32_t leaf) -> const Rgb& {
      return leaves_[nodes.column_indices[first + leaf]];
    });
  }

  const LooseRows& matrix_;
  const std::vector<Rgb>& leaves_;
  std::vector<Rgb> brightest_;  ///< per node
};

/// Levels that entries are held against, in their mean: most of them are darker.
constexpr std::array<double, 3> kLevels{1.0, 0.5, 0.25};

Rgb hidden_by_codes(const LooseRows& matrix, std::uint64_t begin, const std::vector<Rgb>& worth,
                    const Rgb& mean) {
  Rgb by_parts(0.0);
  std::array<Rgb, kLevels.size()> each{};
  for (std::size_t i = 0; i < worth.size(); ++i) {
    const Rgb& next = i + 1 < worth.size() ? worth[i + 1] : mean;
    by_parts += matrix.running[begin + i] * glm::abs(worth[i] - next);
    for (std::size_t k = 0; k < kLevels.size(); ++k)
      each[k] += matrix.slack[begin + i] * glm::abs(worth[i] - kLevels[k] * mean);
  }
  for (const Rgb& sum : each) by_parts = glm::min(by_parts, sum);
  return by_parts;
}

Rgb most_of_row(const LooseRows& matrix, std::uint32_t row, const std::vector<Rgb>& worth) {
  const std::uint64_t begin = matrix.rows.row_offsets[row];
  Rgb sum(0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < worth.size(); ++i) {
    sum += matrix.rows.values[begin + i] * worth[i];
    total += matrix.rows.values[begin + i];
  }
  return total > 0.0 ? sum + hidden_by_codes(matrix, begin, worth, sum / total) : sum;
}

}  // namespace

LooseMatrices loose_matrices(const Model& model) {
  const SenderNumbers numbers(model);
  LooseMatrices matrices;
  for (LooseRows* part : {&matrices.bounce, &matrices.gather}) {
    part->rows = empty_matrix(numbers.senders());
    part->nodes = node_matrix(model, numbers.leaves());
    part->told_nodes = part->nodes.rows - std::uint32_t(model.top_tree.size());
  }
  for (const System& system : model.systems) {
    const std::vector<std::uint32_t> columns = numbers.of_imports(system);
    append_system(model, system, system.bounce, system.bounce_halvings, columns, matrices.bounce);
    append_system(model, system, system.gather, system.gather_halvings, columns, matrices.gather);
  }
  return matrices;
}

std::vector<Rgb> most_arriving(const LooseRows& matrix, const std::vector<Rgb>& leaves) {
  const Worth worth(matrix, leaves);
  std::vector<Rgb> most(matrix.rows.rows), of_row;
  for (std::uint32_t row = 0; row < most.size(); ++row) {
    worth.of_row(row, of_row);
    most[row] = most_of_row(matrix, row, of_row);
  }
  return most;
}

}  // namespace relume
