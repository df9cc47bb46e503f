// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/block_matrix.h"
#include "core/packed_direction.h"
#include "core/value_codec.h"

namespace relume {
namespace {

/// Names a block in messages.
struct Place {
  const std::string& what;
  std::size_t block;
};

tl::unexpected<Error> broken(const Place& place, const std::string& promise) {
  return fail(ErrorCode::check_failed, fmt::format("{}: block {}: {}", place.what, place.block, promise));
}

Result<void> check_sizes(const MatrixBlock& block, const Place& place) {
  if (block.tile_rows != 1 && block.tile_rows != 8) {
    return broken(place, fmt::format("expected tiles of 1 or 8 rows, found {}", block.tile_rows));
  }
  const std::size_t bytes_of_value = value_bytes(block.codec);
  if (bytes_of_value == 0) {
    return broken(place, fmt::format("expected value codec 0, 1 or 2, found {}",
                                     static_cast<std::uint32_t>(block.codec)));
  }
  const std::size_t tiles = (std::size_t{block.row_count} + block.tile_rows - 1) / block.tile_rows;
  if (block.tile_offsets.size() != tiles + 1) {
    return broken(place, fmt::format("expected {} tile offsets for {} rows, found {}", tiles + 1,
                                     block.row_count, block.tile_offsets.size()));
  }
  if (block.row_scales.size() != block.row_count) {
    return broken(place,
                  fmt::format("expected {} row scales, found {}", block.row_count, block.row_scales.size()));
  }
  const std::size_t expected_values = block.columns.size() * block.tile_rows * bytes_of_value;
  if (block.values.size() != expected_values) {
    return broken(place,
                  fmt::format("expected {} bytes of values, found {}", expected_values, block.values.size()));
  }
  const std::size_t expected_directions = block.columns.size() * block.tile_rows;
  if (!block.directions.empty() && block.directions.size() != expected_directions) {
    return broken(place, fmt::format("expected a direction for each of {} values, found {}",
                                     expected_directions, block.directions.size()));
  }
  if (block_bytes(block) > kMaxBlockBytes) {
    return broken(place,
                  fmt::format("expected at most {} bytes, found {}", kMaxBlockBytes, block_bytes(block)));
  }
  return {};
}

Result<void> check_tile_offsets(const MatrixBlock& block, const Place& place) {
  if (block.tile_offsets.front() != 0) {
    return broken(place, fmt::format("expected first tile offset 0, found {}", block.tile_offsets.front()));
  }
  for (std::size_t tile = 0; tile + 1 < block.tile_offsets.size(); ++tile) {
    if (block.tile_offsets[tile] > block.tile_offsets[tile + 1]) {
      return broken(place, fmt::format("tile offsets fall from {} to {} at tile {}", block.tile_offsets[tile],
                                       block.tile_offsets[tile + 1], tile));
    }
  }
  if (block.tile_offsets.back() != block.columns.size()) {
    return broken(place,
                  fmt::format("expected the last tile offset to be the number of columns, {}, found {}",
                              block.columns.size(), block.tile_offsets.back()));
  }
  return {};
}

Result<void> check_columns(const MatrixBlock& block, std::uint32_t columns, const Place& place) {
  for (std::size_t tile = 0; tile + 1 < block.tile_offsets.size(); ++tile) {
    for (std::uint32_t entry = block.tile_offsets[tile]; entry < block.tile_offsets[tile + 1]; ++entry) {
      const std::uint16_t column = block.columns[entry];
      if (column >= columns) {
        return broken(place, fmt::format("row {}: expected columns below {}, found {}",
                                         block.first_row + tile * block.tile_rows, columns, column));
      }
      if (entry > block.tile_offsets[tile] && block.columns[entry - 1] >= column) {
        return broken(
            place, fmt::format("row {}: expected ascending columns, found {} before {}",
                               block.first_row + tile * block.tile_rows, block.columns[entry - 1], column));
      }
    }
  }
  return {};
}

/// Values and scale of one row (lanes past the last row have no scale and must store zeros).
Result<void> check_row(const MatrixBlock& block, std::uint32_t tile, std::uint32_t lane, const Place& place) {
  const std::uint32_t row = tile * block.tile_rows + lane;
  const bool missing = row >= block.row_count;
  const double scale = missing ? 1.0 : block.row_scales[row];
  if (!std::isfinite(scale) || scale < 0.0) {
    return broken(
        place, fmt::format("row {}: expected a finite scale >= 0, found {}", block.first_row + row, scale));
  }
  double sum = 0.0;
  for (std::uint32_t entry = block.tile_offsets[tile]; entry < block.tile_offsets[tile + 1]; ++entry) {
    const std::size_t index = std::size_t{entry} * block.tile_rows + lane;
    const double value = unscaled_value(block.codec, block.values, index);
    if (!std::isfinite(value) || value < 0.0 || (missing && value != 0.0)) {
      return broken(place, fmt::format("row {}, column {}: expected {}, found {}", block.first_row + row,
                                       block.columns[entry],
                                       missing ? "0 past the last row" : "a finite value >= 0", value));
    }
    sum += value * scale;
  }
  // The sum of n doubles is itself rounded.
  const double rounding =
      (block.tile_offsets[tile + 1] - block.tile_offsets[tile]) * std::numeric_limits<double>::epsilon();
  if (!(sum <= 1.0 + rounding)) {
    return broken(
        place, fmt::format("row {}: expected a row sum of at most 1, found {}", block.first_row + row, sum));
  }
  return {};
}

Result<void> check_values(const MatrixBlock& block, const Place& place) {
  const auto tiles = static_cast<std::uint32_t>(block.tile_offsets.size() - 1);
  for (std::uint32_t tile = 0; tile < tiles; ++tile) {
    for (std::uint32_t lane = 0; lane < block.tile_rows; ++lane) {
      if (auto checked = check_row(block, tile, lane, place); !checked) return checked;
    }
  }
  return {};
}

Result<void> check_directions(const MatrixBlock& block, const Place& place) {
  const auto bad = std::find_if_not(block.directions.begin(), block.directions.end(), is_packed_direction);
  if (bad == block.directions.end()) return {};
  return broken(
      place, fmt::format("direction {}: expected three components of a vector no longer than 1, found {:#x}",
                         bad - block.directions.begin(), *bad));
}

Result<void> check_block(const MatrixBlock& block, std::uint32_t columns, const Place& place) {
  if (block.row_count == 0) return broken(place, "expected at least one row, found none");
  if (auto checked = check_sizes(block, place); !checked) return checked;
  if (auto checked = check_tile_offsets(block, place); !checked) return checked;
  if (auto checked = check_columns(block, columns, place); !checked) return checked;
  if (auto checked = check_directions(block, place); !checked) return checked;
  return check_values(block, place);
}

}  // namespace

Result<void> check_block_matrix(const BlockMatrix& matrix, const std::string& what) {
  if (matrix.columns > kMaxImports) {
    return fail(ErrorCode::check_failed,
                fmt::format("{}: expected at most {} columns, found {}", what, kMaxImports, matrix.columns));
  }
  std::uint64_t rows = 0;
  std::size_t with_directions = 0, without_directions = 0;  // blocks
  for (std::size_t index = 0; index < matrix.blocks.size(); ++index) {
    const MatrixBlock& block = matrix.blocks[index];
    const Place place{what, index};
    if (block.first_row != rows) {
      return broken(place, fmt::format("expected first row {}, found {}", rows, block.first_row));
    }
    if (auto checked = check_block(block, matrix.columns, place); !checked) return checked;
    if (!block.columns.empty()) ++(block.directions.empty() ? without_directions : with_directions);
    rows += block.row_count;
  }
  if (rows != matrix.rows) {
    return fail(ErrorCode::check_failed,
                fmt::format("{}: expected {} rows in its blocks, found {}", what, matrix.rows, rows));
  }
  if (with_directions > 0 && without_directions > 0) {
    return fail(ErrorCode::check_failed,
                fmt::format("{}: expected directions in all blocks or none, found {} with, {} without", what,
                            with_directions, without_directions));
  }
  return {};
}

}  // namespace relume
