// SPDX-License-Identifier: MIT
#include "core/reference_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/certificate.h"
#include "core/sender_numbers.h"
#include "core/sender_product.h"

namespace relume {
namespace {

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

/// `part`: which rows of each system.
SenderMatrix decoded_matrix(const Model& model, BlockMatrix System::*part) {
  const SenderNumbers numbers(model);
  CsrMatrix rows = empty_matrix(numbers.senders());
  for (const System& system : model.systems)
    append_rows(decode(system.*part), numbers.of_imports(system), rows);
  return {std::move(rows), node_matrix(model, numbers.leaves())};
}

}  // namespace

SenderMatrix reference_bounce_matrix(const Model& model) {
  return decoded_matrix(model, &System::bounce);
}

ReferenceMatrices reference_matrices(const Model& model) {
  return {decoded_matrix(model, &System::bounce), decoded_matrix(model, &System::gather)};
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
  return check_shapes(matrix.rows, matrix.nodes, lighting);
}

Result<void> check_shapes(const CsrMatrix& rows, const CsrMatrix& nodes, const Lighting& lighting) {
  const std::size_t clusters = rows.rows;
  const std::size_t leaves = rows.columns - nodes.rows;
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
