// SPDX-License-Identifier: MIT
#include "core/missing_share.h"

#include "core/sender_leaves.h"

namespace relume {
namespace {

void append_shares(const BlockMatrix& matrix, const std::vector<double>& missing_of_column,
                   std::vector<double>& shares) {
  const CsrMatrix rows = decode(matrix);
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    double share = 0.0;
    for (std::uint64_t entry = rows.row_offsets[row]; entry < rows.row_offsets[row + 1]; ++entry)
      share += rows.values[entry] * missing_of_column[rows.column_indices[entry]];
    shares.push_back(share);
  }
}

}  // namespace

MissingShare missing_share(const Model& model) {
  const LeafNumbers numbers(model);
  MissingShare shares;
  for (const System& system : model.systems) {
    std::vector<double> missing_of_column;
    for (const SenderRef& sender : system.imports)
      missing_of_column.push_back(numbers.leaves_of(sender).missing_share);
    append_shares(system.bounce, missing_of_column, shares.clusters);
    append_shares(system.gather, missing_of_column, shares.gather);
  }
  return shares;
}

Lighting missing_light(const Lighting& lighting, const MissingShare& share, const Rgb& largest_radiosity) {
  Lighting missing = lighting;
  missing.exitance.assign(lighting.exitance.size(), Rgb(0.0));
  missing.sky_radiosity.assign(lighting.sky_radiosity.size(), Rgb(0.0));
  for (std::size_t i = 0; i < missing.direct.size(); ++i)
    missing.direct[i] = share.clusters[i] * largest_radiosity;
  return missing;
}

}  // namespace relume
