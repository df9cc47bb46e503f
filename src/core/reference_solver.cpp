// SPDX-License-Identifier: MIT
#include "core/reference_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <utility>

namespace relume {
namespace {

/// What each column of a system's matrices is among the senders numbered through.
std::vector<std::uint32_t> sender_numbers(const Model& model, const System& system,
                                          const std::vector<std::uint32_t>& clusters) {
  std::vector<std::uint32_t> numbers;
  for (const SenderRef& sender : system.imports) {
    const std::uint32_t first =
        sender.system == kSkySystem ? clusters[model.systems.size()] : clusters[sender.system];
    numbers.push_back(first + sender.index);
  }
  return numbers;
}

/// Appends the rows of one system to `all`, with columns renumbered and sorted again.
void append_rows(const CsrMatrix& local, const std::vector<std::uint32_t>& numbers, CsrMatrix& all) {
  std::vector<std::pair<std::uint32_t, double>> row_entries;
  for (std::uint32_t row = 0; row < local.rows; ++row) {
    row_entries.clear();
    for (std::uint64_t entry = local.row_offsets[row]; entry < local.row_offsets[row + 1]; ++entry) {
      row_entries.emplace_back(numbers[local.column_indices[entry]], local.values[entry]);
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

/// One of the two matrices of all systems.
CsrMatrix decoded_rows(const Model& model, BlockMatrix System::*matrix) {
  const std::vector<std::uint32_t> clusters = cluster_offsets(model);
  CsrMatrix all = empty_matrix(clusters.back() + static_cast<std::uint32_t>(model.sky_cells.size()));
  for (const System& system : model.systems) {
    append_rows(decode(system.*matrix), sender_numbers(model, system, clusters), all);
  }
  return all;
}

/// Radiosity of all senders: clusters, then sky patches.
std::vector<Rgb> senders(const Lighting& lighting, const std::vector<Rgb>& radiosity) {
  std::vector<Rgb> all = radiosity;
  all.insert(all.end(), lighting.sky_radiosity.begin(), lighting.sky_radiosity.end());
  return all;
}

Rgb row_product(const CsrMatrix& matrix, std::uint32_t row, const std::vector<Rgb>& b) {
  Rgb sum(0.0);
  for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry) {
    sum += matrix.values[entry] * b[matrix.column_indices[entry]];
  }
  return sum;
}

Rgb largest(const std::vector<Rgb>& values) {
  Rgb result(0.0);
  for (const Rgb& value : values) result = glm::max(result, value);
  return result;
}

double largest_channel(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

/// numerator / denominator per channel, the worst of them; a channel without light has no error.
double worst_ratio(const Rgb& numerator, const Rgb& denominator) {
  double worst = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    if (numerator[channel] > 0.0) worst = std::max(worst, numerator[channel] / denominator[channel]);
  }
  return worst;
}

/// What one bounce changed, per channel.
struct Change {
  Rgb largest{0.0};
  Rgb weighted{0.0};  ///< max |r_j| / v_j
  Rgb rounding{0.0};  ///< the same of what the bounce may have rounded: a row of n positive terms by less
                      ///< than (n + 4) ulp of its sum
};

Change measure(const CsrMatrix& matrix, const ContractionBound& contraction, const std::vector<Rgb>& before,
               const std::vector<Rgb>& after) {
  Change change;
  for (std::uint32_t row = 0; row < matrix.rows; ++row) {
    const Rgb difference = glm::abs(after[row] - before[row]);
    const auto terms = static_cast<double>(matrix.row_offsets[row + 1] - matrix.row_offsets[row]) + 4.0;
    const Rgb ulps = terms * std::numeric_limits<double>::epsilon() * after[row];
    change.largest = glm::max(change.largest, difference);
    change.weighted = glm::max(change.weighted, difference / contraction.weights[row]);
    change.rounding = glm::max(change.rounding, ulps / contraction.weights[row]);
  }
  return change;
}

/// Residual and error bound of solution.radiosity: all further bounces add up to a geometric series whose
/// first term is at most `first` times the change (q for what came after that bounce, 1 for what was before
/// it), and each rounds.
void rate(const Change& change, const Rgb& first, const Rgb& quotient, Solution& solution) {
  const Rgb top = largest(solution.radiosity);
  solution.relative_residual = worst_ratio(Rgb(largest_channel(change.largest)), Rgb(largest_channel(top)));
  solution.error_bound = worst_ratio((first * change.weighted + change.rounding) / (1.0 - quotient), top);
}

Result<void> check_shapes(const CsrMatrix& matrix, const Lighting& lighting) {
  const std::size_t clusters = matrix.rows;
  const bool fits = lighting.albedo.size() == clusters && lighting.exitance.size() == clusters &&
                    lighting.direct.size() == clusters &&
                    clusters + lighting.sky_radiosity.size() == matrix.columns;
  if (fits) return {};
  return fail(
      ErrorCode::check_failed,
      fmt::format(
          "lighting: expected {} clusters and {} sky patches, found {} albedos, {} exitances, {} direct "
          "irradiances and {} sky patches",
          clusters, matrix.columns - matrix.rows, lighting.albedo.size(), lighting.exitance.size(),
          lighting.direct.size(), lighting.sky_radiosity.size()));
}

}  // namespace

ReferenceMatrices reference_matrices(const Model& model) {
  return {decoded_rows(model, &System::bounce), decoded_rows(model, &System::gather)};
}

std::vector<Rgb> bounce(const CsrMatrix& bounce_matrix, const Lighting& lighting,
                        const std::vector<Rgb>& radiosity) {
  const std::vector<Rgb> b = senders(lighting, radiosity);
  std::vector<Rgb> result(bounce_matrix.rows);
  for (std::uint32_t row = 0; row < bounce_matrix.rows; ++row) {
    const Rgb irradiance = lighting.direct[row] + row_product(bounce_matrix, row, b);
    result[row] = lighting.exitance[row] + lighting.albedo[row] * irradiance;
  }
  return result;
}

Result<void> check_contraction(const ContractionBound& contraction) {
  for (int channel = 0; channel < 3; ++channel) {
    if (contraction.quotient[channel] < 1.0) continue;
    return fail(
        ErrorCode::check_failed,
        fmt::format(
            "the bounces may not converge: in channel {} the spectral radius of albedo x form factors lies "
            "between {:.6g} and {:.6g}, expected below 1",
            channel, contraction.lower_quotient[channel], contraction.quotient[channel]));
  }
  return {};
}

Result<Solution> solve_reference(const CsrMatrix& bounce_matrix, const Lighting& lighting,
                                 const StopRule& rule, const BounceObserver& observer) {
  if (auto checked = check_shapes(bounce_matrix, lighting); !checked) return tl::unexpected(checked.error());
  const ContractionBound contraction = contraction_bound(bounce_matrix, lighting.albedo);
  if (auto checked = check_contraction(contraction); !checked) return tl::unexpected(checked.error());

  Solution solution;
  for (std::uint32_t row = 0; row < bounce_matrix.rows; ++row) {
    solution.radiosity.push_back(lighting.exitance[row] + lighting.albedo[row] * lighting.direct[row]);
  }
  const Rgb& q = contraction.quotient;
  if (rule.max_bounces == 0) {
    const std::vector<Rgb> next = bounce(bounce_matrix, lighting, solution.radiosity);
    rate(measure(bounce_matrix, contraction, solution.radiosity, next), Rgb(1.0), q, solution);
    return solution;
  }
  while (solution.bounces < rule.max_bounces) {
    std::vector<Rgb> next = bounce(bounce_matrix, lighting, solution.radiosity);
    const Change change = measure(bounce_matrix, contraction, solution.radiosity, next);
    solution.radiosity = std::move(next);
    rate(change, q, q, solution);
    ++solution.bounces;
    if (observer && !observer(solution.bounces, solution.error_bound)) {
      return fail(ErrorCode::cancelled, fmt::format("cancelled after {} bounces", solution.bounces));
    }
    if (rule.tolerance > 0.0 && solution.error_bound <= rule.tolerance) break;
  }
  return solution;
}

std::vector<Rgb> gather(const CsrMatrix& gather_matrix, const Lighting& lighting,
                        const std::vector<Rgb>& radiosity) {
  const std::vector<Rgb> b = senders(lighting, radiosity);
  std::vector<Rgb> irradiance(gather_matrix.rows);
  for (std::uint32_t row = 0; row < gather_matrix.rows; ++row)
    irradiance[row] = row_product(gather_matrix, row, b);
  return irradiance;
}

}  // namespace relume
