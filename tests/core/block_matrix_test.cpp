// SPDX-License-Identifier: MIT
#include "core/block_matrix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "support/matrices.h"

namespace relume {
namespace {

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

BlockMatrix one_block(std::uint32_t rows, std::uint32_t columns, MatrixBlock block) {
  block.row_count = rows;
  return {rows, columns, {std::move(block)}};
}

//      [ .     0.5   0.25 ]   scale 1
//      [ 0.25  .     .    ]   scale 0.5: stored as 0.5
//      [ .     .     .    ]
BlockMatrix drawn_f32() {
  MatrixBlock block;
  block.tile_offsets = {0, 2, 3, 3};
  block.columns = {1, 2, 0};
  block.values = bytes_of(std::vector<float>{0.5f, 0.25f, 0.5f});
  block.row_scales = {1.0f, 0.5f, 1.0f};
  return one_block(3, 3, block);
}

// Ten rows in two tiles of eight; the second holds rows 8 and 9 only. Codes (255 stands for 1, 51 for 0.04),
// scales beside them:
//      tile 0    column 0: 255  51   0   0   0   0   0   0     scales 0.5 of each row
//                column 2: 255 255  51   0   0   0   0 255
//      tile 1    column 1:  51 255   -   -   -   -   -   -     scales 1, 0.25
BlockMatrix drawn_sqrt8() {
  MatrixBlock block;
  block.tile_rows = 8, block.codec = ValueCodec::sqrt8;
  block.tile_offsets = {0, 2, 3};
  block.columns = {0, 2, 1};
  block.values =
      bytes_of(std::vector<std::uint8_t>{255, 51,  0,  0, 0, 0, 0, 0,  //
                                         255, 255, 51, 0, 0, 0, 0, 255, 51, 255, 0, 0, 0, 0, 0, 0});
  block.row_scales = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 1.0f, 0.25f};
  return one_block(10, 3, block);
}

// Two rows in one tile of eight; 65535 stands for 1, 13107 for 0.2.
//      column 1: 65535 13107  -  -  -  -  -  -
//      column 3: 13107     0  -  -  -  -  -  -     scales 0.5, 1
BlockMatrix drawn_unorm16() {
  MatrixBlock block;
  block.tile_rows = 8, block.codec = ValueCodec::unorm16;
  block.tile_offsets = {0, 2};
  block.columns = {1, 3};
  block.values = bytes_of(std::vector<std::uint16_t>{65535, 13107, 0, 0, 0, 0, 0, 0,  //
                                                     13107, 0, 0, 0, 0, 0, 0, 0});
  block.row_scales = {0.5f, 1.0f};
  return one_block(2, 4, block);
}

void expect_dense(const CsrMatrix& matrix, const test::DenseMatrix& expected) {
  const test::DenseMatrix found = test::to_dense(matrix);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t row = 0; row < expected.size(); ++row) {
    for (std::size_t column = 0; column < expected[row].size(); ++column) {
      EXPECT_NEAR(found[row][column], expected[row][column], 1e-15) << "row " << row << ", column " << column;
    }
  }
}

TEST(BlockMatrix, DecodesRowsOfOneInF32) {
  const BlockMatrix matrix = drawn_f32();
  ASSERT_TRUE(check_block_matrix(matrix, "drawn"));
  const CsrMatrix csr = decode(matrix);
  EXPECT_EQ(csr.row_offsets, (std::vector<std::uint64_t>{0, 2, 3, 3}));
  EXPECT_EQ(csr.column_indices, (std::vector<std::uint32_t>{1, 2, 0}));
  EXPECT_EQ(csr.values, (std::vector<double>{0.5, 0.25, 0.25}));
}

TEST(BlockMatrix, DecodesTilesOfEightInSqrt8WithAPartlyEmptyLastTile) {
  const BlockMatrix matrix = drawn_sqrt8();
  ASSERT_TRUE(check_block_matrix(matrix, "drawn"));
  const CsrMatrix csr = decode(matrix);
  expect_dense(csr, {{0.5, 0, 0.5},
                     {0.02, 0, 0.5},
                     {0, 0, 0.02},
                     {0, 0, 0},
                     {0, 0, 0},
                     {0, 0, 0},
                     {0, 0, 0},
                     {0, 0, 0.5},
                     {0, 0.04, 0},
                     {0, 0.25, 0}});
  EXPECT_EQ(csr.values.size(), 8u) << "zeros of a tile are left out";
}

TEST(BlockMatrix, DecodesTilesOfEightInUnorm16) {
  const BlockMatrix matrix = drawn_unorm16();
  ASSERT_TRUE(check_block_matrix(matrix, "drawn"));
  expect_dense(decode(matrix), {{0, 0.5, 0, 0.1}, {0, 0.2, 0, 0}});
}

TEST(BlockMatrix, SummaryCountsWhatIsStored) {
  const MatrixSummary summary = summarise(drawn_unorm16());
  EXPECT_EQ(summary.rows, 2u);
  EXPECT_EQ(summary.columns, 4u);
  EXPECT_EQ(summary.nonzeros, 3u);
  EXPECT_NEAR(summary.max_row_sum, 0.6, 1e-15);
  EXPECT_EQ(summary.bytes, 2u * 4 + 2 * 2 + 16 * 2 + 2 * 4);
}

/// Rows as rays make them: many small values, some large, with the sum that is asked for.
std::vector<double> random_row(std::mt19937_64& random, std::size_t length, double sum) {
  std::uniform_real_distribution<double> exponent(-9.0, 0.0);
  std::vector<double> values(length);
  for (double& value : values) value = std::exp2(exponent(random));
  const double scale = sum / std::accumulate(values.begin(), values.end(), 0.0);
  for (double& value : values) value *= scale;
  return values;
}

TEST(BlockMatrix, SummaryHasTheLargestSumOfDecodedRows) {
  std::mt19937_64 random(5);
  constexpr std::size_t kColumns = 300;
  std::vector<std::uint16_t> columns(kColumns);
  std::iota(columns.begin(), columns.end(), std::uint16_t{0});
  BlockMatrixBuilder builder(kColumns, ValueCodec::unorm16);
  // Some of them are as good as equal, one is empty.
  for (int row = 0; row < 200; ++row) {
    const std::vector<double> values = random_row(random, kColumns, row % 3 == 0 ? 1.0 : 0.004 * row);
    builder.append_row(columns, std::span<const double>(values));
  }
  builder.append_row({}, std::span<const double>());
  const BlockMatrix matrix = std::move(builder).finish();
  const CsrMatrix csr = decode(matrix);
  double largest = 0.0;
  for (std::size_t row = 0; row < csr.rows; ++row) {
    const auto begin = csr.values.begin();
    largest = std::max(largest, std::accumulate(begin + std::ptrdiff_t(csr.row_offsets[row]),
                                                begin + std::ptrdiff_t(csr.row_offsets[row + 1]), 0.0));
  }
  const MatrixSummary summary = summarise(matrix);
  EXPECT_EQ(summary.max_row_sum, largest);
  EXPECT_EQ(summary.nonzeros, csr.values.size());
}

std::vector<std::uint16_t> first_columns(std::size_t count) {
  std::vector<std::uint16_t> columns(count);
  std::iota(columns.begin(), columns.end(), std::uint16_t{0});
  return columns;
}

/// The values of a row of R = 1 decoded in f32, added in double.
double sum_decoded_in_f32(const MatrixBlock& block, std::uint32_t row) {
  double sum = 0.0;
  for (std::uint32_t entry = block.tile_offsets[row]; entry < block.tile_offsets[row + 1]; ++entry) {
    float value = 0.0f;
    if (block.codec == ValueCodec::f32) {
      std::memcpy(&value, block.values.data() + 4 * entry, 4);
    } else if (block.codec == ValueCodec::unorm16) {
      std::uint16_t code = 0;
      std::memcpy(&code, block.values.data() + 2 * entry, 2);
      value = static_cast<float>(code) / 65535.0f;
    } else {
      const float root = static_cast<float>(std::to_integer<int>(block.values[entry])) / 255.0f;
      value = root * root;
    }
    sum += value * block.row_scales[row];
  }
  return sum;
}

class RowSums : public testing::TestWithParam<ValueCodec> {};

TEST_P(RowSums, NeverGrowAndHardlyShrink) {
  std::mt19937_64 random(1);
  for (const std::size_t length : {1u, 2u, 7u, 100u, 4000u}) {
    for (int trial = 0; trial < 50; ++trial) {
      const std::vector<double> values = random_row(random, length, trial % 2 == 0 ? 1.0 : 0.37);
      BlockMatrixBuilder builder(static_cast<std::uint32_t>(length), GetParam());
      builder.append_row(first_columns(length), values);
      const BlockMatrix matrix = std::move(builder).finish();
      ASSERT_TRUE(check_block_matrix(matrix, "built"));

      const double original = std::accumulate(values.begin(), values.end(), 0.0);
      const CsrMatrix csr = decode(matrix);
      const double in_double = std::accumulate(csr.values.begin(), csr.values.end(), 0.0);
      const double in_float = sum_decoded_in_f32(matrix.blocks[0], 0);
      EXPECT_LE(in_double, std::min(original, 1.0));
      // Dividing codes in f32 may round a value by one unit in the last place more than dividing in double
      // and rounding once.
      EXPECT_LE(in_float, std::min(original, 1.0) * (1.0 + 0x1p-23));
      EXPECT_GE(in_double, original * (1.0 - 0x1p-20)) << "the scale repairs the sum to a few units of f32";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, RowSums,
                         testing::Values(ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8));

TEST(BlockMatrixBuilder, KeepsWhatRaysCountExactly) {
  BlockMatrixBuilder builder(3, ValueCodec::f32);
  builder.append_row(first_columns(3), std::vector<double>{300.0 / 512, 211.0 / 512, 1.0 / 512});
  const BlockMatrix matrix = std::move(builder).finish();
  EXPECT_EQ(matrix.blocks[0].row_scales[0], 1.0f);
  EXPECT_EQ(decode(matrix).values, (std::vector<double>{300.0 / 512, 211.0 / 512, 1.0 / 512}));
}

TEST(BlockMatrixBuilder, StoresFloatsAsItStoresTheSameNumbersInDouble) {
  const std::vector<std::vector<float>> rows{{0.25f, 0.5f, 0.125f}, {0.5f, 0.0f, 0.25f},
                                             {0.5f, 1e-40f, 0.25f}, {0.7f, 0.3f, 1.2e-7f},
                                             {0.0f, 0.0f, 0.0f},    {0.1f, 0.2f, 0.7f}};
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    BlockMatrixBuilder floats(3, codec, kMaxBlockBytes, 18), doubles(3, codec);
    for (const std::vector<float>& row : rows) {
      floats.append_row(first_columns(3), row);
      doubles.append_row(first_columns(3), std::vector<double>(row.begin(), row.end()));
    }
    const BlockMatrix a = std::move(floats).finish(), b = std::move(doubles).finish();
    EXPECT_EQ(a.rows, b.rows);
    ASSERT_EQ(a.blocks.size(), 1u);
    EXPECT_EQ(a.blocks[0].row_count, b.blocks[0].row_count);
    EXPECT_EQ(a.blocks[0].tile_offsets, b.blocks[0].tile_offsets);
    EXPECT_EQ(a.blocks[0].columns, b.blocks[0].columns);
    EXPECT_EQ(a.blocks[0].values, b.blocks[0].values);
    EXPECT_EQ(a.blocks[0].row_scales, b.blocks[0].row_scales);
  }
}

TEST(BlockMatrixBuilder, QuantisesToHalfAStepOfTheLargestValue) {
  const std::vector<double> values{0.5, 0.3, 0.1, 0.01, 0.001};
  BlockMatrixBuilder builder(5, ValueCodec::unorm16);
  builder.append_row(first_columns(5), values);
  const CsrMatrix csr = decode(std::move(builder).finish());
  // Half a step of 0.5 / 65535, and what the repaired scale moves: at most 5 half steps over a sum of 0.911.
  const double step = 0.5 / 65535;
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_NEAR(csr.values[k], values[k], 0.5 * step + values[k] * 2.5 * step / 0.911);
  }
}

TEST(BlockMatrixBuilder, StoresNoZerosAndAllowsEmptyRows) {
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    BlockMatrixBuilder builder(4, codec);
    builder.append_row(first_columns(4), std::vector<double>{0.0, 0.5, 0.0, 0.0});
    builder.append_row({}, std::vector<double>());
    builder.append_row(first_columns(2), std::vector<double>{0.0, 0.0});
    const BlockMatrix matrix = std::move(builder).finish();
    ASSERT_TRUE(check_block_matrix(matrix, "built"));
    expect_dense(decode(matrix), {{0, 0.5, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}});
    EXPECT_EQ(summarise(matrix).nonzeros, 1u);
  }
}

TEST(BlockMatrixBuilder, CutsBlocksAtTheirLimit) {
  // A row of three columns in f32 takes 4 (offset) + 3 * 2 + 3 * 4 + 4 (scale) = 26 bytes; a block has one
  // more offset: 4 + 3 * 26 = 82.
  BlockMatrixBuilder builder(3, ValueCodec::f32, 82);
  for (int row = 0; row < 7; ++row) {
    builder.append_row(first_columns(3), std::vector<double>{0.25, 0.25, 0.125 * row / 7});
  }
  const BlockMatrix matrix = std::move(builder).finish();
  ASSERT_TRUE(check_block_matrix(matrix, "built"));
  std::vector<std::uint32_t> rows_of_blocks;
  for (const MatrixBlock& block : matrix.blocks) rows_of_blocks.push_back(block.row_count);
  // The first row has a zero and is 6 bytes smaller, which is not enough for a fourth.
  EXPECT_EQ(rows_of_blocks, (std::vector<std::uint32_t>{3, 3, 1}));
  EXPECT_EQ(matrix.blocks[1].first_row, 3u);
  EXPECT_EQ(block_bytes(matrix.blocks[1]), 82u);
  EXPECT_EQ(matrix.rows, 7u);
  EXPECT_FLOAT_EQ(static_cast<float>(test::to_dense(decode(matrix))[6][2]), 0.125f * 6 / 7);
}

TEST(BlockMatrixBuilder, WithoutRowsIsValid) {
  const BlockMatrix matrix = BlockMatrixBuilder(0, ValueCodec::f32).finish();
  EXPECT_TRUE(check_block_matrix(matrix, "empty"));
  EXPECT_EQ(decode(matrix).row_offsets, (std::vector<std::uint64_t>{0}));
}

/// The message of a matrix that was valid until `breaker` touched it.
template <class Breaker>
std::string complaint(BlockMatrix matrix, Breaker&& breaker) {
  breaker(matrix, matrix.blocks[0]);
  const auto checked = check_block_matrix(matrix, "K");
  return checked ? "accepted" : checked.error().message;
}

TEST(CheckBlockMatrix, NamesTheBrokenPromise) {
  const auto expect = [](const std::string& message, const char* part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.rfind("K: ", 0), 0u) << message;
  };
  const auto nan = std::nanf("");
  const auto set_value = [](MatrixBlock& block, std::size_t index, float value) {
    std::memcpy(block.values.data() + 4 * index, &value, 4);
  };
  const BlockMatrix good = drawn_f32();
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.columns[1] = 3; }),
         "row 0: expected columns below 3");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.columns[1] = 1; }), "ascending");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.tile_offsets[1] = 4; }), "fall from 4 to 3");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.tile_offsets[0] = 1; }), "first tile offset 0");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.tile_offsets[3] = 4; }), "number of columns");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.tile_offsets.pop_back(); }), "4 tile offsets");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.row_scales[2] = -1.0f; }),
         "row 2: expected a finite scale");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.row_scales.pop_back(); }), "3 row scales");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.values.pop_back(); }), "12 bytes of values");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.tile_rows = 4; }), "1 or 8");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.codec = ValueCodec{3}; }), "codec");
  expect(complaint(good, [](BlockMatrix&, MatrixBlock& b) { b.first_row = 1; }), "first row 0");
  expect(complaint(good, [](BlockMatrix& m, MatrixBlock&) { m.rows = 4; }), "4 rows");
  expect(complaint(good, [](BlockMatrix& m, MatrixBlock&) { m.columns = 65536; }), "65535 columns");
  expect(complaint(good, [&](BlockMatrix&, MatrixBlock& b) { set_value(b, 1, nan); }),
         "row 0, column 2: expected a finite");
  expect(complaint(good, [&](BlockMatrix&, MatrixBlock& b) { set_value(b, 1, -0.25f); }),
         "finite value >= 0");
  expect(complaint(good, [&](BlockMatrix&, MatrixBlock& b) { set_value(b, 1, 0.5001f); }),
         "row 0: expected a row sum");
  expect(complaint(drawn_unorm16(), [](BlockMatrix&, MatrixBlock& b) { b.values[4] = std::byte{1}; }),
         "row 2, column 1: expected 0 past the last row");
}

TEST(CheckBlockMatrix, RefusesABlockThatIsTooLarge) {
  // One column more than fits beside 2 offsets and 1 scale, 3 bytes each in sqrt8.
  MatrixBlock block;
  block.codec = ValueCodec::sqrt8;
  const std::size_t columns = (kMaxBlockBytes - 12) / 3 + 1;
  block.tile_offsets = {0, static_cast<std::uint32_t>(columns)};
  block.columns.assign(columns, 0);
  block.values.assign(columns, std::byte{0});
  block.row_scales = {1.0f};
  const auto checked = check_block_matrix(one_block(1, 3, block), "K");
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("at most 67108864 bytes"), std::string::npos)
      << checked.error().message;
}

/// Rows that share columns, some with gaps: value of row r and column c at [r][c].
test::DenseMatrix neighbours(std::mt19937_64& random, std::size_t rows, std::size_t columns) {
  test::DenseMatrix dense;
  for (std::size_t row = 0; row < rows; ++row) {
    dense.push_back(random_row(random, columns, row == 0 ? 1.0 : 0.7));
    for (std::size_t column = row; column < columns; column += 11) dense[row][column] = 0.0;
  }
  return dense;
}

class Tiles : public testing::TestWithParam<ValueCodec> {};

TEST_P(Tiles, OfEightComeBackWithinOneStepAndKeepTheirSums) {
  const ValueCodec codec = GetParam();
  std::mt19937_64 random(3);
  const std::size_t columns = 70;
  const test::DenseMatrix dense = neighbours(random, 19, columns);
  BlockMatrixBuilder builder(columns, codec, 4000);
  for (std::size_t first = 0; first < dense.size(); first += 8) {
    const std::size_t rows = std::min<std::size_t>(8, dense.size() - first);
    std::vector<double> values;
    for (std::size_t r = first; r < first + rows; ++r)
      values.insert(values.end(), dense[r].begin(), dense[r].end());
    builder.append_tile(first_columns(columns), values, static_cast<std::uint32_t>(rows));
  }
  const BlockMatrix matrix = std::move(builder).finish();
  ASSERT_TRUE(check_block_matrix(matrix, "tiles"));
  EXPECT_EQ(matrix.rows, 19u);
  const test::DenseMatrix found = test::to_dense(decode(matrix));
  for (std::size_t row = 0; row < dense.size(); ++row) {
    const double top = *std::max_element(dense[row].begin(), dense[row].end());
    const double sum = std::accumulate(dense[row].begin(), dense[row].end(), 0.0);
    const double found_sum = std::accumulate(found[row].begin(), found[row].end(), 0.0);
    EXPECT_LE(found_sum, std::min(1.0, sum) * (1.0 + 1e-15 * double(columns)));
    EXPECT_GE(found_sum, sum * (1.0 - 0x1p-16));
    for (std::size_t column = 0; column < columns; ++column) {
      const double value = dense[row][column];
      // Roundings of value, scale and repair in 32 bits; half a step of 16 bits; a whole one of 8 bits: (q +
      // 1)^2 - q^2 with q = 255 sqrt(value / top). The repair of the sum scales by as much as the steps are
      // off together: 1 % is far above it.
      double step = 3 * 0x1p-23 * value;
      if (codec == ValueCodec::unorm16) step = 0.5 * top / 65535.0 + 1e-4 * value;
      if (codec == ValueCodec::sqrt8)
        step = top * (2.0 * 255.0 * std::sqrt(value / top) + 1.0) / (255.0 * 255.0) + 0.01 * value;
      EXPECT_NEAR(found[row][column], value, step + 1e-12) << "row " << row << ", column " << column;
      if (value == 0.0) {
        EXPECT_EQ(found[row][column], 0.0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, Tiles,
                         testing::Values(ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8));

TEST(BlockMatrixBuilder, StartsABlockWhereTheTileSizeChangesAndAfterAPartlyEmptyTile) {
  BlockMatrixBuilder builder(2, ValueCodec::f32);
  const std::vector<std::uint16_t> columns{0, 1};
  builder.append_tile(columns, std::vector<double>(16, 0.25), 8);
  builder.append_tile(columns, std::vector<double>{0.5, 0.0, 0.25, 0.0}, 2);
  builder.append_tile(columns, std::vector<double>(16, 0.125), 8);
  builder.append_row(columns, std::vector<double>{0.5, 0.5});
  const BlockMatrix matrix = std::move(builder).finish();
  ASSERT_TRUE(check_block_matrix(matrix, "mixed"));
  ASSERT_EQ(matrix.blocks.size(), 3u);
  EXPECT_EQ(matrix.blocks[0].row_count, 10u);
  EXPECT_EQ(matrix.blocks[0].columns, (std::vector<std::uint16_t>{0, 1, 0}))
      << "a column of zeros is left out";
  EXPECT_EQ(matrix.blocks[1].first_row, 10u);
  EXPECT_EQ(matrix.blocks[2].tile_rows, 1u);
  EXPECT_EQ(decode(matrix).rows, 19u);
}

}  // namespace
}  // namespace relume
