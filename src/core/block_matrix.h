// SPDX-License-Identifier: MIT
//
// Sparse form-factor matrices: the stored block format, and CSR as its decoded view.
//
// A BlockMatrix is a list of blocks of consecutive rows. Inside a block, rows stand in tiles of R
// neighbouring receivers that share one column list; R = 1 is CSR. With R = 8 the last tile of a block may be
// partly empty: its missing rows store zeros. Columns are 16-bit indices into the import table of the owning
// system. A stored value v of row r stands for
//   f32      v * row_scale[r]
//   unorm16  q / 65535 * row_scale[r]
//   sqrt8    (q / 255)^2 * row_scale[r]
// computed as (decoded code) * row_scale in the precision of whoever decodes; row_scale also carries the
// repair of the row sum after quantisation: the values of a row, decoded in double or in IEEE f32 alike, sum
// to no more than the sum that the row was encoded from, nor more than 1, and to less by no more than a few
// units in the last place of f32. (Whoever then adds n of them up in f32 adds a rounding of their own, at
// most n 2^-24 of the sum.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace relume {

enum class ValueCodec : std::uint32_t { f32 = 0, unorm16 = 1, sqrt8 = 2 };

/// Bytes of one stored value: 4, 2 or 1.
std::size_t value_bytes(ValueCodec codec);

/// No block is larger than this, so that every binding fits every device (DESIGN: maxStorageBufferRange 128
/// MiB on lavapipe).
inline constexpr std::size_t kMaxBlockBytes = std::size_t{64} << 20;

/// Local columns are 16 bit; a system can import at most this many senders.
inline constexpr std::uint32_t kMaxImports = 65535;

struct MatrixBlock {
  std::uint32_t first_row = 0;  ///< row of the owning matrix
  std::uint32_t row_count = 0;
  std::uint32_t tile_rows = 1;  ///< R: 1 or 8
  ValueCodec codec = ValueCodec::f32;
  std::vector<std::uint32_t> tile_offsets;  ///< ceil(row_count / R) + 1 entries, in columns of this block
  std::vector<std::uint16_t> columns;       ///< ascending inside a tile
  std::vector<std::byte> values;            ///< value of (column entry c, lane l) at index c * R + l
  std::vector<float> row_scales;            ///< row_count entries
  /// Empty, or for each value, at the same index, the mean direction in world space from the receiver to what
  /// it sees of the sender (core/packed_direction.h); 0 where the value is 0.
  std::vector<std::uint32_t> directions;
};

struct BlockMatrix {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;  ///< entries of the import table
  std::vector<MatrixBlock> blocks;
};

/// Compressed sparse rows in double precision. Columns ascend inside a row.
struct CsrMatrix {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  std::vector<std::uint64_t> row_offsets;  ///< rows + 1 entries
  std::vector<std::uint32_t> column_indices;
  std::vector<double> values;
};

struct MatrixSummary {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  std::uint64_t nonzeros = 0;
  std::uint64_t bytes = 0;
  double max_row_sum = 0.0;  ///< of decoded values, in double
};

/// Bytes of the arrays of a block.
std::size_t block_bytes(const MatrixBlock& block);

/// A row as a block stores it (R = 1): all of its values differ from zero.
struct StoredRow {
  std::span<const std::uint16_t> columns;
  std::span<const std::byte> values;  ///< codes
  std::span<const std::uint32_t> directions;
  float scale = 1.0f;
};

class RowEncoder;

/// Appends rows and tiles one by one and cuts blocks at `max_block_bytes`, where R changes, and after a tile
/// that is partly empty. Codes of sqrt8 are chosen so that errors of neighbouring columns make up for each
/// other: best when columns that follow each other stand for senders that lie side by side.
class BlockMatrixBuilder {
 public:
  /// `entries`: about so many will be appended.
  BlockMatrixBuilder(std::uint32_t columns, ValueCodec codec, std::size_t max_block_bytes = kMaxBlockBytes,
                     std::size_t entries = 0);
  BlockMatrixBuilder(BlockMatrixBuilder&&) noexcept;
  ~BlockMatrixBuilder();

  /// `columns` ascending and below the matrix's column count, `values` finite, >= 0 and summing to <= 1 up to
  /// rounding, of equal length. Zero values are not stored. A tile of R = 1. `directions`: codes of
  /// core/packed_direction.h per value, for all rows of the matrix or none.
  void append_row(std::span<const std::uint16_t> columns, std::span<const double> values,
                  std::span<const std::uint32_t> directions = {});
  void append_row(std::span<const std::uint16_t> columns, std::span<const float> values,
                  std::span<const std::uint32_t> directions = {});

  /// A tile of R = 8 of 1 to 8 rows that share `columns`: value of row r and column entry c at [r *
  /// columns.size() + c], of each row as above. Columns that are zero for all rows are not stored.
  void append_tile(std::span<const std::uint16_t> columns, std::span<const double> values,
                   std::uint32_t row_count, std::span<const std::uint32_t> directions = {});

  /// A row that was encoded before (core/row_encoder.h), with the codec of the matrix. `column_of`, if it is
  /// not empty: the columns that stand for its own.
  void append_stored(const StoredRow& row, std::span<const std::uint16_t> column_of = {});

  BlockMatrix finish() &&;

  struct EncodedTile;

 private:
  /// The last block, or a new one, so that a tile of so many bytes may follow.
  MatrixBlock& block_for(std::uint32_t tile_rows, std::size_t bytes);
  bool fits(std::uint32_t tile_rows, std::size_t bytes) const;

  BlockMatrix matrix_;
  ValueCodec codec_;
  std::size_t max_block_bytes_;
  std::size_t entries_;                  ///< that are still expected
  std::unique_ptr<RowEncoder> encoder_;  ///< its memory serves again
  std::unique_ptr<EncodedTile> tile_;    ///< its memory serves again
};

/// The decoded view of any block format (R = 1 and 8, all codecs). Entries of a tile that are zero for a row
/// are left out. The matrix must be valid (see check_block_matrix).
CsrMatrix decode(const BlockMatrix& matrix);

MatrixSummary summarise(const BlockMatrix& matrix);

/// Every promise of the format: blocks in order, offsets monotone and in range, columns ascending and below
/// `columns`, values and scales finite and
/// >= 0, row sums <= 1, block sizes, directions no longer than 1 for all values or none. The error names the
/// block and row; `what` names the matrix.
Result<void> check_block_matrix(const BlockMatrix& matrix, const std::string& what);

}  // namespace relume
