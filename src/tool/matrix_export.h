// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/block_matrix.h"
#include "core/result.h"

namespace relume {

/// Matrix Market, coordinate real general, 1-based. `title` becomes a comment line.
std::vector<std::byte> encode_mtx(const CsrMatrix& matrix, const std::string& title);

/// What scipy.sparse.load_npz reads: a zip of indices, indptr, format, shape and data. Fails with bad_input
/// when the file would pass 4 GB, the limit of plain zip.
Result<std::vector<std::byte>> encode_npz(const CsrMatrix& matrix);

}  // namespace relume
